// The state of free water between two steps, as it is serialized. It is the tiles of the next step with what is in
// them, and the sums of the run.
#include <algorithm>
#include <array>

#include "mpm/stored_nodes.h"
#include "water/water_flow.h"

namespace frana {

/// No water on the tiles of the list: what is taken up again may lie on others.
void WaterFlow::clear_tiles() {
    for (const Index tile : body_.work) {
        const Index first = body_.grid.at(body_.grid.tile_i(tile), body_.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j)
            for (WaterFields* fields : {&body_.now, &body_.half})
                for (LazyArray<double>* field : {&fields->h, &fields->qx, &fields->qy})
                    std::fill_n(&(*field)[first + j * body_.grid.stride()], kTile, 0.0);
    }
}

void WaterFlow::serialize(Archive& archive) {
    if (archive.loading()) clear_tiles();
    archive.number("step", status_.step);
    std::vector<double*> numbers = {&status_.time,    &status_.dt,        &status_.volume, &status_.volume_given,
                                    &status_.kinetic, &status_.max_speed, &signal_};
    for (Vec2* v : {&status_.momentum, &status_.momentum_given})
        for (int k = 0; k < 2; ++k) numbers.push_back(&(*v)[k]);
    archive.numbers("sums", numbers);
    since_start_.serialize(archive, "ledger");
    status_.ledger = since_start_.total();
    archive.array("tiles", body_.work);
    timed_.serialize(archive);
    for (const Index tile : body_.work)
        if (tile < 0 || tile >= body_.grid.tiles()) throw misfit("its water lies elsewhere");
    WaterFields& now = body_.now;
    serialize_nodes(archive, "cells", body_.grid, body_.work, [&](Index k) {
        return std::array{&now.h[k], &now.qx[k], &now.qy[k]};
    });
    if (archive.loading()) body_.sums.resize(body_.work.size());
}

}  // namespace frana
