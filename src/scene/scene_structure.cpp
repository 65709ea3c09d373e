// [material.structure] of a case: solids that hold together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "law/structured_keys.h"
#include "scene/barrier_box.h"
#include "scene/law_places.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

class StructureReader {
public:
    StructureReader(const CaseFile& file, Scene& scene, Problems& problems)
        : case_(file), scene_(scene), problems_(problems) {}

    std::optional<Structure> read() {
        if (case_.word(key("law")) == "none") return {};
        Structure structure;
        structure.cohesion = number("cohesion");
        structure.share = number("fraction");
        structure.hydrostatic = case_.word(key("earth_pressure")) == "hydrostatic";
        structure.cfl = number("cfl");
        structure.confined = number("confined_water");
        structure.unrolled = case_.flag("terrain.unrolled");
        StructuredMaterial& m = structure.material;
        read_numbers(case_, key(""), laws::structured_keys(), m);
        if (given("bulk_modulus")) m.poisson = poisson(m.young);
        if (!structure.hydrostatic) refuse_steep_friction();
        m.yield = yield();
        m.damage_by = damage_by();
        if (given("critical_length"))
            m.critical_strain = critical_strain(m.critical_strain, number("critical_length"), scene_.bed.geometry.cell);
        if (structure.unrolled) require_sines();
        if (m.dilatancy > m.friction)
            problems_.add(case_.place(key("dilatancy_angle_deg")),
                          fmt::format("found {:.6g}", number("dilatancy_angle_deg")),
                          fmt::format("expected at most friction_angle_deg = {:.6g}", number("friction_angle_deg")),
                          "give a smaller angle");
        refuse_mirrors();
        for (const Barrier& barrier : scene_.barriers) require_box(barrier);
        if (problems_.empty()) remark_widened();
        return structure;
    }

private:
    static std::string key(const char* name) { return std::string("material.structure.") + name; }
    bool given(const char* name) const { return case_.given(key(name)); }
    double number(const char* name) const { return case_.number(key(name)); }

    /// The horizontal pressure of squeezed grains is Kp = tan(45 + angle / 2)^2 times their weight: 14 times at 60
    /// degrees, 58 at 75. That pressure then grows within a step, and they run away. Grains have 25 to 50 degrees; what
    /// stands steeper coheres.
    void refuse_steep_friction() {
        constexpr double kSteepest = 60.0;
        const double angle = number("friction_angle_deg");
        if (angle <= kSteepest) return;
        problems_.add(
            case_.place(key("friction_angle_deg")), fmt::format("found {:.6g}", angle),
            fmt::format("expected at most {:g} with earth_pressure = \"rankine\": grains have 25 to 50 degrees, and "
                        "beyond {:g} their passive pressure makes squeezed ones run away",
                        kSteepest, kSteepest),
            "give a smaller angle and the rest of the strength as cohesion, or earth_pressure = \"hydrostatic\"");
    }

    /// Sides only push a block, which could then part from its other half.
    void refuse_mirrors() {
        if (scene_.sides != Sides::mirror) return;
        problems_.add(case_.place("boundary.sides"), "found \"mirror\" beside material.structure",
                      "expected \"open\" or \"wall\": structured particles know no plane of symmetry",
                      "give \"wall\", or the whole of the scene");
    }

    double poisson(double young) {
        const double bulk = number("bulk_modulus");
        if (young < 3.0 * bulk) return (3.0 * bulk - young) / (6.0 * bulk);
        problems_.add(case_.place(key("bulk_modulus")),
                      fmt::format("found {:.6g} Pa with young_modulus = {:.6g} Pa{}", bulk, young,
                                  young >= 9.0 * bulk ? ", which no solid can have" : ": a negative Poisson ratio"),
                      "expected more than a third of young_modulus", "give a larger bulk_modulus, or poisson_ratio");
        return 0.3;
    }

    StructuredYield yield() const {
        if (case_.word(key("law")) == "mohr_coulomb") return StructuredYield::hexagon;
        return case_.word(key("cone")) == "plane_strain" ? StructuredYield::plane_strain : StructuredYield::compression;
    }
    DamageBy damage_by() const {
        const std::string& word = case_.word(key("damage"));
        return word == "extension" ? DamageBy::extension : word == "strain" ? DamageBy::strain : DamageBy::dilation;
    }

    /// Heights over the length along the ground do not differ by more than that length.
    void require_sines() {
        const Raster& bed = scene_.bed;
        for (Index j = 0; j < bed.geometry.ny; ++j)
            for (Index i = 0; i + 1 < bed.geometry.nx; ++i) {
                if (!(std::abs(bed.at(i + 1, j) - bed.at(i, j)) > bed.geometry.cell)) continue;
                problems_.add(case_.place("terrain.unrolled"),
                              fmt::format("found true, and a rise of {:.6g} m over {:.6g} m at x {:.10g}, y {:.10g}",
                                          std::abs(bed.at(i + 1, j) - bed.at(i, j)), bed.geometry.cell,
                                          bed.geometry.x(i), bed.geometry.y(j)),
                              "expected no rise longer than the way along the ground",
                              "correct the elevation model, or remove unrolled");
                return;
            }
    }

    /// Obstacles are boxes along the axes; their height does not count.
    void require_box(const Barrier& barrier) {
        bool box = barrier.outline.parts.size() == 1 && barrier.outline.parts.front().rings.size() == 1;
        if (box) {
            const std::vector<Vec2>& ring = barrier.outline.parts.front().rings.front();
            const auto [low, high] = bounds_of(barrier);
            const double slack = 1e-6 * (high - low).maxCoeff();
            const auto on = [&](double at, double a, double b) {
                return std::abs(at - a) <= slack || std::abs(at - b) <= slack;
            };
            box = ring.size() == 4;
            for (const Vec2& corner : ring)
                box = box && on(corner.x(), low.x(), high.x()) && on(corner.y(), low.y(), high.y());
        }
        if (box) return;
        problems_.add(case_.table_place(table_of(barrier)),
                      fmt::format("found barrier \"{}\" beside material.structure", barrier.name),
                      "expected an outline that is one rectangle along x and y, the only barrier that structured "
                      "particles know",
                      "give such an outline, or raise the elevation model there");
    }

    /// That tells most: with `each` a table has more barriers than one, and theirs is the first.
    std::string table_of(const Barrier& barrier) const {
        const auto n = static_cast<std::size_t>(&barrier - scene_.barriers.data());
        return fmt::format("barrier.{}",
                           scene_.barriers.size() == static_cast<std::size_t>(case_.count("barrier")) ? n : 0);
    }

    /// Of the thinnest, for all.
    void remark_widened() const {
        constexpr double kRoundOff = 1.0 - 1e-9;
        const double cell = scene_.bed.geometry.cell, least = kBoxCells * cell;
        std::size_t thin = 0;
        double thinnest = INFINITY;
        std::string name;
        for (const Barrier& barrier : scene_.barriers) {
            if (is_buried(barrier, scene_.bed)) continue;
            const BarrierBox box = bounds_of(barrier);
            const double width = (box.high - box.low).minCoeff();
            if (width >= kRoundOff * least) continue;
            ++thin;
            if (width < thinnest) thinnest = width, name = barrier.name;
        }
        if (thin == 0) return;
        scene_.log.push_back(
            fmt::format("barriers: found {} of {} thinner than {:g} cells of {:.6g} m, the thinnest \"{}\" with {:.4g} "
                        "m; structured "
                        "particles would go through those, and meet boxes {:.4g} m wide about their middles; give a "
                        "smaller grid.cell "
                        "if that is too wide",
                        thin, scene_.barriers.size(), kBoxCells, cell, name, thinnest, least));
    }

    const CaseFile& case_;
    Scene& scene_;
    Problems& problems_;
};

}  // namespace

std::optional<Structure> read_structure(const CaseFile& file, Scene& scene, Problems& problems) {
    return StructureReader(file, scene, problems).read();
}

}  // namespace frana
