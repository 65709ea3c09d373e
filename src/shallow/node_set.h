#pragma once
// Some nodes of the grid, in the order of storage: each has its place among them, found at once.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "mpm/tile_grid.h"

namespace frana {

class NodeSet {
public:
    /// Of so many nodes in storage.
    explicit NodeSet(Index nodes) : words_(nodes / kBits + 2) {}

    void clear() {
        for (const Index w : used_) words_[w] = {};
        used_.clear(), count_ = 0;
    }
    /// Nodes k to k + count - 1, at most 64. Places are those of before until number().
    void add(Index k, Index count = 1) {
        const std::uint64_t run = count < kBits ? (std::uint64_t{1} << count) - 1 : ~std::uint64_t{0};
        const Index w = k / kBits, shift = k % kBits;
        add_to(w, run << shift);
        if (shift + count > kBits) add_to(w + 1, run >> (kBits - shift));
    }
    /// Gives all nodes their places, and returns how many they are.
    std::size_t number() {
        std::sort(used_.begin(), used_.end());
        count_ = 0;
        for (const Index w : used_) {
            words_[w].first = count_;
            count_ += static_cast<std::size_t>(__builtin_popcountll(words_[w].bits));
        }
        return count_;
    }
    std::size_t count() const { return count_; }
    /// Nothing for a node that is none of them.
    std::optional<std::size_t> place(Index k) const {
        const Word& word = words_[k / kBits];
        const std::uint64_t bit = std::uint64_t{1} << (k % kBits);
        if ((word.bits & bit) == 0) return {};
        return word.first + static_cast<std::size_t>(__builtin_popcountll(word.bits & (bit - 1)));
    }
    /// Calls body(storage index), after number() in ascending order.
    template <class Body>
    void for_each(Body&& body) const {
        for (const Index w : used_)
            for (std::uint64_t bits = words_[w].bits; bits != 0; bits &= bits - 1)
                body(w * kBits + __builtin_ctzll(bits));
    }

private:
    static constexpr Index kBits = 64;
    struct Word {
        std::uint64_t bits;
        std::size_t first;  ///< place of its first node
    };
    void add_to(Index w, std::uint64_t bits) {
        if (words_[w].bits == 0) used_.push_back(w);
        words_[w].bits |= bits;
    }

    LazyArray<Word> words_;
    std::vector<Index> used_;  ///< words that have a node
    std::size_t count_ = 0;
};

}  // namespace frana
