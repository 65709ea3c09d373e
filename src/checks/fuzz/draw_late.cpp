// A second release of a random case, which enters later.
#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"

namespace frana::fuzz {

void draw_late(Dice& dice, Draft& draft) {
    if (draft.claims.rests || draft.claims.mirror != Mirror::none || draft.has("scheme.preset")) return;
    const Raster& dem = draft.dem();
    const double cell = dem.geometry.cell, usual = dice.decades(1e-3, 3.0) * cell;
    Raster depth = Raster::filled(dem.geometry, Raster::nodata);
    const auto first = [&](Index count) { return 2 + dice.below(std::max<Index>(1, count - 9)); };
    const Index i0 = first(dem.geometry.nx), j0 = first(dem.geometry.ny), across = 1 + dice.below(5),
                up = 1 + dice.below(5);
    for (Index j = j0; j < std::min(j0 + up, dem.geometry.ny - 2); ++j)
        for (Index i = i0; i < std::min(i0 + across, dem.geometry.nx - 2); ++i)
            if (!std::isnan(dem.at(i, j))) depth.at(i, j) = single(usual * dice.between(0.5, 1.0));
    for (Index j = 0; j < dem.geometry.ny; ++j)  // not next to holes, which a run would refuse
        for (Index i = 0; i < dem.geometry.nx; ++i)
            if (!all_near(dem.geometry, i, j, [&](Index a, Index b) { return !std::isnan(dem.at(a, b)); }))
                depth.at(i, j) = Raster::nodata;
    const bool any = std::any_of(depth.values.begin(), depth.values.end(), [](double h) { return h > 0.0; });
    if (!any) return;
    draft.rasters["late.tif"] = depth;
    draft.keys["release#0.depth"] = "\"late.tif\"";
    if (dice.chance(0.5))
        draft.keys["release#0.when_hit"] = "true";
    else
        say(draft, "release#0.at", dice.decades(0.1, 30.0) * std::sqrt(cell / 9.81));
    const auto is = [&](const char* key, const char* value) { return draft.has(key) && draft.keys.at(key) == value; };
    const bool bed_falls =
        (!draft.has("scheme.shape") || is("scheme.shape", "\"quadratic\"")) && !is("erodible.bed_evolves", "false");
    if (dice.chance(0.5) && bed_falls) draft.keys["release#0.included_in_dem"] = "true";
}

}  // namespace frana::fuzz
