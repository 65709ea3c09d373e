#include "shallow/split.h"

namespace frana {

Index Splitter::split(Flow& flow) {
    constexpr double kOff = 1e-9;  // [cells]
    const Scheme& scheme = flow.scheme;
    const HalvingRules rules{scheme.split_length, least_mass_, scheme.split, scheme.reset_domains,
                             scheme.shape == Shape::linear ? kOff : 0.0};
    return flow.columns.with_real([&](auto real) {
        return halve_points(flow.grid, flow.active, rules, flow.columns, flow.columns.carried<decltype(real)>(),
                            halves_, [](Index) { return true; });
    });
}

}  // namespace frana
