#include "coupling/two_phase_flow.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/error.h"

namespace frana {
namespace {

double confined_volume(const StructuredFlow& particles) {
    const StructuredPoints& q = particles.body().points;
    double sum = 0.0;
    for (Index p = 0; p < q.count(); ++p) sum += q.confined[p] + q.released[p];
    return sum;
}

}  // namespace

TwoPhaseFlow::TwoPhaseFlow(const TwoPhaseScene& scene)
    : structured_(scene.structured), water_(scene.water), alone_(scene.alone) {
    expect(scene.structured.grid == scene.water.grid, "particles and water share a grid");
    expect(!alone_ || scene.structured.points.x.empty(), "water alone has no particles beside it");
    FreeWater water{
        scene.exchange, TwoPhaseDrag(scene.exchange.material), nullptr, nullptr, nullptr, nullptr, 0.0, {}, {}, {}};
    water_.lend(water);
    structured_.meet(water);
    confine();
    update_totals();
    volume_given_ = confined_volume(structured_) + water_.status().volume;
}

/// The water lies on what is bound, as it stands now.
void TwoPhaseFlow::confine() {
    const StructuredBody& body = structured_.body();
    const Index nx = body.grid.nx(), ny = body.grid.ny();
    const auto set = [&](const std::vector<Index>& tiles, auto&& depth) {
        for (const Index tile : tiles) {
            const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
            for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, ny); ++j)
                for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, nx); ++i)
                    water_.confine(i, j, depth(body.grid.at(i, j)));
        }
    };
    set(confined_, [](Index) { return 0.0; });
    set(body.active.work, [&](Index k) { return body.moved[k].depth; });
    if (water_.body().share) mix();
    confined_ = body.active.work;
}

/// The same of the share of what is bound, and its velocity.
void TwoPhaseFlow::mix() {
    const StructuredBody& body = structured_.body();
    const auto each = [&](const std::vector<Index>& tiles, auto&& set) {
        for (const Index tile : tiles) {
            const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
            for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, body.grid.ny()); ++j)
                for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, body.grid.nx()); ++i) set(i, j);
        }
    };
    each(confined_, [&](Index i, Index j) { water_.mix(i, j, 0.0, {0, 0}); });
    each(body.active.work, [&](Index i, Index j) {
        const StructuredBody::Moved& node = body.moved[body.grid.at(i, j)];
        const double h = water_.body().now.h[water_.body().grid.at(i, j)];
        if (node.depth > 0.0) water_.mix(i, j, node.depth / (node.depth + h), {node.vx, node.vy});
    });
}

/// Particles that outrun the water's waves, or that there is no water with yet, bound its step as well. 0: they do not.
double TwoPhaseFlow::step_of_particles() const {
    constexpr double kPart = 0.45;
    const double reach = kPart * structured_.body().grid.cell(), wave = structured_.wave();
    return wave > 0.0 ? reach / wave : 0.0;
}

double TwoPhaseFlow::longest_step() const {
    const double water = water_.longest_step(), particles = step_of_particles();
    return water > 0.0 && particles > 0.0 ? std::min(water, particles) : std::max(water, particles);
}

void TwoPhaseFlow::advance(double until) {
    const double longest = step_of_particles();
    water_.advance(longest > 0.0 ? std::min(until, time() + longest) : until);
    if (!alone_) move_particles();
    update_totals();
}

/// To the water's time.
void TwoPhaseFlow::move_particles() {
    const double end = water_.status().time;
    reached_tiles_ = structured_.body().active.work;
    while (structured_.status().time < end) {
        structured_.advance(end);
        touch(structured_.body().active.work);
    }
    structured_.sample();
    water_.take_changes(reached_tiles_);
    confine();
}

void TwoPhaseFlow::touch(const std::vector<Index>& tiles) {
    if (std::includes(reached_tiles_.begin(), reached_tiles_.end(), tiles.begin(), tiles.end())) return;
    scratch_.clear();
    std::set_union(reached_tiles_.begin(), reached_tiles_.end(), tiles.begin(), tiles.end(),
                   std::back_inserter(scratch_));
    reached_tiles_.swap(scratch_);
}

void TwoPhaseFlow::update_totals() {
    const WaterBody& w = water_.body();
    potential_ = kinetic_ = 0.0;
    const double per = w.steep ? 0.5 / w.grid.cell() : 0.0;
    for (const Index tile : w.work) {
        const Index i0 = w.grid.tile_i(tile), j0 = w.grid.tile_j(tile);
        for (Index j = j0; j < std::min(j0 + kTile, w.grid.ny()); ++j)
            for (Index i = i0; i < std::min(i0 + kTile, w.grid.nx()); ++i) {
                const Index k = w.grid.at(i, j);
                const double h = w.now.h[k];
                potential_ += h * (w.datum + w.bed[k] + w.confined[k] + 0.5 * h);
                if (h <= w.film) continue;
                const double qx = w.now.qx[k], qy = w.now.qy[k];
                const double up = per * (qx * (w.bed[k + 1] - w.bed[k - 1]) +
                                         qy * (w.bed[k + w.grid.stride()] - w.bed[k - w.grid.stride()]));
                kinetic_ += 0.5 * (qx * qx + qy * qy + up * up) / h;
            }
    }
    const double area = w.grid.cell() * w.grid.cell();
    potential_ *= area * w.gravity, kinetic_ *= area;
}

void TwoPhaseFlow::serialize(Archive& archive) {
    {
        const Archive::Part part(archive, "columns");
        structured_.serialize(archive);
    }
    {
        const Archive::Part part(archive, "water");
        water_.serialize(archive);
    }
    archive.numbers("weights", {&volume_given_, &potential_, &kinetic_});
    if (!archive.loading()) return;
    structured_.sample();  // with the water that has been loaded
    confine();
}

double TwoPhaseFlow::sub_cycles() const {
    const Index steps = water_.status().step;
    return steps > 0 ? static_cast<double>(structured_.status().step) / static_cast<double>(steps) : 0.0;
}

double TwoPhaseFlow::confined() const { return confined_volume(structured_); }

double TwoPhaseFlow::volume_residual() const {
    const WaterLedger& l = water_.status().ledger;
    return confined_volume(structured_) + structured_.status().confined_left + water_.status().volume + l.left +
           l.infiltrated - l.rained - l.entered - l.fed - volume_given_;
}

}  // namespace frana
