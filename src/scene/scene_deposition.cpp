// [deposition] of a case: what the flow leaves behind as bed.
#include <fmt/format.h>

#include <algorithm>

#include "scene/scene_parts.h"

namespace frana {
namespace {

/// Whether the bed law, somewhere, stops material that hardly moves. A lake at rest over one that does not is no
/// deposit.
bool holds_a_push(const Scene& scene) {
    const BedState state{scene.gravity, 1.0, 1.0, 1.0, scene.gravity, scene.density};
    const auto holds = [&](const auto& law) { return law.speed_after(state, 0.0, 1e-9, 1.0) == 0.0; };
    if (!scene.bed_laws()) return std::visit(holds, scene.bed_law);
    const auto one_holds = [&](const auto& table) { return std::any_of(table.begin(), table.end(), holds); };
    return std::visit(one_holds, scene.bed_laws()->laws);
}

}  // namespace

std::optional<Deposition> read_deposition(const CaseFile& file, Scene& scene) {
    if (file.word("deposition.law") == "none") return {};
    Deposition deposition;
    if (holds_a_push(scene))
        deposition.rest = file.number("deposition.time");
    else
        scene.log.push_back(
            fmt::format("{}: the bed law holds nothing at rest, so nothing becomes bed", file.place("deposition.law")));
    return deposition;
}

}  // namespace frana
