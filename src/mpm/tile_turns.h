#pragma once
// Which tile may scatter when. Tiles that share nodes do so one after the other in a fixed order, all others at once.
#include <sched.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/types.h"

namespace frana {

/// Tiles of one colour share no node. A tile waits for the adjacent tiles that have a lower colour, and for nothing
/// else. Every sum has one order, whatever the number of threads. And no thread waits for the last tile of a colour.
class TileTurns {
public:
    /// Begins a new list: for tiles with the ids `tile`, in a domain of so many. One waits for at most `most_waits`
    /// others.
    void begin(const std::vector<Index>& tile, Index of_domain, std::size_t most_waits) {
        place_.resize(static_cast<std::size_t>(of_domain));
        for (std::size_t n = 0; n < tile.size(); ++n) place_[tile[n]] = static_cast<std::int32_t>(n);
        for (auto& positions : colour_) positions.clear(), positions.reserve(tile.capacity());
        turn_.reserve(tile.capacity());
        waits_.clear(), first_wait_.clear();
        first_wait_.reserve(tile.capacity() + 1);
        waits_.reserve(most_waits * tile.capacity());  // as the list of tiles grows, not some steps later
        if (tile.capacity() > room_) {
            room_ = tile.capacity();
            done_.reset(new std::atomic<std::uint32_t>[room_]());
        }
    }
    /// The next tile of the list has that colour.
    void add(Index colour) {
        colour_[static_cast<std::size_t>(colour)].push_back(static_cast<Index>(first_wait_.size()));
        first_wait_.push_back(static_cast<Index>(waits_.size()));
    }
    /// The tile that was added last waits for this one, if it is on the list `tile`.
    void wait_for(Index id, const std::vector<Index>& tile) {
        const std::size_t n = static_cast<std::size_t>(place_[id]);
        if (n < tile.size() && tile[n] == id) waits_.push_back(static_cast<Index>(n));
    }
    void end() {
        first_wait_.push_back(static_cast<Index>(waits_.size()));
        turn_.clear();
        for (const auto& positions : colour_) turn_.insert(turn_.end(), positions.begin(), positions.end());
    }

    /// Runs body(position in the list) for all tiles.
    template <class Body>
    void run(bool in_parallel, Body&& body) const {
        const Index count = static_cast<Index>(turn_.size());
        const std::uint32_t round = ++round_;
        // Monotonic: a thread waits only for tiles that some thread has taken before.
#pragma omp parallel for schedule(monotonic : dynamic, 1) if (in_parallel)
        for (Index k = 0; k < count; ++k) {
            const Index n = turn_[k];
            for (Index w = first_wait_[n]; w < first_wait_[n + 1]; ++w) await(done_[waits_[w]], round);
            body(n);
            done_[n].store(round, std::memory_order_release);
        }
    }

private:
    static void await(const std::atomic<std::uint32_t>& done, std::uint32_t round) {
        constexpr int kSpins = 1000;
        for (int spins = 0; done.load(std::memory_order_acquire) != round;)
            if (++spins > kSpins) sched_yield();  // with more threads than processors, the other one may not be running
    }

    std::vector<std::int32_t> place_;           ///< per tile of the domain: position in the list, if it is on it
    std::array<std::vector<Index>, 8> colour_;  ///< positions, by colour; in the plane the first four
    std::vector<Index> turn_;                   ///< positions, colour after colour
    std::vector<Index> waits_, first_wait_;     ///< positions that tiles wait for; where those of each begin
    std::unique_ptr<std::atomic<std::uint32_t>[]> done_;  ///< the last round in which a tile was done
    std::size_t room_ = 0;
    mutable std::uint32_t round_ = 0;
};

}  // namespace frana
