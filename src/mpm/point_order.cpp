#include "mpm/point_order.h"

#include <omp.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#include "base/error.h"

namespace frana {
namespace {

/// Fewer points than this are not worth waking other threads for.
constexpr Index kPointsForThreads = 4096;

/// Calls body(key, first point, one behind the last) for points in a row that have the same key. Most do, and a count
/// in memory that each of them raises would wait for the one before.
template <class Body>
void for_each_row(const std::int32_t* keys, Index from, Index count, Body&& body) {
    for (Index first = from, p = from; first < count; first = p) {
        const std::int32_t key = keys[first];
        for (p = first + 1; p < count && keys[p] == key;) ++p;
        if (key >= 0) body(key, first, p);
    }
}

/// Calls body(first, end) for equal parts of [0, count), one for each thread. All threads of a team call this.
template <class Body>
void for_part_of_thread(Index count, Body&& body) {
    const Index threads = omp_get_num_threads(), n = omp_get_thread_num();
    body(n * count / threads, (n + 1) * count / threads);
}

/// All threads of a team call this: number p of the field becomes the one at order[p], p < kept, in `spare`. Returns the
/// room that is spare then. It is the field's own, which its owner changes for `spare`, or the same where it is too
/// narrow.
template <class Field>
double* permuted(Field& field, const std::int32_t* order, Index kept, double* spare) {
    using Number = typename Field::value_type;
    static_assert(sizeof(Number) <= sizeof(double), "the spare room is too narrow");
    Number* const of = field.data();
    constexpr bool changes = std::is_same_v<Field, Array>;
    char* const room = reinterpret_cast<char*>(spare);
    for_part_of_thread(kept, [&](Index first, Index end) {
        if constexpr (changes)
            for (Index p = first; p < end; ++p) spare[p] = of[order[p]];
        else
            for (Index p = first; p < end; ++p)
                std::memcpy(room + static_cast<std::size_t>(p) * sizeof(Number), of + order[p], sizeof(Number));
    });
#pragma omp barrier
    if constexpr (changes) return of;
    for_part_of_thread(kept, [&](Index first, Index end) {
        if (end == first) return;  // no copy of nothing, which may be nowhere
        std::memcpy(of + first, room + static_cast<std::size_t>(first) * sizeof(Number),
                    static_cast<std::size_t>(end - first) * sizeof(Number));
    });
#pragma omp barrier
    return spare;
}

}  // namespace

void PointOrder::make_room(Index count, Index tiles) {
    expect(count < std::numeric_limits<std::int32_t>::max() && tiles < std::numeric_limits<std::int32_t>::max(),
           "too many points for their numbers");
    resize_sparingly(key_, static_cast<std::size_t>(count));
    parts_in_use_ = count > kPointsForThreads ? static_cast<std::size_t>(omp_get_max_threads()) : 1;
    if (parts_.size() < parts_in_use_) parts_.resize(parts_in_use_);
    const Index parts = static_cast<Index>(parts_in_use_);
    for (Index n = 0; n < parts; ++n) {
        Part& part = parts_[static_cast<std::size_t>(n)];
        part.first = n * count / parts, part.end = (n + 1) * count / parts;
        if (part.count.count() < tiles) part.count = LazyArray<std::int32_t>(tiles);
    }
}

void PointOrder::tally(Part& part) const {
    part.used.clear();
    for_each_row(key_.data(), part.first, part.end, [&](std::int32_t key, Index first, Index end) {
        if (part.count[key] == 0) part.used.push_back(key);
        part.count[key] += static_cast<std::int32_t>(end - first);
    });
}

/// Within a tile the points of one part follow those of the part before. The order is that of a single part.
void PointOrder::lay_out(ActiveTiles& active) {
    const auto end = parts_.begin() + static_cast<std::ptrdiff_t>(parts_in_use_);
    used_.clear();
    for (auto part = parts_.begin(); part != end; ++part)
        used_.insert(used_.end(), part->used.begin(), part->used.end());
    std::sort(used_.begin(), used_.end());
    used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
    active.tile.assign(used_.begin(), used_.end());
    active.begin.clear();
    Index kept = 0;
    for (const std::int32_t tile : used_) {
        active.begin.push_back(kept);
        for (auto part = parts_.begin(); part != end; ++part)
            if (std::int32_t& count = part->count[tile]; count > 0) {
                const Index place = kept;
                kept += count;
                count = static_cast<std::int32_t>(place);
            }
    }
    active.begin.push_back(kept);
    for (Part& part : parts_) part.used.reserve(active.tile.capacity());  // they grow as the list of tiles does
    used_.reserve(parts_in_use_ * active.tile.capacity());
    first_.reserve(active.tile.capacity() + 1);
    resize_sparingly(order_, static_cast<std::size_t>(kept));
    for_each_part([&](Part& part) { lay_out(part); });
}

void PointOrder::lay_out(Part& part) {
    for_each_row(key_.data(), part.first, part.end, [&](std::int32_t key, Index first, Index end) {
        std::int32_t* place = order_.data() + part.count[key];
        for (Index p = first; p < end; ++p) *place++ = static_cast<std::int32_t>(p);
        part.count[key] += static_cast<std::int32_t>(end - first);
    });
    for (const std::int32_t tile : part.used) part.count[tile] = 0;
}

/// Makes order_ of the points that stay, place by place of `active`; at(place) is the point there.
template <class At>
void PointOrder::retain(const std::vector<std::uint8_t>& gone, ActiveTiles& active, At&& at) {
    const auto stays = [&](Index place) { return !gone[static_cast<std::size_t>(at(place))]; };
    if (parts_in_use_ == 1) return retain_serially(active, stays, at);
    resize_sparingly(first_, static_cast<std::size_t>(active.count() + 1));
    for_each_tile(active, [&](Index n) {
        Index count = 0;
        for (Index place = active.begin[n]; place < active.begin[n + 1]; ++place) count += stays(place);
        first_[n + 1] = count;
    });
    first_[0] = 0;
    for (Index n = 0; n < active.count(); ++n) first_[n + 1] += first_[n];
    resize_sparingly(kept_, static_cast<std::size_t>(first_[active.count()]));
    for_each_tile(active, [&](Index n) {
        std::int32_t* kept = kept_.data() + first_[n];
        for (Index place = active.begin[n]; place < active.begin[n + 1]; ++place)
            if (stays(place)) *kept++ = at(place);
    });
    order_.swap(kept_);
    std::copy_n(first_.begin(), active.count() + 1, active.begin.begin());
}

/// The same by one thread, in one pass.
template <class Stays, class At>
void PointOrder::retain_serially(ActiveTiles& active, Stays&& stays, At&& at) {
    Index kept = 0;
    for (Index n = 0, place = 0; n < active.count(); ++n) {
        const Index end = active.begin[n + 1];
        active.begin[n] = kept;
        for (; place < end; ++place)
            if (stays(place)) order_[static_cast<std::size_t>(kept++)] = at(place);
    }
    active.begin[active.count()] = kept;
    order_.resize(static_cast<std::size_t>(kept));
}

void PointOrder::leave_out(const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    retain(gone, active, [&](Index place) { return order_[static_cast<std::size_t>(place)]; });
}

void PointOrder::retain_places(Index count, const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    expect(active.begin[active.count()] == count, "points that are left out lie in tiles");
    resize_sparingly(order_, static_cast<std::size_t>(count));
    retain(gone, active, [](Index place) { return static_cast<std::int32_t>(place); });
}

/// All threads permute one field at a time: scattering all fields in one loop has too many streams open.
void PointOrder::permute(const std::vector<PointField>& fields) {
    const Index kept = static_cast<Index>(order_.size());
    const std::int32_t* const order = order_.data();
    resize_sparingly(scratch_, order_.size());
    double* spare = scratch_.data();
#pragma omp parallel firstprivate(spare) if (kept > kPointsForThreads)
    for (const PointField& field : fields)
        std::visit([&](auto* of) { spare = permuted(*of, order, kept, spare); }, field);
    for (const PointField& field : fields) {
        if (Array* const* of = std::get_if<Array*>(&field)) (*of)->swap(scratch_);  // as the threads took them
        std::visit([&](auto* of) { of->resize(order_.size()); }, field);
    }
}

/// Does not change the fields' lengths.
void PointOrder::close_gaps_of(const std::vector<PointField>& fields) const {
    const Index kept = static_cast<Index>(order_.size()), count = static_cast<Index>(fields.size());
    const std::int32_t* order = order_.data();
#pragma omp parallel for schedule(dynamic, 1) if (kept > kPointsForThreads)
    for (Index f = 0; f < count; ++f)
        std::visit(
            [&](auto* field) {
                auto* of = field->data();
                for (Index p = 0; p < kept; ++p) of[p] = of[order[p]];
            },
            fields[static_cast<std::size_t>(f)]);
}

}  // namespace frana
