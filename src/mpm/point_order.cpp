#include "mpm/point_order.h"

#include <omp.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#include "base/error.h"

namespace frana {
namespace {

/// field[p] becomes field[order[p]], p < kept; `scratch` is room for it.
template <class Field>
void permute_field(Field& field, const std::int32_t* order, Index kept, Array& scratch) {
    using Number = typename Field::value_type;
    static_assert(sizeof(Number) <= sizeof(double), "the scratch is too narrow");
    resize_sparingly(scratch, static_cast<std::size_t>(kept));  // after a change of places it may be longer
    const Number* from = field.data();
    if constexpr (std::is_same_v<Field, Array>) {
        for (Index p = 0; p < kept; ++p) scratch[p] = from[order[p]];
        field.swap(scratch);
    } else {
        char* const room = reinterpret_cast<char*>(scratch.data());
        constexpr std::size_t size = sizeof(Number);
        for (Index p = 0; p < kept; ++p) std::memcpy(room + static_cast<std::size_t>(p) * size, from + order[p], size);
        field.resize(static_cast<std::size_t>(kept));
        if (kept > 0) std::memcpy(field.data(), room, static_cast<std::size_t>(kept) * size);
    }
}

/// Calls body(key, first point, one behind the last) for points in a row that have the same key: most do, and a count
/// in memory that each of them raises would wait for the one before.
template <class Body>
void for_each_row(const std::int32_t* keys, Index count, Body&& body) {
    for (Index first = 0, p = 0; first < count; first = p) {
        const std::int32_t key = keys[first];
        for (p = first + 1; p < count && keys[p] == key;) ++p;
        if (key >= 0) body(key, first, p);
    }
}

}  // namespace

void PointOrder::make_room(Index count, Index tiles) {
    expect(count < std::numeric_limits<std::int32_t>::max() && tiles < std::numeric_limits<std::int32_t>::max(),
           "too many points for their numbers");
    resize_sparingly(key_, static_cast<std::size_t>(count));
    tile_count_.resize(static_cast<std::size_t>(tiles));
}

void PointOrder::tally(Index count) {
    used_.clear();
    for_each_row(key_.data(), count, [&](std::int32_t key, Index first, Index end) {
        if (tile_count_[key] == 0) used_.push_back(key);
        tile_count_[key] += end - first;
    });
    std::sort(used_.begin(), used_.end());
}

void PointOrder::lay_out(ActiveTiles& active) {
    active.tile.assign(used_.begin(), used_.end());
    active.begin.clear();
    Index kept = 0;
    for (const Index tile : used_) {
        active.begin.push_back(kept);
        kept += tile_count_[tile];
        tile_count_[tile] = active.begin.back();
    }
    active.begin.push_back(kept);

    resize_sparingly(order_, static_cast<std::size_t>(kept));
    for_each_row(key_.data(), static_cast<Index>(key_.size()), [&](std::int32_t key, Index first, Index end) {
        std::int32_t* place = order_.data() + tile_count_[key];
        for (Index p = first; p < end; ++p) *place++ = static_cast<std::int32_t>(p);
        tile_count_[key] += end - first;
    });
    for (const Index tile : used_) tile_count_[tile] = 0;
}

/// Makes order_ of the points that stay, place by place of `active`; at(place) is the point there.
template <class At>
void PointOrder::retain(const std::vector<std::uint8_t>& gone, ActiveTiles& active, At&& at) {
    Index kept = 0;
    for (Index n = 0, place = 0; n < active.count(); ++n) {
        const Index end = active.begin[n + 1];
        active.begin[n] = kept;
        for (; place < end; ++place) {
            const std::int32_t p = at(place);
            if (!gone[static_cast<std::size_t>(p)]) order_[static_cast<std::size_t>(kept++)] = p;
        }
    }
    active.begin[active.count()] = kept;
    order_.resize(static_cast<std::size_t>(kept));
}

void PointOrder::leave_out(const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    retain(gone, active, [&](Index place) { return order_[static_cast<std::size_t>(place)]; });
}

void PointOrder::retain_places(Index count, const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    resize_sparingly(order_, static_cast<std::size_t>(count));
    retain(gone, active, [](Index place) { return static_cast<std::int32_t>(place); });
}

/// Each thread permutes one field at a time: scattering all fields in one loop keeps too many streams open.
void PointOrder::permute(const std::vector<PointField>& fields) {
    const Index kept = static_cast<Index>(order_.size()), count = static_cast<Index>(fields.size());
    scratch_.resize(std::max(scratch_.size(), static_cast<std::size_t>(omp_get_max_threads())));
    // Here, not when a thread first takes a field: which does is chance.
    for (Array& scratch : scratch_) resize_sparingly(scratch, static_cast<std::size_t>(kept));
#pragma omp parallel for schedule(dynamic, 1) if (kept > 4096)
    for (Index f = 0; f < count; ++f)
        std::visit([&](auto* field) { permute_field(*field, order_.data(), kept, scratch_[omp_get_thread_num()]); },
                   fields[static_cast<std::size_t>(f)]);
}

void PointOrder::close_gaps(const std::vector<PointField>& fields) const {
    const Index kept = static_cast<Index>(order_.size()), count = static_cast<Index>(fields.size());
    const std::int32_t* order = order_.data();
#pragma omp parallel for schedule(dynamic, 1) if (kept > 4096)
    for (Index f = 0; f < count; ++f)
        std::visit(
            [&](auto* field) {
                auto* of = field->data();
                for (Index p = 0; p < kept; ++p) of[p] = of[order[p]];
            },
            fields[static_cast<std::size_t>(f)]);
}

}  // namespace frana
