// The state of free water between two steps, as it is serialized. It is the tiles of the next step with what is in
// them, and the sums of the run.
#include <algorithm>

#include "base/error.h"
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
    std::vector<double> cells;
    const auto each = [&](auto&& body) {
        for (const Index tile : body_.work) {
            const Index first = body_.grid.at(body_.grid.tile_i(tile), body_.grid.tile_j(tile));
            for (Index j = 0; j < kTile; ++j)
                for (Index i = 0; i < kTile; ++i) body(first + j * body_.grid.stride() + i);
        }
    };
    if (!archive.loading())
        each([&](Index k) { cells.insert(cells.end(), {body_.now.h[k], body_.now.qx[k], body_.now.qy[k]}); });
    archive.array("cells", cells);
    const std::size_t expected = 3 * static_cast<std::size_t>(kTile * kTile) * body_.work.size();
    if (cells.size() != expected) Archive::wrong_length("cells", cells.size(), expected);
    if (!archive.loading()) return;
    for (const Index tile : body_.work)
        if (tile < 0 || tile >= body_.grid.tiles())
            throw UserError("the kept state does not fit this case: its water lies elsewhere; run without --resume");
    body_.sums.resize(body_.work.size());
    const double* v = cells.data();
    each([&](Index k) { body_.now.h[k] = v[0], body_.now.qx[k] = v[1], body_.now.qy[k] = v[2], v += 3; });
}

}  // namespace frana
