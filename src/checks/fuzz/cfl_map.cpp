#include "checks/fuzz/cfl_map.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"

namespace frana::fuzz {
namespace {

using Function = double (*)(double, double);

constexpr Index kNodes = 25;      ///< along each side
constexpr double kLength = 24.0;  ///< [m], cells of 1 m

const char* word(Shape shape) {
    return shape == Shape::linear ? "linear" : shape == Shape::quadratic ? "quadratic" : "cubic";
}

const char* word(Transfer transfer) {
    switch (transfer) {
        case Transfer::tpic:
            return "tpic";
        case Transfer::apic:
            return "apic";
        case Transfer::flip:
            return "flip";
        case Transfer::pic:
            return "pic";
    }
    throw InternalError("unknown transfer");
}

double level(double, double) { return 0.0; }
double bowl(double x, double y) { return 0.02 * ((x - 12) * (x - 12) + (y - 12) * (y - 12)); }
double slope(double x, double) { return 24 - 0.84 * x; }
double dam(double x, double) { return x < 12 ? 2.0 : 0.0; }
double column(double x, double y) { return std::hypot(x - 12, y - 12) < 4 ? 3.0 : 0.0; }
double aside(double x, double y) { return std::hypot(x - 9, y - 12) < 5 ? 2.0 : 0.0; }
double everywhere(double, double) { return 1.0; }
double film(double x, double y) { return std::hypot(x - 12, y - 12) < 6 ? 1e-3 : 0.0; }

/// Points on the lattice, `stream` [m/s] towards the middle from both sides.
void fill(Scene& scene, Function depth, int per_side, double stream) {
    const double size = 1.0 / per_side;
    Seeds& seeds = scene.particles;
    for (Index j = 0; j < (kNodes - 1) * per_side; ++j)
        for (Index i = 0; i < (kNodes - 1) * per_side; ++i) {
            const double x = (static_cast<double>(i) + 0.5) * size, y = (static_cast<double>(j) + 0.5) * size;
            const double h = depth(x, y);
            if (!(h > 0.0)) continue;
            seeds.x.push_back(x);
            seeds.y.push_back(y);
            seeds.vx.push_back(x < 0.5 * kLength ? stream : -stream);
            seeds.vy.push_back(0.0);
            seeds.depth.push_back(h);
            seeds.size.push_back(size);
            seeds.volume.push_back(h * size * size);
        }
}

Scene scene_with(const Method& method, Function bed, Function depth, double stream = 0.0) {
    Scene scene;
    scene.bed = Raster::filled(GridGeometry{kNodes, kNodes, 0.0, 0.0, 1.0}, 0.0);
    for (Index j = 0; j < kNodes; ++j)
        for (Index i = 0; i < kNodes; ++i) scene.bed.at(i, j) = bed(static_cast<double>(i), static_cast<double>(j));
    scene.sides = Sides::wall;
    scene.scheme.shape = method.shape;
    scene.scheme.transfer = method.transfer;
    scene.scheme.curvature_length = 0.0;
    if (method.preset == "paper") {
        Scheme& s = scene.scheme;
        s.preset = "paper";
        s.paper_pressure = true;
        s.split = s.merge = s.reset_domains = s.mass_fit = false;
        s.filter = s.viscosity_linear = s.viscosity_quadratic = 0.0;
        scene.terrain = TerrainModel::shallow;
        scene.curvature = Curvature::none;
    }
    fill(scene, depth, method.per_side, stream);
    return scene;
}

}  // namespace

std::string Method::name() const {
    return fmt::format("{}{} {}", preset == "default" ? "" : preset + " ", word(shape), word(transfer));
}

const std::vector<double>& cfl_ladder() {
    static const std::vector<double> ladder = {0.1, 0.25, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0};
    return ladder;
}

std::vector<Method> cfl_methods() {
    std::vector<Method> methods;
    for (const Shape shape : {Shape::linear, Shape::quadratic, Shape::cubic})
        for (const Transfer transfer : {Transfer::tpic, Transfer::apic, Transfer::flip, Transfer::pic})
            for (const int per_side : {1, 2, 3, 4})
                if (shape != Shape::linear || transfer != Transfer::apic)
                    methods.push_back({"default", shape, transfer, per_side});
    for (const Shape shape : {Shape::linear, Shape::quadratic})
        for (const int per_side : {1, 2, 3, 4}) methods.push_back({"paper", shape, Transfer::pic, per_side});
    return methods;
}

std::vector<SuiteScene> cfl_suite(const Method& method) {
    std::vector<SuiteScene> suite;
    suite.push_back({"dam break", scene_with(method, level, dam)});
    suite.push_back({"column", scene_with(method, level, column)});
    suite.push_back({"streams", scene_with(method, level, everywhere, 4.0)});
    suite.push_back({"bowl", scene_with(method, bowl, aside)});
    suite.back().scene.sides = Sides::open;  // a wall is a mirror, which would bend the bowl's edge
    suite.push_back({"slide", scene_with(method, slope, aside)});
    suite.back().scene.bed_law = bed::Voellmy{0.2, 500.0};
    suite.back().scene.sides = Sides::open;
    suite.push_back({"viscous", scene_with(method, level, column)});
    suite.back().scene.rheology = rheology::Newtonian{2000.0};
    suite.push_back({"film", scene_with(method, slope, film)});
    suite.back().scene.bed_law = bed::Coulomb{0.3};
    suite.back().scene.sides = Sides::open;
    return suite;
}

CflRow cfl_row(const Method& method, Index steps) {
    CflRow row{method, 0.0, ""};
    Claims claims;
    claims.resolved = true;
    for (const double cfl : cfl_ladder()) {
        for (SuiteScene& entry : cfl_suite(method)) {
            entry.scene.scheme.cfl = cfl;
            const Verdict verdict = examine(entry.scene, claims, steps);
            if (!verdict.broken) continue;
            row.first_broken = fmt::format("{}: {}", entry.name, verdict.broken->invariant);
            return row;
        }
        row.largest = cfl;
    }
    return row;
}

std::string cfl_table(const std::vector<CflRow>& rows) {
    std::string text = fmt::format("largest stable scheme.cfl, of at most {}, by points a cell\n", cfl_ladder().back());
    text +=
        fmt::format("{:<20} {:>6} {:>6} {:>6} {:>6}  {}\n", "", 1, 4, 9, 16, "what breaks first beyond, at 4 points");
    std::string last, reason;
    for (const CflRow& row : rows) {
        if (row.method.name() != last) {
            if (!last.empty()) text += "  " + reason + "\n";
            last = row.method.name();
            text += fmt::format("{:<20}", last);
        }
        if (row.method.per_side == 2) reason = row.first_broken;
        text += fmt::format(" {:>6.2f}", row.largest);
    }
    return text + "  " + reason + "\n";
}

}  // namespace frana::fuzz
