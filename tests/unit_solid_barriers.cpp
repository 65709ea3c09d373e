// Barriers: distances, faces, corners, ways that end on them, walls along a line.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

#include "base/constants.h"
#include "base/error.h"
#include "catch.h"
#include "checks/verify/box_mesh.h"
#include "fake_gis.h"
#include "prism_maker.h"
#include "solid3d/face_ledger.h"

using namespace frana;

namespace {

/// Its corner that stands in is at (2, 2).
Polygons l_shape() { return ring({{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}}); }

std::vector<Contact> all_contacts(const Prism& prism, const Vec3& x, double cell) {
    Contact list[kMostContacts];
    const int count = prism.contacts(x, cell, list);
    return {list, list + count};
}

/// Numbers from 0 to 1, the same everywhere.
struct Dice {
    std::uint32_t state = 12345;
    double operator()() {
        state = state * 1664525u + 1013904223u;
        return state / 4294967296.0;
    }
};

}  // namespace

TEST_CASE("A box's nearest face, edge or corner is found from all around, and from inside", "[solid]") {
    const Surface house = Surface::barrier(Prism(rectangle(0, 0, 10, 4), 3.0));
    Dice dice;
    for (int n = 0; n < 2000; ++n) {
        const Vec3 x(-5 + 20 * dice(), -5 + 14 * dice(), -3 + 9 * dice());
        const Vec3 q(std::abs(x.x() - 5) - 5, std::abs(x.y() - 2) - 2, x.z() - 3);
        const double exact = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
        const Contact c = contact(house, x);
        CAPTURE(x.x(), x.y(), x.z());
        REQUIRE(c.distance == Approx(exact).margin(1e-12));
        REQUIRE(house.inside(x) == (exact < 0.0));
        // Away from it the normal leads, as steep as a distance: checked by the foot that it leads to.
        const Contact foot = contact(house, x - c.distance * c.normal);
        REQUIRE(std::abs(foot.distance) < 1e-9);
        REQUIRE(c.normal.norm() == Approx(1.0).epsilon(1e-12));
    }
    CHECK(contact(house, {5, -1, 0}).face == 0);
    CHECK(contact(house, {11, 2, 0}).face == 1);
    CHECK(contact(house, {5, 5, 0}).face == 2);
    CHECK(contact(house, {-1, 2, 0}).face == 3);
    CHECK(contact(house, {5, 2, 4}).face == 4);
}

TEST_CASE("Outlines may run either way round, have holes, and end where they began", "[solid]") {
    const Prism with(rectangle(0, 0, 4, 4), 1.0);
    const Prism against(ring({{0, 4}, {4, 4}, {4, 0}, {0, 0}, {0, 4}}), 1.0);
    Polygons court = rectangle(0, 0, 10, 10);
    court.parts[0].rings.push_back({{4, 4}, {6, 4}, {6, 6}, {4, 6}});
    const Prism hole(court, 1.0);
    Dice dice;
    for (int n = 0; n < 500; ++n) {
        const Vec3 x(-2 + 14 * dice(), -2 + 14 * dice(), -2 + 4 * dice());
        REQUIRE(with.inside(x) == against.inside(x));
        const auto in = [&](double low, double high) {
            return x.x() > low && x.x() < high && x.y() > low && x.y() < high;
        };
        REQUIRE(hole.inside(x) == (in(0, 10) && !in(4, 6) && x.z() < 1.0));
    }
    CHECK(all_contacts(hole, {5, 4.5, 0}, 0.1).at(0).normal.isApprox(Vec3(0, 1, 0)));
}

TEST_CASE("A corner that stands in is a corner of two planes, from before it and from inside", "[solid]") {
    const Prism angle(l_shape(), 3.0);
    const auto before = all_contacts(angle, {2.3, 2.5, 1}, 0.5);
    REQUIRE(before.size() == 2);
    CHECK(before[0].distance == Approx(0.3));
    CHECK(before[0].normal.isApprox(Vec3(1, 0, 0)));
    CHECK(before[1].distance == Approx(0.5));
    CHECK(before[1].normal.isApprox(Vec3(0, 1, 0)));
    // Two planes there show the same images.
    const std::vector<Surface> planes = {Surface::plane({2, 2, 0}, {1, 0, 0}), Surface::plane({2, 2, 0}, {0, 1, 0})};
    const std::vector<Surface> corner = {
        Surface::barrier(Prism(ring({{-40, -40}, {60, -40}, {60, 2}, {2, 2}, {2, 60}, {-40, 60}}), 300.0))};
    const MirrorParticles of_planes(planes, 3u, {2.3, 2.5, 1}, 0.5), of_corner(corner, 1u, {2.3, 2.5, 1}, 0.5);
    REQUIRE(of_planes.end() - of_planes.begin() == 3);
    REQUIRE(of_corner.end() - of_corner.begin() == 3);
    for (int n = 0; n < 3; ++n) {
        CHECK((of_planes.begin()[n].place - of_corner.begin()[n].place).norm() < 1e-12);
        CHECK((of_planes.begin()[n].motion - of_corner.begin()[n].motion).norm() < 1e-12);
    }
    // Inside: behind both faces, and behind one of them only.
    const auto behind = all_contacts(angle, {1.8, 1.9, -10}, 0.2);
    REQUIRE(behind.size() == 2);
    CHECK(behind[0].distance + behind[1].distance == Approx(-0.3));
    const auto adjacent = all_contacts(angle, {1.9, 2.2, -10}, 0.2);
    REQUIRE(adjacent.size() == 2);
    CHECK(adjacent[0].distance == Approx(-0.1));
    CHECK(adjacent[1].distance == Approx(0.2));
}

TEST_CASE("In corners of a barrier of any width no mirror particle stands where material may be", "[solid]") {
    const double wide = GENERATE(60.0, 70.0, 90.0, 110.0, 130.0) * constants::kPi / 180.0;
    const Vec2 ray(std::cos(wide), std::sin(wide));
    // A solid around the wedge between +x and the ray, large against the reach.
    const std::vector<Surface> corner = {Surface::barrier(
        Prism(ring({{0, 0}, 50 * ray, 50 * ray + Vec2(-90, 0), {-90, -50}, {50, -50}, {50, 0}}), 100.0))};
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        const double angle = share * wide;
        const Vec3 x(1.5 * std::cos(angle), 1.5 * std::sin(angle), 0);
        REQUIRE(!corner[0].inside(x));
        const MirrorParticles mirrors(corner, 1u, x, 1.0);
        CHECK(mirrors.end() - mirrors.begin() >= 2);
        for (const MirrorParticle& mirror : mirrors) {
            CAPTURE(wide, share, mirror.place.x(), mirror.place.y());
            CHECK(contact(corner[0], mirror.place).distance < 1e-9);
        }
    }
}

TEST_CASE("Mirror particles of a lattice around a box fill it once, at its edges and corners too", "[solid]") {
    constexpr double kCell = 1.0, kPart = 0.5, kDeep = 1.5;
    const auto [name, surface] = GENERATE(
        table<std::string, Surface>({{"outline", Surface::barrier(Prism(rectangle(0, 0, 8, 8), 6.0))},
                                     {"mesh", Surface::barrier(verify::box_as_mesh({0, 0, -14}, {8, 8, 6}, kCell))}}));
    CAPTURE(name);
    const std::vector<Surface> box = {surface};
    std::map<std::array<long, 3>, double> filled;
    const auto key = [&](const Vec3& x) {
        return std::array{std::lround(4.0 * x.x()), std::lround(4.0 * x.y()), std::lround(4.0 * x.z())};
    };
    const auto for_each_place = [&](double low, double high, const auto& take) {
        for (double z = low + 0.5 * kPart; z < high; z += kPart)
            for (double y = low + 0.5 * kPart; y < 4.0; y += kPart)
                for (double x = low + 0.5 * kPart; x < 4.0; x += kPart) take(Vec3(x, y, z));
    };
    for_each_place(-4.0, 10.0, [&](const Vec3& x) {
        if (box[0].inside(x)) return;
        for (const MirrorParticle& mirror : MirrorParticles(box, 1, x, kCell))
            filled[key(mirror.place)] += mirror.share;
    });
    int deep = 0;
    for_each_place(0.0, 6.0, [&](const Vec3& x) {
        if (std::min({x.x(), x.y(), 6.0 - x.z()}) > kDeep) return;
        CAPTURE(x.x(), x.y(), x.z());
        REQUIRE(filled[key(x)] == Approx(1.0).epsilon(1e-12));  // without shares up to 3
        ++deep;
    });
    CHECK(deep > 500);
}

TEST_CASE("No way that ends inside or beyond a barrier misses its faces, seams included", "[solid]") {
    const Prism angle(l_shape(), 3.0);
    Dice dice;
    int crossings = 0;
    for (int n = 0; n < 20000; ++n) {
        const auto place = [&] { return Vec3(-2 + 10 * dice(), -2 + 10 * dice(), 5 * dice()); };
        Vec3 from = place(), to = place();
        // A third of the ways lead through an upright edge, another third through the rim of the top.
        const Vec3 aim = n % 3 == 0 ? Vec3(n % 2 == 0 ? 6 : 2, 2, 3 * dice()) : Vec3(0, 6 * dice(), 3);
        if (n % 3 != 2) to = from + (1.0 + dice()) * (aim - from);
        if (angle.inside(from)) continue;
        Entry entry;
        const bool enters = angle.enters(from, to, entry);
        bool met = false;
        for (int k = 1; k <= 400; ++k) met |= angle.inside(from + k / 400.0 * (to - from));
        if (met) {
            REQUIRE(enters);
            ++crossings;
        }
        if (enters) {
            const Vec3 at = from + entry.share * (to - from);
            Contact list[kMostContacts];
            REQUIRE(angle.contacts(at, 1.0, list) > 0);
            REQUIRE(std::abs(list[0].distance) < 1e-7);
        }
    }
    CHECK(crossings > 3000);
}

TEST_CASE("Images in a wall stop at half of its thickness, and those in a thick one are not cut short", "[solid]") {
    const std::vector<Surface> wall = {Surface::barrier(Prism(rectangle(0, -50, 2, 50), 50.0))};
    const MirrorParticles mirrors(wall, 1u, {-0.7, 0, 0}, 1.0);
    REQUIRE(mirrors.end() - mirrors.begin() == 1);
    const MirrorParticle& mirror = *mirrors.begin();
    CHECK((mirror.place - Vec3(0.7, 0, 0)).norm() < 1e-12);
    CHECK(mirror.shows_at({0.99, 3, 3}));
    CHECK(!mirror.shows_at({1.01, 3, 3}));
}

TEST_CASE("The top of a barrier may follow the ground", "[solid]") {
    Raster top = Raster::filled({21, 21, -10.0, -10.0, 1.0}, 0.0);
    for (Index j = 0; j < 21; ++j)
        for (Index i = 0; i < 21; ++i) top.at(i, j) = 2.0 + 0.3 * top.geometry.x(i);
    const Surface dam = Surface::barrier(Prism(rectangle(-5, -2, 5, 2), top));
    const Contact above = contact(dam, {1, 0, 3});
    const Vec3 normal = Vec3(-0.3, 0, 1).normalized();
    CHECK((above.normal - normal).norm() < 1e-12);
    CHECK(above.distance == Approx((3 - 2.3) * normal.z()));
    CHECK(dam.inside({4, 0, 3.1}));
    CHECK(!dam.inside({-4, 0, 3.1}));
    CHECK(contact(dam, {4, -3, 3.0}).distance == Approx(1.0));  // below the rim there
    CHECK(contact(dam, {-4, -3, 3.8}).distance > 2.0);          // far above it here
}

TEST_CASE("A barrier that follows the ground is drawn no higher than the adjacent ground", "[solid]") {
    Raster top = Raster::filled({21, 21, -10.0, -10.0, 1.0}, 6.0);
    top.at(20, 20) = 470.0;
    top.at(10, 12) = 6.5;
    const Prism wall(rectangle(-5.5, -2, 5.5, 2), top);
    CHECK(wall.box().second == Vec3(5.5, 2, 6.5));
    CHECK(Prism(rectangle(8.5, 8.5, 9.5, 9.5), top).box().second.z() == 470.0);  // a part of that cell is in it
    const FaceLedger ledger({Surface::barrier(wall)}, {-9, -9, 0}, {9, 9, 500}, 1.0);
    CHECK(ledger.face(0, 0).patches.count[1] == 7);
    CHECK(Prism(rectangle(-50, -50, -40, -40), top).box().second.z() == 6.0);  // beyond the field it is as at its edge
}

TEST_CASE("A wall along a line keeps its wet face on the line", "[solid]") {
    const Polyline line = {{0, 0}, {10, 0}, {10, 10}};
    for (const WetSide wet : {WetSide::left, WetSide::right}) {
        const Prism wall(wall_outline(line, wet, 1.5), 5.0);
        const double sign = wet == WetSide::left ? 1.0 : -1.0;
        CHECK(!wall.inside({5, sign * 1e-6, 0}));
        CHECK(wall.inside({5, -sign * 1e-6, 0}));
        CHECK(wall.inside({5, -sign * 1.499, 0}));
        CHECK(!wall.inside({5, -sign * 1.501, 0}));
        CHECK(wall.inside({10 + sign * 1.499, 8, 0}));
        CHECK(!wall.inside({10 + sign * 1.501, 8, 0}));
    }
    CHECK(least_wall_thickness({{0, 0}, {10, 0}}, 0.5) == Approx(1.5));
    CHECK(least_wall_thickness({{0, 0}, {10, 10}}, 0.5) == Approx(1.5 * std::sqrt(2.0)));
    CHECK_THROWS_WITH(wall_outline({{0, 0}, {10, 0}, {1, 1}}, WetSide::left, 1.0), Catch::Contains("120 degrees"));
    CHECK_THROWS_WITH(wall_outline({{1, 1}, {1, 1}}, WetSide::left, 1.0), Catch::Contains("two different points"));
    CHECK_THROWS_WITH(Prism(ring({{0, 0}, {1, 1}}), 1.0), Catch::Contains("three corners or more"));
    CHECK_THROWS_WITH(Prism({}, 1.0), Catch::Contains("no polygon"));
    CHECK_THROWS_WITH(Prism(ring({{0, 0}, {1, 1}, {1, 1}, {0, 1}}), 1.0), Catch::Contains("twice in a row"));
}

TEST_CASE("A box as a mesh has the contacts of its outline, at its edges and corners too", "[solid]") {
    constexpr double kCell = 0.5;
    const Surface outline = Surface::barrier(Prism(rectangle(0, 0, 4, 3), 2.0)),
                  mesh = Surface::barrier(verify::box_as_mesh({0, 0, -8}, {4, 3, 2}, kCell));
    Dice dice;
    int shared = 0;
    for (int n = 0; n < 20000; ++n) {
        const Vec3 x(-2 + 8 * dice(), -2 + 7 * dice(), -1 + 5 * dice());
        CAPTURE(x.x(), x.y(), x.z());
        Contact from[kMostContacts], to[kMostContacts];
        int count = contacts(outline, x, kCell, from), same = contacts(mesh, x, kCell, to);
        if (count == 0) continue;
        const Vec3 q = (x - Vec3(2, 1.5, -3)).cwiseAbs() - Vec3(2, 1.5, 5);
        const bool ridge =
            q.maxCoeff() < 0.0 && (q.array() > q.maxCoeff() - 1e-6).count() > 1;  // either face is nearest
        const bool face = (q.array() > 0.0).count() <= 1;
        if (!ridge) {  // edges: trilinear, 0.25 between nodes; at most 0.064 too much, in the middle before a corner
            REQUIRE(to[0].distance == Approx(from[0].distance).margin(face ? 1e-12 : 0.08));
            if (face) REQUIRE((to[0].normal - from[0].normal).norm() < 1e-12);
        }
        const MetFaces met = faces_at_edge({}, outline, x, kCell, from, count),
                       as = faces_at_edge({}, mesh, x, kCell, to, same);
        if (ridge || met.all < 2) continue;
        REQUIRE(as.faced == met.faced);
        REQUIRE(as.all == met.all);
        for (int a = 0; a < met.all; ++a)
            REQUIRE(std::any_of(to, to + as.all, [&](const Contact& c) {
                return (c.normal - from[a].normal).norm() < 1e-9 && std::abs(c.distance - from[a].distance) < 1e-9;
            }));
        ++shared;
    }
    CHECK(shared > 1000);
}

TEST_CASE("A ball as a field of distances: values, faces, ways into it", "[solid]") {
    DistanceField ball;
    ball.origin = {-3, -3, -3}, ball.spacing = 0.1, ball.nodes = {61, 61, 61};
    ball.distance.resize(61 * 61 * 61);
    for (Index k = 0; k < 61; ++k)
        for (Index j = 0; j < 61; ++j)
            for (Index i = 0; i < 61; ++i) ball.at(i, j, k) = ball.place(i, j, k).norm() - 1.0;
    Dice dice;
    for (int n = 0; n < 500; ++n) {
        const Vec3 x = 2.8 * Vec3(2 * dice() - 1, 2 * dice() - 1, 2 * dice() - 1);
        if (x.norm() < 0.5) continue;
        const Contact c = ball.contact(x);
        // Trilinear: an error of s^2 / 8 times the sum of the second derivatives, 2 / r; of the slope, s / 2
        // times them.
        REQUIRE(std::abs(c.distance - (x.norm() - 1.0)) < 0.01 / 8 * 2 / (x.norm() - 0.18) + 1e-12);
        REQUIRE((c.normal - x.normalized()).norm() < 0.2 / (x.norm() - 0.18));
    }
    CHECK(ball.contact({2, 0.1, 0.1}).face == 1);
    CHECK(ball.contact({0.1, 0.1, -2}).face == 4);
    // On from the grid straight along its last slope, which two one-sided differences turn by s / 2r each.
    CHECK(ball.contact({13, 0, 0}).distance == Approx(12.0).margin(10 * 0.05 * 0.05 / 9 + 1e-3));
    Entry entry;
    REQUIRE(ball.enters({-2, 0, 0}, {2, 0, 0}, entry));
    CHECK(entry.share == Approx(0.25).epsilon(1e-3));
    CHECK(!ball.enters({-2, 1.2, 0}, {2, 1.2, 0}, entry));
    CHECK(ball.thickness({-1, 0, 0}, {1, 0, 0}) == Approx(2.0).margin(0.1));
}

TEST_CASE("Patches of a face tell places apart, and a face's moment is about any point", "[solid]") {
    const std::vector<Surface> list = {Surface::plane({0, 0, 0}, {0, 0, 1}),
                                       Surface::barrier(Prism(rectangle(2, 1, 3, 5), 2.0))};
    FaceLedger ledger(list, {0, 0, -1}, {8, 8, 7}, 0.5);
    REQUIRE(ledger.faces().size() == 5);
    const Face& front = ledger.face(1, 3);  // at x = 2, from (2, 5) to (2, 1)
    CHECK(front.patches.count == std::array<Index, 2>{8, 6});
    // Along the face 0.8 from its corner, 1.1 above its foot; the ground at 0 is a square and a half below that.
    const auto at = [&](Index row, Index column) {
        return front.patches.impulse[static_cast<std::size_t>(row * 8 + column)];
    };
    const Vec3 given(-2, 0, 1);
    const auto add = [&](const Vec3& place, double reach) {
        ledger.add({3, front.patches.around(place, reach, list), given, Vec3(2, 4.2, 1.1).cross(given)});
    };
    add({2, 4.2, 1.1}, 0.0);
    CHECK((at(4, 1) - given).norm() == 0.0);
    add({2, 2.5, 1.25}, 0.25);  // a node between two columns, in the middle of a row
    CHECK((at(4, 4) - 0.5 * given).norm() < 1e-12);
    CHECK((at(4, 5) - 0.5 * given).norm() < 1e-12);
    add({2, 1.75, 0.0}, 0.25);  // a node on the ground stands for what lies above it
    CHECK((at(2, 6) - given).norm() < 1e-12);
    add({2, 3.75, -0.2}, 0.1);  // a node below it: all goes to the first square above
    CHECK((at(2, 2) - given).norm() < 1e-12);
    // What material can reach of the squares: nothing in the two rows below the ground, for which a quarter stands.
    CHECK(front.patches.area[0 * 8 + 3] == Approx(0.25 * 0.25));
    CHECK(front.patches.area[2 * 8 + 3] == Approx(0.25));
    const FaceLedger lower({Surface::plane({0, 0, 0.2}, {0, 0, 1}), list[1]}, {0, 0, -1}, {8, 8, 7}, 0.5);
    CHECK(lower.face(1, 3).patches.area[2 * 8 + 3] == Approx(0.25 * 0.6));
    // Ground that slopes along the face cuts from below, not from the side.
    const std::vector<Surface> askew = {Surface::plane({2, 3.75, 0}, Vec3(0, 0.1, 1).normalized()), list[1]};
    const FacePart foot = front.patches.around({2, 3.75, -0.2}, 0.1, askew);
    CHECK(0.5 * (foot.from[0] + foot.to[0]) == Approx(2.5));
    CHECK(foot.from[1] == Approx(2.0));
    Vec3 sum = Vec3::Zero();
    for (const Vec3& impulse : front.patches.impulse) sum += impulse;
    CHECK((sum - front.impulse).norm() < 1e-12);
    CHECK(FaceLedger::moment_about(front, {2, 4.2, 1.1}).norm() < 1e-12);
}

// Squares over the sloping top and in the ground counted too: three times the side's area.
TEST_CASE("Squares of a wall on a slope have the area that its faces have, also askew", "[solid]") {
    const auto ground = [](double x, double y) { return 0.4 * x + 0.2 * y; };
    const Raster bed = sampled({21, 21, -2, -2, 1.0}, ground),
                 top = sampled({21, 21, -2, -2, 1.0}, [&](double x, double y) { return ground(x, y) + 2.0; });
    const double length = 12.0, width = 2.0;
    const Vec2 along(0.8, 0.6), across(-0.6, 0.8), from(3.0, 2.0), to = from + length * along;
    const Polygons outline = ring({from, to, to + width * across, from + width * across});
    const FaceLedger ledger({Surface::ground(bed), Surface::barrier(Prism(outline, top))}, {-2, -2, -4}, {18, 18, 14},
                            0.5);
    const auto area = [&](int face) {
        const Patches& squares = ledger.face(1, face).patches;
        double sum = 0.0;
        for (std::size_t n = 0; n < squares.area.size(); ++n) sum += squares.off_face[n] ? 0.0 : squares.area[n];
        return sum;
    };
    // A quarter at least: the rims' squares may count up to that in excess, here a quarter of half of them.
    const double excess = 0.25 * 0.5 * 0.25 * 2.0 * length / 0.5;
    for (const int side : {0, 2}) {
        CHECK(area(side) >= 2.0 * length * (1.0 - 1e-9));
        CHECK(area(side) <= 2.0 * length + excess);
    }
    CHECK(area(4) >= width * length * (1.0 - 1e-9));
    CHECK(area(4) <= width * length + 2.0 * excess);
}

TEST_CASE("Squares in the bend of an L are not of its top", "[solid]") {
    const FaceLedger ledger({Surface::barrier(Prism(l_shape(), 2.0))}, {-1, -1, -1}, {8, 8, 7}, 0.5);
    const Face& top = ledger.face(0, 6);
    REQUIRE(top.patches.count == std::array<Index, 2>{12, 12});
    REQUIRE(top.patches.off_face.size() == 144);
    for (Index row = 0; row < 12; ++row)
        for (Index column = 0; column < 12; ++column)
            CHECK(bool(top.patches.off_face[static_cast<std::size_t>(row * 12 + column)]) == (row >= 4 && column >= 4));
    const Patches& side = ledger.face(0, 0).patches;
    CHECK(std::count(side.off_face.begin(), side.off_face.end(), 1) == 0);
    // A wall of a twentieth of a square, askew: squares that it passes are on it, however little it covers of them.
    const Polygons thin = ring({{0.1, 0.2}, {6.1, 4.2}, {6.1 - 0.014, 4.2 + 0.021}, {0.1 - 0.014, 0.2 + 0.021}});
    const FaceLedger askew({Surface::barrier(Prism(thin, 2.0))}, {-1, -1, -1}, {8, 8, 7}, 0.5);
    const Patches& rim = askew.face(0, 4).patches;
    for (double t = 0.0; t < 1.0; t += 0.01) {
        const Vec2 at = (Vec2(0.1, 0.2) + t * Vec2(6, 4) - rim.origin.head<2>()) / rim.size;
        const auto square = static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(rim.count[0]) +
                            static_cast<std::size_t>(at.x());
        CHECK_FALSE(rim.off_face[square]);
    }
    CHECK(std::count(rim.off_face.begin(), rim.off_face.end(), 1) > 60);
}
