// Trees in the way of a random case.
#include "checks/fuzz/draw.h"

namespace frana::fuzz {

void draw_forest(Dice& dice, Draft& draft) {
    const bool other_scheme = draft.has("scheme.preset") || draft.has("scheme.shape");
    if (draft.claims.rests || other_scheme || draft.has("erodible.bed_evolves")) return;
    const double pressure = dice.decades(1.0, 1e4);
    if (draft.claims.mirror != Mirror::none || dice.chance(0.4)) {
        say(draft, "forest.detrainment", pressure);
    } else {
        Raster stands = Raster::filled(draft.dem().geometry, Raster::nodata);
        for (double& k : stands.values)
            if (dice.chance(0.7)) k = single(pressure * dice.unit());
        draft.rasters["stands.tif"] = stands;
        draft.keys["forest.detrainment"] = "\"stands.tif\"";
    }
    if (dice.chance(0.2)) say(draft, "forest.max_speed", dice.decades(0.1, 30.0));
    if (dice.chance(0.2)) say(draft, "forest.max_depth", dice.decades(1e-3, 1.0) * draft.dem().geometry.cell);
}

}  // namespace frana::fuzz
