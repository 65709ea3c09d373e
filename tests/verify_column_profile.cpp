// The 3D model's sand against grains: the deposit of a plane column by contact dynamics (Lagree, Staron,
// Popinet 2011).
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "catch.h"
#include "checks/verify/body.h"
#include "shared_data.h"

using namespace frana;

namespace {

/// Last profile of the column of that height over half its length: height over the initial one against the
/// place over it, mean of both sides.
class Deposit {
public:
    Deposit(const std::filesystem::path& file, double aspect) {
        std::ifstream stream(file);
        std::string line;
        std::getline(stream, line);
        double last = -1.0;
        while (std::getline(stream, line)) {
            std::replace(line.begin(), line.end(), ',', ' ');
            std::istringstream numbers(line);
            double a = 0.0, frame = 0.0, x = 0.0, h = 0.0;
            numbers >> a >> frame >> x >> h;
            if (std::abs(a - aspect) > 0.01 || frame < last) continue;
            if (frame > last) points_.clear();
            last = frame;
            points_.emplace_back(x, h);
        }
        std::sort(points_.begin(), points_.end());
    }
    std::size_t count() const { return points_.size(); }
    double at(double x) const { return 0.5 * (side(x) + side(-x)); }

private:
    double side(double x) const {
        const auto next = std::lower_bound(points_.begin(), points_.end(), std::make_pair(x, -1.0));
        if (next == points_.begin() || next == points_.end()) return 0.0;
        const auto before = next - 1;
        return before->second + (next->second - before->second) * (x - before->first) / (next->first - before->first);
    }
    std::vector<std::pair<double, double>> points_;
};

/// Half a column 2 m long and 1 m high, 8 cells, of those grains on a floor that holds them; at rest.
Mpm3d collapsed(double cell) {
    const double length = 2.0, height = 1.0, width = 3.0 * cell, density = 1000.0, gravity = 9.81, poisson = 0.3;
    const double modulus = density * 100.0 * gravity * height;  // sound ten times as fast as a wave on it
    SolidScene s;
    s.density = density;
    s.gravity = {0, 0, -gravity};
    s.grid = verify::grid_around({}, {0, 0, 0}, {6.5, width, height}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck), Surface::plane({0, 0, 0}, {1, 0, 0})};
    verify::add_slice(s, width);
    s.flip = true;
    s.blending = std::sqrt(cell / gravity);
    constexpr double kDiameter = 0.005 / 0.149;  // over the height
    s.law = solid::MuI{solid::Elastic::of(modulus * (1.0 + poisson) * (1.0 - 2.0 * poisson) / (1.0 - poisson), poisson),
                       0.32,
                       0.60,
                       0.4,
                       kDiameter * height,
                       1.0,
                       density};
    verify::for_each_part({0, 0, 0}, {length, width, height}, cell, 2,
                          [&](const Vec3& x, double volume) { s.points.add(x, Vec3::Zero(), density * volume); });
    Mpm3d flow(s);
    while (flow.status().time < 3.0) flow.advance(3.0);
    return flow;
}

}  // namespace

TEST_CASE("A column of sand comes to rest as a column of grains does", "[verify][solid]") {
    const auto data = shared_data("lab_column_collapse_dcm");
    if (!data) return;
    constexpr double kCell = 0.125;
    const Deposit grains(*data / "profiles.csv", 0.5);
    REQUIRE(grains.count() > 100);
    const Mpm3d sand = collapsed(kCell);
    std::vector<double> heights(60, 0.0);  // volume without stress in each cell's width
    for (Index p = 0; p < sand.body().points.count(); ++p)
        heights[static_cast<std::size_t>(sand.position(p).x() / kCell)] +=
            sand.body().points.rest_volume[p] / (3.0 * kCell * kCell);
    double apart = 0.0, area = 0.0;
    for (std::size_t n = 0; n + 1 < heights.size(); ++n) {  // means over two cells: points stand half of one apart
        const double x = kCell * static_cast<double>(n + 1);
        apart += kCell * std::abs(0.5 * (heights[n] + heights[n + 1]) - grains.at(x));
        area += kCell * grains.at(x);
    }
    INFO("area between the profiles over the deposit's: " << apart / area);
    CHECK(apart / area < 0.1);  // two fifths of a cell in height; measured 0.049, with a constant angle 0.082
}
