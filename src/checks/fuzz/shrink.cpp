#include "checks/fuzz/shrink.h"

#include <algorithm>
#include <cmath>

namespace frana::fuzz {
namespace {

using Change = std::function<void(Draft&)>;

/// Keys without which a case says nothing, or that only steer the output.
bool is_needed(const std::string& key) {
    return key == "terrain.dem" || key == "release.depth" || key == "release.surface" || key == "time.end" ||
           key == "output.formats";
}

/// A pile rests by its friction and its shape: without either the claim would be none.
bool is_pile(const Draft& draft) { return draft.claims.rests && draft.has("release.depth"); }
/// Through open sides a lake runs out.
bool is_lake(const Draft& draft) { return draft.claims.rests && draft.has("release.surface"); }
bool holds_pile(const std::string& key) { return key.rfind("material.bed.", 0) == 0 || key.rfind("terrain.", 0) == 0; }

/// Keeps pixels [i0, i0 + nx) x [j0, j0 + ny) of all rasters.
void cut(Draft& draft, Index i0, Index j0, Index nx, Index ny) {
    for (auto& [name, raster] : draft.rasters) {
        const Raster whole = raster;
        GridGeometry& grid = raster.geometry;
        grid.nx = nx, grid.ny = ny;
        grid.x0 += static_cast<double>(i0) * grid.cell;
        grid.y0 += static_cast<double>(j0) * grid.cell;
        raster.values.resize(static_cast<std::size_t>(nx * ny));
        for (Index j = 0; j < ny; ++j)
            for (Index i = 0; i < nx; ++i) raster.at(i, j) = whole.at(i0 + i, j0 + j);
    }
}

void add_cuts(const Draft& draft, std::vector<Change>& changes) {
    if (draft.claims.mirror != Mirror::none || is_pile(draft)) return;
    const Index nx = draft.dem().geometry.nx, ny = draft.dem().geometry.ny;
    for (const double share : {0.5, 0.75, 0.9}) {
        const Index x = std::min(nx - 1, std::max<Index>(4, static_cast<Index>(share * static_cast<double>(nx))));
        const Index y = std::min(ny - 1, std::max<Index>(4, static_cast<Index>(share * static_cast<double>(ny))));
        if (x >= 4) {
            changes.push_back([=](Draft& d) { cut(d, 0, 0, x, ny); });
            changes.push_back([=](Draft& d) { cut(d, nx - x, 0, x, ny); });
        }
        if (y >= 4) {
            changes.push_back([=](Draft& d) { cut(d, 0, 0, nx, y); });
            changes.push_back([=](Draft& d) { cut(d, 0, ny - y, nx, y); });
        }
    }
}

/// Empties the pixels of the depth that `choose` names.
template <class Choose>
Change without(Choose choose) {
    return [choose](Draft& d) {
        Raster& depth = d.rasters["depth.tif"];
        for (Index j = 0; j < depth.geometry.ny; ++j)
            for (Index i = 0; i < depth.geometry.nx; ++i)
                if (choose(i, j)) depth.at(i, j) = Raster::nodata;
    };
}

void add_material(const Draft& draft, std::vector<Change>& changes) {
    if (!draft.rasters.count("depth.tif") || draft.claims.mirror != Mirror::none || is_pile(draft)) return;
    const Raster& depth = draft.rasters.at("depth.tif");
    Index i0 = depth.geometry.nx, i1 = -1, j0 = depth.geometry.ny, j1 = -1;
    double sum = 0.0;
    std::vector<std::pair<Index, Index>> pixels;
    for (Index j = 0; j < depth.geometry.ny; ++j)
        for (Index i = 0; i < depth.geometry.nx; ++i)
            if (depth.at(i, j) > 0.0) {
                i0 = std::min(i0, i), i1 = std::max(i1, i), j0 = std::min(j0, j), j1 = std::max(j1, j);
                sum += depth.at(i, j);
                pixels.emplace_back(i, j);
            }
    if (pixels.size() > 1) {
        const Index ic = (i0 + i1) / 2, jc = (j0 + j1) / 2;
        changes.push_back(without([=](Index i, Index) { return i <= ic; }));
        changes.push_back(without([=](Index i, Index) { return i > ic; }));
        changes.push_back(without([=](Index, Index j) { return j <= jc; }));
        changes.push_back(without([=](Index, Index j) { return j > jc; }));
    }
    if (pixels.size() <= 12 && pixels.size() > 1)
        for (const auto& pixel : pixels)
            changes.push_back(without([=](Index i, Index j) { return i == pixel.first && j == pixel.second; }));
    const double mean = single(sum / static_cast<double>(std::max<std::size_t>(1, pixels.size())));
    changes.push_back([=](Draft& d) {  // one depth
        for (double& h : d.rasters["depth.tif"].values) h = h > 0.0 ? mean : h;
    });
}

/// Keys at their defaults, fewer points, no motion.
void add_defaults(const Draft& draft, std::vector<Change>& changes) {
    for (const auto& [key, value] : draft.keys) {
        if (is_needed(key) || (is_pile(draft) && holds_pile(key)) || (is_lake(draft) && key == "boundary.sides"))
            continue;
        const std::string name = key;
        changes.push_back([name](Draft& d) { d.keys.erase(name); });
    }
    for (const char* table :
         {"scheme.", "material.rheology.", "material.bed.", "release.velocity", "barrier#0.", "water."}) {
        const std::string prefix = table;
        if (is_pile(draft) && holds_pile(prefix)) continue;
        changes.push_back([prefix](Draft& d) {  // all of a table, since a law's keys need one another
            for (auto key = d.keys.begin(); key != d.keys.end();)
                key = key->first.rfind(prefix, 0) == 0 ? d.keys.erase(key) : std::next(key);
        });
    }
    // One point a cell stands on the corner of four pixels, and has the velocity of one of them.
    const bool one_may_break_symmetry = draft.claims.mirror != Mirror::none && draft.has("release.velocity");
    if (draft.has("particles.per_cell") && !one_may_break_symmetry)
        changes.push_back([](Draft& d) { d.keys["particles.per_cell"] = "1"; });
    if (draft.rasters.count("vx.tif"))
        changes.push_back([](Draft& d) {
            d.keys.erase("release.velocity");
            d.rasters.erase("vx.tif");
            d.rasters.erase("vy.tif");
        });
}

/// A change that gives each node of the ground f(dem, i, j).
template <class Ground>
Change with_ground(Ground f) {
    return [f](Draft& d) {
        Raster& dem = d.rasters["dem.tif"];
        for (Index j = 0; j < dem.geometry.ny; ++j)
            for (Index i = 0; i < dem.geometry.nx; ++i) dem.at(i, j) = f(dem, i, j);
    };
}

/// Ground that varies less, and stands near zero.
void add_ground(const Draft& draft, std::vector<Change>& changes) {
    if (is_pile(draft)) return;
    const auto hole = [](double z, double otherwise) { return std::isnan(z) ? z : otherwise; };
    changes.push_back(with_ground([hole](const Raster& z, Index i, Index j) { return hole(z.at(i, j), 0.0); }));
    if (draft.claims.mirror != Mirror::diagonal) {
        changes.push_back(with_ground([](const Raster& z, Index i, Index) { return z.at(i, 0); }));
        changes.push_back(with_ground([](const Raster& z, Index, Index j) { return z.at(0, j); }));
    }
    double low = INFINITY;
    for (const double z : draft.dem().values) low = std::isnan(z) ? low : std::min(low, z);
    changes.push_back(with_ground([low](const Raster& z, Index i, Index j) { return single(z.at(i, j) - low); }));
    changes.push_back([](Draft& d) {
        for (auto& [name, raster] : d.rasters) raster.geometry.x0 = raster.geometry.y0 = 0.0;
    });
}

class Shrinker {
public:
    Shrinker(const Draft& draft, const std::function<Verdict(const Draft&)>& judge, Index budget)
        : judge_(judge), budget_(budget) {
        best_.draft = draft;
        best_.verdict = judge(draft);
    }

    Shrunk result() {
        if (!best_.verdict.broken) return best_;
        shorten();
        for (bool better = true; better && best_.trials < budget_;) {
            better = false;
            for (const auto add : {add_cuts, add_material, add_defaults, add_ground}) {
                std::vector<Change> changes;
                add(best_.draft, changes);
                for (const Change& change : changes) {
                    if (best_.trials >= budget_) break;
                    const bool took = take(change);
                    better = better || took;
                    // The other cuts were made for the larger draft.
                    if (took && (add == add_cuts || add == add_material)) break;
                }
            }
        }
        return best_;
    }

private:
    void shorten() { best_.draft.steps = std::max<Index>(1, best_.verdict.broken->step + 1); }

    bool take(const Change& change) {
        Draft next = best_.draft;
        change(next);
        if (same(next, best_.draft)) return false;
        best_.trials += 1;
        const Verdict verdict = judge_(next);
        if (!verdict.broken || verdict.broken->invariant != best_.verdict.broken->invariant) return false;
        best_.draft = std::move(next);
        best_.verdict = verdict;
        shorten();
        return true;
    }

    const std::function<Verdict(const Draft&)>& judge_;
    Index budget_;
    Shrunk best_;
};

}  // namespace

Shrunk shrink(const Draft& draft, const std::function<Verdict(const Draft&)>& judge, Index budget) {
    return Shrinker(draft, judge, budget).result();
}

}  // namespace frana::fuzz
