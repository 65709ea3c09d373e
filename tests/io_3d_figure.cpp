// Pictures of 3D points: barriers put together from their patches, the oblique view, the section.
#include <vtkCellData.h>
#include <vtkPointData.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>

#include "base/constants.h"
#include "catch.h"
#include "fresh_folder.h"
#include "io_3d_pictures.h"
#include "io_figures_scene.h"
#include "read_polydata.h"
#include "vtk_io/figures/colours_3d.h"
#include "vtk_io/figures/figure_3d.h"
#include "vtk_io/reader.h"
#include "vtk_io/writers.h"

using namespace frana;
using figures::cannot_draw;
using figures::drawn;

namespace {

/// A level floor at 10 m, 40 x 20 m.
Raster floor_of_10() { return Raster::filled(GridGeometry{41, 21, 0.0, 0.0, 1.0}, 10.0); }

constexpr double kPush = 3.0e4;  ///< impulse on each patch of the west side above the floor [kg m/s]

/// A side of a wall in patches of 0.5 m from 9.25 m up to 12 m; the last row and column reach beyond it.
PatchedFace side(Index number, const Vec2& from, const Vec2& along, double length) {
    PatchedFace face;
    face.face = number;
    face.corner = {from.x(), from.y(), 9.25};
    face.right = {along.x(), along.y(), 0.0};
    face.up = {0.0, 0.0, 1.0};
    face.size = 0.5;
    face.count = {static_cast<Index>(std::ceil(length / 0.5)), 6};
    face.impulse.assign(static_cast<std::size_t>(face.count[0] * face.count[1]), {0.0, 0.0, 0.0});
    face.area.assign(face.impulse.size(), face.size * face.size);
    return face;
}

/// A wall on [30, 31.2] x [5, 15] m, 2 m high, as the 3D model hands it out: sides counter-clockwise,
/// then the top. On each patch of its west side that is not under the floor there is an impulse eastwards.
std::vector<PatchedFace> wall() {
    std::vector<PatchedFace> faces{side(0, {30, 5}, {1, 0}, 1.2), side(1, {31.2, 5}, {0, 1}, 10.0),
                                   side(2, {31.2, 15}, {-1, 0}, 1.2), side(3, {30, 15}, {0, -1}, 10.0)};
    for (std::size_t k = 20; k < faces[3].impulse.size(); ++k) faces[3].impulse[k] = {kPush, 0.0, 0.0};
    PatchedFace top = side(4, {30, 5}, {1, 0}, 1.2);
    top.corner = {30.0, 5.0, 12.0};
    top.up = {0.0, 1.0, 0.0};
    top.count = {3, 20};
    top.impulse.assign(60, {0.0, 0.0, 0.0});
    faces.push_back(top);
    return faces;
}

/// The wall's faces written by the run's writer at 1.5 s, and read back.
std::vector<LoadedPatch> written_and_read() {
    const FreshFolder folder;
    Frame frame;
    frame.number = 3;
    frame.status.time = 1.5;
    frame.faces = wall();
    make_barrier_writer(folder.path())->observe(frame);
    REQUIRE(barrier_times(folder.path()) == std::vector<double>{1.5});
    return read_barriers(folder.path(), 0);
}

std::vector<BarrierSolid> read_wall() { return barrier_solids(written_and_read(), {{12.0, 0.0}}, floor_of_10()); }

/// Points of 0.25 m: a slow sheet before the wall, and a fast heap where `fast` says.
Moment3d flow(const Vec3& fast, bool with_wall = true) {
    Moment3d moment;
    moment.typical_size = 0.25;
    const auto add = [&](const Vec3& place, double speed) {
        moment.material.push_back({place, 0.25, speed, 10.0, false});
        moment.middle = place;
    };
    for (double x = 12.0; x < 30.0; x += 0.25)
        for (double y = 5.0; y < 15.0; y += 0.25) add({x, y, 10.125}, 0.0);
    for (double x = -1.0; x < 1.0; x += 0.25)
        for (double y = -1.0; y < 1.0; y += 0.25)
            for (double z = 0.0; z < 1.0; z += 0.25) add(fast + Vec3(x, y, z), 10.0);
    moment.momentum = {1.0, 0.0, 0.0};
    moment.middle = {24.0, 10.0, 10.2};
    if (with_wall) moment.barriers = read_wall();
    return moment;
}

Figure3d figure_of(const Moment3d& moment) {
    Figure3d figure;
    figure.bed = floor_of_10();
    figure.moment = moment;
    Shared3d shared;
    shared.add(moment);
    figure.view = shared.view();
    figure.title = "Impact";
    figure.footer = "a test";
    figure.width = 900;
    figure.height = 700;
    return figure;
}

/// The same in hue: channels in the same proportion to within a tenth, whatever the light.
bool alike(const Colour& c, const Colour& colour) {
    const double bright = std::max({colour.r, colour.g, colour.b, std::uint8_t{1}});
    const double most = std::max({c.r, c.g, c.b, std::uint8_t{1}});
    const double off = std::max({std::abs(c.r / most - colour.r / bright), std::abs(c.g / most - colour.g / bright),
                                 std::abs(c.b / most - colour.b / bright)});
    return most > 60.0 && off < 0.1;
}

/// Pixels of the picture without its colour bars that are nearest in hue to a colour.
int like(const Pixels& picture, const Colour& colour) {
    int found = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width * 8 / 10; ++x) found += alike(picture.at(x, y), colour);
    return found;
}

/// How wide the first of two things of one colour is, which stand `apart` of each other across the picture [m], and how
/// wide a pixel is.
struct Width {
    double wide = 0.0, pixel = 0.0;
};
Width width_of_first(const Pixels& picture, const Colour& colour, double apart) {
    std::vector<int> from, to;
    bool within = false;
    for (int x = 0; x < picture.width * 8 / 10; ++x) {
        bool here = false;
        for (int y = 0; y < picture.height && !here; ++y) here = alike(picture.at(x, y), colour);
        if (here && !within) from.push_back(x);
        if (!here && within) to.push_back(x);
        within = here;
    }
    REQUIRE(from.size() == 2);
    REQUIRE(to.size() == 2);
    const double metres = apart / (from[1] - from[0]);
    return {metres * (to[0] - from[0]), metres};
}

/// Two pieces of the material 1.5 m in size, 8 m from each other along the flow and 3 m above the floor.
Figure3d two_pieces(bool particles) {
    Figure3d figure;
    figure.bed = floor_of_10();
    for (const double x : {16.0, 24.0}) figure.moment.material.push_back({{x, 10, 13}, 1.5, 10.0, 10.0, particles});
    figure.moment.typical_size = 1.5;
    figure.view = {{12, 5, 28, 15}, 10.0, 0.0, {1, 0}, {20, 10}};
    figure.look = ViewAngles3d{0.0, 0.3};  // to the north: both are as far away
    figure.width = 900;
    figure.height = 700;
    return figure;
}

}  // namespace

TEST_CASE("The first pressure of a barrier is a mean since the output before, not since the start",
          "[figures][space]") {
    const FreshFolder folder;
    const auto writer = make_barrier_writer(folder.path());
    Frame frame;
    frame.status.time = 1.0;
    writer->observe(frame);  // particles alone: no barrier has faces
    frame.number = 1, frame.status.time = 1.5;
    frame.faces = wall();
    writer->observe(frame);
    double largest = 0.0;
    for (const LoadedPatch& patch : read_barriers(folder.path(), 0)) largest = std::max(largest, patch.pressure);
    CHECK(largest == Approx(kPush / (0.5 * 0.25)));  // in half a second on a quarter of a square metre
}

TEST_CASE("A barrier is put together again from the patches that a run writes", "[space]") {
    const std::vector<BarrierSolid> solids = read_wall();
    REQUIRE(solids.size() == 1);
    const BarrierSolid& solid = solids.front();
    REQUIRE(solid.rings.size() == 1);
    const Polyline corners{{30, 5}, {31.2, 5}, {31.2, 15}, {30, 15}};
    REQUIRE(solid.rings[0].size() == 4);
    for (std::size_t k = 0; k < 4; ++k) CHECK((solid.rings[0][k] - corners[k]).norm() < 1e-12);
    CHECK(solid.within({30.6, 10.0}));
    CHECK_FALSE(solid.within({31.3, 10.0}));
    for (const auto& piece : solid.pieces)
        for (const Vec3& p : piece.corners) {
            CHECK(p.x() >= 30.0 - 1e-12);
            CHECK(p.x() <= 31.2 + 1e-12);  // the third patch of the short sides ends at 31.5
            CHECK(p.z() <= 12.0 + 1e-12);
            CHECK(p.z() >= 10.0 - 0.25 - 1e-12);  // half a patch under the floor
        }
    // 100 patches: 3e6 kg m/s in 1.5 s; pressures are written in single precision
    CHECK(solid.load.x() == Approx(100 * kPush / 1.5).epsilon(1e-6));
    CHECK(std::abs(solid.load.y()) < 1e-6 * solid.load.x());
    CHECK(solid.middle_of_load.y() == Approx(10.0).epsilon(1e-6));
    CHECK(solid.middle_of_load.z() == Approx(9.25 + 0.5 * (0.5 + 3.0)).epsilon(1e-6));
    // away from the margins the mean of equal patches is their pressure
    double highest = 0.0;
    for (const auto& piece : solid.pieces) highest = std::max(highest, piece.pressure);
    CHECK(highest == Approx(kPush / 1.5 / 0.25).epsilon(1e-6));
}

TEST_CASE("A barrier of a height ends that much above the ground", "[space]") {
    Raster slope = floor_of_10();
    for (Index j = 0; j < slope.geometry.ny; ++j)
        for (Index i = 0; i < slope.geometry.nx; ++i) slope.at(i, j) = 10.0 + 0.1 * (slope.geometry.y(j) - 15.0);
    const auto solids = barrier_solids(written_and_read(), {{std::nullopt, 1.5}}, slope);
    REQUIRE(solids.size() == 1);
    double most = -1e300;
    for (const auto& piece : solids[0].pieces)
        for (const Vec3& p : piece.corners) {
            CHECK(p.z() <= elevation_at(slope, p.head<2>()) + 1.5 + 1e-9);
            most = std::max(most, p.z());
        }
    CHECK(most == Approx(11.5));  // at y = 15 m, the highest ground
}

TEST_CASE("In ParaView a barrier stands from the ground to its top, however far its faces reach", "[space]") {
    const FreshFolder folder;
    Raster slope = floor_of_10();
    for (Index j = 0; j < slope.geometry.ny; ++j)
        for (Index i = 0; i < slope.geometry.nx; ++i) slope.at(i, j) = 10.0 + 0.1 * (slope.geometry.y(j) - 15.0);
    Frame frame;
    frame.status.time = 1.5;
    frame.faces = wall();
    frame.grid = slope.geometry;
    Raster with_wall = slope;  // as particles see it
    for (double& z : with_wall.values) z += 1.0;
    frame.nodes = {{"elevation", "m", 1, with_wall.values.data(), with_wall.geometry.size()}};
    make_barrier_writer(folder.path(), {{std::nullopt, 1.5}}, slope)->observe(frame);
    const auto faces = test::polydata(folder.path() / "barriers" / "barriers_000000.vtp");
    vtkDataArray* const shift = faces->GetPointData()->GetArray("to_true_height");
    REQUIRE(shift);
    REQUIRE(shift->GetNumberOfTuples() == faces->GetNumberOfPoints());
    double most = -1e300, least = 1e300;
    for (vtkIdType k = 0; k < faces->GetNumberOfPoints(); ++k) {
        double p[3];
        faces->GetPoint(k, p);
        const double above = p[2] + shift->GetTuple1(k) - elevation_at(slope, {p[0], p[1]});
        CHECK(above >= -0.25 - 1e-6);  // half a patch under the ground; shifts are written in single precision
        CHECK(above <= 1.5 + 1e-6);
        most = std::max(most, above), least = std::min(least, above);
    }
    CHECK(most == Approx(1.5).epsilon(1e-6));
    CHECK(least == Approx(-0.25).epsilon(1e-6));
}

TEST_CASE("Patches around a top that are not on it are not written, unless they had a force", "[space]") {
    const FreshFolder folder;
    Frame frame;
    frame.status.time = 1.5;
    frame.faces = wall();
    PatchedFace& top = frame.faces.back();
    const auto all = top.impulse.size();
    top.off_face.assign(all, 0);
    top.off_face[1] = top.off_face[7] = 1;
    top.impulse[7] = {0.0, 0.0, 5.0};
    make_barrier_writer(folder.path(), {{std::nullopt, 1.5}}, floor_of_10())->observe(frame);
    const auto faces = test::polydata(folder.path() / "barriers" / "barriers_000000.vtp");
    vtkDataArray* const number = faces->GetCellData()->GetArray("face");
    REQUIRE(number);
    std::size_t written = 0;
    for (vtkIdType k = 0; k < faces->GetNumberOfCells(); ++k) written += number->GetTuple1(k) == 4;
    CHECK(written == all - 1);
    CHECK(faces->GetPointData()->GetArray("to_true_height")->GetNumberOfTuples() == faces->GetNumberOfPoints());
}

TEST_CASE("What pictures of a run share: the flow's direction is its force's, and the load is central", "[space]") {
    Shared3d shared;
    Moment3d before = flow({20, 10, 10.2}, false);
    before.momentum = {0.0, 5.0, 0.0};
    shared.add(before);
    CHECK(shared.view().flow.y() == Approx(1.0));
    CHECK(shared.view().pressure == 0.0);
    shared.add(flow({20, 10, 10.2}));
    const View3d view = shared.view();
    CHECK(view.flow.x() == Approx(1.0));
    CHECK(view.through.x() == Approx(30.0));
    CHECK(view.through.y() == Approx(10.0));
    CHECK(view.pressure == Approx(8e4));
    CHECK(view.fastest == Approx(10.0));
    CHECK(view.box[0] < 12.5);
    CHECK(view.box[2] > 31.2);
}

TEST_CASE("The picture of an impact comes as near as three heights of the wall", "[space]") {
    const Moment3d moment = flow({20, 10, 10.2});
    Shared3d shared;
    shared.add(moment);
    const View3d all = shared.view(), close = close_view(all, moment);
    // [30, 31.2] x [5, 15] m; its sides are cut a little below the ground and end 2 m above it: at most 2.75 m in all.
    CHECK(close.box[0] >= 30.0 - 3.0 * 2.75);
    CHECK(close.box[0] <= 30.0 - 3.0 * 2.0);
    CHECK(close.box[0] > all.box[0] + 5.0);
    CHECK(close.box[2] == std::min(all.box[2], 31.2 + (30.0 - close.box[0])));
    CHECK(close.pressure == all.pressure);
    CHECK(close_view(all, flow({20, 10, 10.2}, false)).box == all.box);  // nothing stands there
}

TEST_CASE("The pressure on the wall is drawn next to the block and not over it", "[space]") {
    if (cannot_draw()) return;
    const Colour pressed = colour_at(Colormap::pressure, 1.0);
    const Pixels picture = drawn(render_3d, figure_of(flow({24, 10, 10.2})));
    // The corner has a white rim of its own below it, across the picture.
    int lowest = 0;
    for (int y = 0; y < picture.height; ++y)
        if (alike(picture.at(60, y), pressed)) lowest = lowest == 0 ? y : lowest;
    REQUIRE(lowest > 350);  // row 0 is the lowest of the picture
    int white = 0;
    for (int x = 0; x < picture.width - 200; ++x)
        white += figures::distance(picture.at(x, lowest - 4), colours::white) == 0;
    CHECK(white > 200);
}

TEST_CASE("The oblique view shows points by their speed, and none through the ground", "[space]") {
    if (cannot_draw()) return;
    const Colour fast = colour_at(Colormap::speed, 1.0), slow = colour_at(Colormap::speed, 0.0);
    const Figure3d before = figure_of(flow({24, 10, 10.2}));
    const Pixels picture = drawn(render_3d, before);
    CHECK(picture.width == 900);
    CHECK(picture.height == 700);
    const int heap = like(picture, fast);
    CHECK(heap > 200);                      // 2 x 2 x 1 m of 19 m in view
    CHECK(like(picture, slow) > 5 * heap);  // 18 x 10 m
    const Colour pressed = colour_at(Colormap::pressure, 1.0);
    CHECK(like(picture, pressed) > 500);  // in the corner, where no point is in front
    for (const int x : {0, 899})
        for (const int y : {0, 699}) CHECK(figures::distance(picture.at(x, y), colours::white) == 0);
    // under the floor nothing is seen
    CHECK(like(drawn(render_3d, figure_of(flow({24, 10, 8.0}))), fast) == 0);
}

TEST_CASE("The section shows the points near its plane at their heights, and no others", "[space]") {
    if (cannot_draw()) return;
    const Colour fast = colour_at(Colormap::speed, 1.0);
    const Pixels near = drawn(render_section, figure_of(flow({24, 10, 12.0})));
    CHECK(like(near, fast) > 100);
    int lowest = near.height, floor = -1;
    for (int y = 0; y < near.height; ++y)
        for (int x = 0; x < near.width * 8 / 10; ++x) {
            if (figures::distance(near.at(x, y), fast) <= 2) lowest = std::min(lowest, y);
            if (figures::distance(near.at(x, y), colours::ground) <= 2) floor = std::max(floor, y);
        }
    CHECK(lowest > floor + 10);  // the heap hangs 1.9 m over the floor, of 20 m across 600 pixels
    // half a metre is as far as points may be from the plane; these are 2 m away
    CHECK(like(drawn(render_section, figure_of(flow({24, 13, 12.0}))), fast) == 0);
}

TEST_CASE("A point is as large as a cube of its volume, a particle as wide as its volume requires", "[space]") {
    LoadedParticles particles;
    particles.count = 4;
    particles.arrays["position"].assign(12, 0.0);
    particles.arrays["speed"].assign(4, 1.0);
    particles.arrays["volume"] = {0.125, 18.0, 0.125, 0.064};
    particles.arrays["depth"] = {0.0, 2.0, 0.0, 0.0};
    particles.arrays["model"] = {1.0, 0.0, 1.0, 1.0};
    const Moment3d moment = moment_3d(particles, {});
    const double sizes[] = {0.5, 3.0, 0.5, 0.4};
    REQUIRE(moment.material.size() == 4);
    for (std::size_t k = 0; k < 4; ++k) CHECK(moment.material[k].size == Approx(sizes[k]));
    CHECK(moment.typical_size == Approx(0.5));  // the points' median, whatever the particles are
}

TEST_CASE("Points and particles are drawn in the size that they have", "[space]") {
    if (cannot_draw()) return;
    const Colour fast = colour_at(Colormap::speed, 1.0);
    for (const bool particles : {false, true}) {
        INFO((particles ? "particles" : "points"));
        const Figure3d figure = two_pieces(particles);
        // Balls are 0.62 of the size in radius. Their rims are lit less, which may cost a pixel more at each side.
        const Width ball = width_of_first(drawn(render_3d, figure), fast, 8.0);
        CHECK(std::abs(ball.wide - 2.0 * 0.62 * 1.5) < 4.0 * ball.pixel);
        CHECK(ball.pixel < 0.04);
        // In the section a particle is as wide as it is, a point an octagon whose corners lie on the ball.
        const Width cut = width_of_first(drawn(render_section, figure), fast, 8.0);
        CHECK(std::abs(cut.wide - (particles ? 1.5 : 1.5 * std::cos(constants::kPi / 8))) < 2.0 * cut.pixel);
        CHECK(cut.pixel < 0.04);
    }
}

TEST_CASE("Half a million points are drawn in seconds", "[space]") {
    if (cannot_draw()) return;
    Moment3d many = flow({24, 10, 10.2}, false);
    for (int k = 0; k < 500000; ++k)
        many.material.push_back({{15.0 + 0.03 * (k % 500), 2.0 + 0.03 * (k / 500 % 500), 10.1 + 0.05 * (k / 250000)},
                                 0.04,
                                 0.01 * (k % 1000),
                                 10.0,
                                 false});
    const Figure3d figure = figure_of(many);
    const std::clock_t start = std::clock();
    drawn(render_3d, figure);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    std::cout << "half a million points: " << seconds << " s of CPU time\n";
    CHECK(seconds < 30.0);  // of all threads; 0.9 s measured: only what is far slower fails, on any machine
}

TEST_CASE("Views and sections without a renderer, or with nothing to show, say so and leave no file", "[space]") {
    const figures::Folder folder;
    const Figure3d figure = figure_of(flow({24, 10, 10.2}));
    std::string view_reason, section_reason;
    ::setenv("FRANA_NO_RENDER", "1", 1);
    CHECK_FALSE(render_3d(figure, folder / "view.png", view_reason));
    CHECK_FALSE(render_section(figure, folder / "section.png", section_reason));
    ::unsetenv("FRANA_NO_RENDER");
    CHECK(view_reason == "FRANA_NO_RENDER is set");
    CHECK(section_reason == "FRANA_NO_RENDER is set");
    CHECK(folder.files() == 0);
    if (cannot_draw()) return;
    Figure3d empty = figure;
    empty.moment.material.clear();
    CHECK_FALSE(render_section(empty, folder / "section.png", section_reason));
    CHECK(section_reason == "no point is near the section");
    CHECK(folder.files() == 0);
}
