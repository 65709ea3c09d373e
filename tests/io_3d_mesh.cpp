// Barriers given as meshes in pictures of 3D points: kept by the run, put together with the pressure on
// them, seen in the oblique view and in the section.
#include <vtkCellData.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <fstream>

#include "catch.h"
#include "frana_commands.h"
#include "fresh_folder.h"
#include "io_3d_pictures.h"
#include "io_figures_scene.h"
#include "read_polydata.h"
#include "vtk_io/barrier_mesh.h"
#include "vtk_io/figures/colours_3d.h"
#include "vtk_io/figures/figure_3d.h"
#include "vtk_io/figures/mesh_3d.h"
#include "vtk_io/reader.h"
#include "vtk_io/writers.h"

using namespace frana;
using figures::cannot_draw;
using figures::drawn;

namespace {

/// A level floor at 10 m, 40 x 20 m.
Raster floor_of_10() { return Raster::filled(GridGeometry{41, 21, 0.0, 0.0, 1.0}, 10.0); }

/// A wedge on y from 5 to 15 m, from 9 m under the floor up to 12 m at x = 33 m, with a slope that begins at `foot`.
TriangleMesh wedge(double foot) {
    return {{{foot, 5, 9}, {33, 5, 9}, {33, 5, 12}, {foot, 15, 9}, {33, 15, 9}, {33, 15, 12}},
            {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {0, 2, 5}, {0, 5, 3}}};
}

Vec3 corner_of(const TriangleMesh& mesh, std::size_t triangle, std::size_t k) {
    return mesh.points[static_cast<std::size_t>(mesh.triangles[triangle][k])];
}

/// The six sides of a box around it as the 3D model hands them out (solid3d/face_ledger.h), in squares of 0.5 m.
std::vector<PatchedFace> box() {
    const double low[3] = {24, 3, 7}, size[3] = {11, 14, 7};
    std::vector<PatchedFace> faces;
    for (std::size_t n = 0; n < 6; ++n) {
        const std::size_t right = (n / 2 + 1) % 3, up = (n / 2 + 2) % 3;
        PatchedFace& face = faces.emplace_back();
        face.face = static_cast<Index>(n);
        face.corner = {low[0], low[1], low[2]};
        face.right = face.up = {0.0, 0.0, 0.0};
        face.right[right] = face.up[up] = 1.0;
        face.size = 0.5;
        face.count = {static_cast<Index>(2 * size[right]), static_cast<Index>(2 * size[up])};
        face.impulse.assign(static_cast<std::size_t>(face.count[0] * face.count[1]), {0.0, 0.0, 0.0});
        face.area.assign(face.impulse.size(), face.size * face.size);
    }
    return faces;
}

/// A pressure for a second on the squares of a side whose middles are in a box.
void push(PatchedFace& face, double pressure, const Eigen::AlignedBox3d& where) {
    const std::size_t axis = static_cast<std::size_t>(face.face) / 2;
    for (Index b = 0; b < face.count[1]; ++b)
        for (Index a = 0; a < face.count[0]; ++a) {
            const double u = face.size * (static_cast<double>(a) + 0.5), v = face.size * (static_cast<double>(b) + 0.5);
            Vec3 middle = where.center();
            middle[static_cast<Index>((axis + 1) % 3)] = face.corner[(axis + 1) % 3] + u;
            middle[static_cast<Index>((axis + 2) % 3)] = face.corner[(axis + 2) % 3] + v;
            if (where.contains(middle))
                face.impulse[static_cast<std::size_t>(b * face.count[0] + a)][axis] = pressure * face.size * face.size;
        }
}

/// Written by the run's writers as they are at 1 s, and read back.
std::vector<BarrierSolid> read_solids(const std::vector<PatchedFace>& faces, const TriangleMesh& mesh) {
    const FreshFolder folder;
    Frame frame;
    frame.status.time = 1.0;
    frame.faces = faces;
    make_barrier_writer(folder.path())->observe(frame);
    write_barrier_meshes(folder.path(), {std::make_shared<TriangleMesh>(mesh)});
    return barrier_solids(read_barriers(folder.path(), 0), {}, floor_of_10(), read_barrier_meshes(folder.path()));
}

constexpr double kPressure = 4e4;  ///< [Pa]

/// The wedge with a slope of 3 to 4, which is turned upwards more than sideways, pushed from x = 31 m on.
std::vector<BarrierSolid> pushed_wedge() {
    std::vector<PatchedFace> faces = box();
    push(faces[5], kPressure, {Vec3(31, 5, 0), Vec3(33, 15, 20)});
    return read_solids(faces, wedge(29.0));
}

/// Points of 0.25 m in a sheet before the wedge.
Figure3d figure_with(const std::vector<BarrierSolid>& barriers) {
    Figure3d figure;
    figure.bed = floor_of_10();
    for (double x = 12.0; x < 29.0; x += 0.25)
        for (double y = 5.0; y < 15.0; y += 0.25)
            figure.moment.material.push_back({{x, y, 10.125}, 0.25, 0.0, 10.0, false});
    figure.moment.typical_size = 0.25;
    figure.moment.momentum = {1.0, 0.0, 0.0};
    figure.moment.middle = {24.0, 10.0, 10.2};
    figure.moment.barriers = barriers;
    Shared3d shared;
    shared.add(figure.moment);
    figure.view = shared.view();
    figure.title = "Mesh";
    figure.width = 900;
    figure.height = 700;
    return figure;
}

/// Pixels of just that colour in each row of the picture without its colour bars, the lowest row first.
std::vector<int> pixels_of(const Pixels& picture, const Colour& colour) {
    std::vector<int> rows(static_cast<std::size_t>(picture.height), 0);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width * 88 / 100; ++x)
            rows[static_cast<std::size_t>(y)] += figures::distance(picture.at(x, y), colour) <= 2;
    return rows;
}

int all(const std::vector<int>& rows) {
    int sum = 0;
    for (const int n : rows) sum += n;
    return sum;
}

/// A block that reaches into the ground, in coordinates of its own.
void write_block(const std::filesystem::path& file) {
    std::ofstream out(file);
    for (int c = 0; c < 8; ++c) out << "v " << (c & 1) << ' ' << 7 * (c >> 1 & 1) << ' ' << 3 * (c >> 2) << '\n';
    for (const char* side :
         {"1 3 2", "2 3 4", "5 6 7", "6 8 7", "1 2 5", "2 6 5", "3 7 4", "4 7 8", "1 5 3", "3 5 7", "2 4 6", "4 8 6"})
        out << "f " << side << '\n';
}

}  // namespace

// Where ground cuts a square its pressure times the square was more than the force.
TEST_CASE("Pressures of barriers times their areas are the forces", "[figures][vtk]") {
    const FreshFolder folder;
    std::vector<PatchedFace> faces = box();
    push(faces[0], kPressure, {Vec3(20, 0, 0), Vec3(40, 20, 20)});
    double force = 0.0;
    for (std::size_t k = 0; k < faces[0].area.size(); ++k) {
        faces[0].area[k] *= k % 2 == 0 ? 0.25 : 1.0;
        force += faces[0].impulse[k][0];
    }
    Frame frame;
    frame.status.time = 1.0;
    frame.faces = faces;
    make_barrier_writer(folder.path())->observe(frame);
    const auto data = test::polydata(folder.path() / "barriers" / "barriers_000000.vtp");
    vtkDataArray* const areas = data->GetCellData()->GetArray("area");
    REQUIRE(areas != nullptr);
    double sum = 0.0;
    for (vtkIdType k = 0; k < areas->GetNumberOfTuples(); ++k)
        sum += areas->GetTuple1(k) * data->GetCellData()->GetArray("pressure")->GetTuple1(k);
    REQUIRE(force > 0.0);
    CHECK(sum == Approx(force).epsilon(1e-6));  // single precision
}

TEST_CASE("A run keeps its meshes in map coordinates, turned outwards, by the number of their barrier", "[space]") {
    const FreshFolder folder;
    CHECK(read_barrier_meshes(folder.path()).empty());
    write_barrier_meshes(folder.path(), {nullptr, nullptr});
    CHECK_FALSE(std::filesystem::exists(folder.path() / "barrier_meshes.vtp"));
    std::ofstream(folder.path() / "inwards.obj")
        << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
    const Vec3 origin(500000.25, 4e6 + 0.125, 100.0);  // seven digits do not hold it
    const TriangleMesh mesh = barrier_triangles(folder.path() / "inwards.obj", origin);
    const auto other = std::make_shared<TriangleMesh>(wedge(30.0));
    write_barrier_meshes(folder.path(), {nullptr, other, std::make_shared<TriangleMesh>(mesh)});
    const BarrierMeshes read = read_barrier_meshes(folder.path());
    REQUIRE(read.size() == 3);
    CHECK(read[0] == nullptr);
    REQUIRE(read[1]->points.size() == 6);
    REQUIRE(read[1]->triangles.size() == 8);
    for (std::size_t n = 0; n < 8; ++n)
        for (std::size_t k = 0; k < 3; ++k) CHECK(corner_of(*read[1], n, k) == corner_of(*other, n, k));
    REQUIRE(read[2]->points.size() == 4);
    REQUIRE(read[2]->triangles.size() == 4);
    double volume = 0.0;
    for (std::size_t n = 0; n < 4; ++n) {
        const Vec3 a = corner_of(*read[2], n, 0) - origin, b = corner_of(*read[2], n, 1) - origin,
                   c = corner_of(*read[2], n, 2) - origin;
        volume += a.dot(b.cross(c)) / 6.0;
    }
    CHECK(volume == Approx(1.0 / 6.0).epsilon(1e-9));
}

TEST_CASE("A mesh is drawn down to the ground with the pressure of the side that it is turned to", "[space]") {
    const auto solids = pushed_wedge();
    REQUIRE(solids.size() == 1);
    double slope = 0.0;
    for (const auto& piece : solids[0].pieces) {
        for (const Vec3& p : piece.corners) CHECK(p.z() >= 10.0 - 0.25 - 1e-9);  // half a patch
        Vec3 area(0, 0, 0), middle(0, 0, 0);
        for (std::size_t k = 2; k < piece.corners.size(); ++k)
            area += 0.5 * (piece.corners[k - 1] - piece.corners[0]).cross(piece.corners[k] - piece.corners[0]);
        for (const Vec3& p : piece.corners) middle += p / static_cast<double>(piece.corners.size());
        CHECK(area.normalized().dot(piece.normal) == Approx(1.0));
        if (piece.normal.z() < 0.5) {
            CHECK(piece.pressure == 0.0);  // back and ends
            continue;
        }
        CHECK(piece.normal.isApprox(Vec3(-0.6, 0, 0.8)));
        slope += area.norm();
        if (middle.x() > 31.5 && middle.x() < 33.0 && middle.y() > 5.5 && middle.y() < 14.5)
            CHECK(piece.pressure == Approx(kPressure).epsilon(1e-6));
        if (middle.x() < 30.5) CHECK(piece.pressure == 0.0);
    }
    CHECK(slope == Approx(10.0 * 2.25 / 0.6));  // of 2.25 m height, 3 in 5
    // A pressure pushes along the normal: 10 m x 2 m seen from above, and 1.5 m of height.
    CHECK(solids[0].load.x() == Approx(kPressure * 15.0).epsilon(1e-6));
    CHECK(solids[0].load.z() == Approx(-kPressure * 20.0).epsilon(1e-6));
    CHECK(solids[0].middle_of_load.x() == Approx(32.0).epsilon(1e-6));
    CHECK(solids[0].middle_of_load.z() == Approx(11.25).epsilon(1e-6));
    for (const auto& edge : solids[0].edges)
        for (const Vec3& p : edge) CHECK(p.z() >= 10.0 - 1e-9);
}

TEST_CASE("A slope between two sides has the pressure of both, however it was recorded", "[space]") {
    std::vector<PatchedFace> faces = box();
    push(faces[0], 0.25 * kPressure, {Vec3(0, 5, 10.5), Vec3(40, 15, 12)});
    push(faces[5], 0.75 * kPressure, {Vec3(31.5, 5, 0), Vec3(33, 15, 20)});
    const auto solids = read_solids(faces, wedge(30.0));
    REQUIRE(solids.size() == 1);
    CHECK(solids[0].load.x() == Approx(kPressure * 15.0).epsilon(1e-6));
    CHECK(solids[0].load.z() == Approx(-kPressure * 15.0).epsilon(1e-6));
    double most = 0.0;
    for (const auto& piece : solids[0].pieces) most = std::max(most, piece.pressure);
    CHECK(most == Approx(kPressure).epsilon(1e-6));
}

TEST_CASE("Without its mesh a barrier of any shape has no solid, and one in the ground is not seen", "[space]") {
    const FreshFolder folder;
    Frame frame;
    frame.faces = box();
    make_barrier_writer(folder.path())->observe(frame);
    CHECK(barrier_solids(read_barriers(folder.path(), 0), {}, floor_of_10()).empty());
    TriangleMesh buried = wedge(30.0);
    for (Vec3& p : buried.points) p.z() -= 2.5;
    CHECK(read_solids(box(), buried).empty());
}

TEST_CASE("The cut of a mesh is its profile, holes left out", "[space]") {
    BarrierSolid barrier;
    barrier.mesh = std::make_shared<TriangleMesh>(wedge(30.0));
    const MeshCut cut = cut_of(barrier, {20.0, 10.0}, {1.0, 0.0});
    REQUIRE(cut.outlines.size() == 1);
    CHECK((cut.outlines[0].front() - cut.outlines[0].back()).norm() < 1e-12);
    double area = 0.0, nearest = 1e300, highest = -1e300;
    for (const auto& part : cut.areas) {
        REQUIRE(part.size() == 3);
        const Vec2 a = part[1] - part[0], b = part[2] - part[0];
        area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
        for (const Vec2& p : part) nearest = std::min(nearest, p.x()), highest = std::max(highest, p.y());
    }
    CHECK(area == Approx(4.5));
    CHECK(nearest == Approx(10.0));
    CHECK(highest == Approx(12.0));
    CHECK(cut_of(barrier, {20.0, 17.0}, {1.0, 0.0}).areas.empty());
    // within another one that is turned inwards: a hollow
    TriangleMesh hollow = wedge(30.0);
    const Vec3 centre(32, 10, 10);
    for (Index n = 0; n < 6; ++n)
        hollow.points.emplace_back(centre + 0.5 * (hollow.points[static_cast<std::size_t>(n)] - centre));
    for (const auto& t : wedge(30.0).triangles) hollow.triangles.push_back({t[0] + 6, t[2] + 6, t[1] + 6});
    barrier.mesh = std::make_shared<TriangleMesh>(hollow);
    area = 0.0;
    for (const auto& part : cut_of(barrier, {20.0, 10.0}, {1.0, 0.0}).areas) {
        const Vec2 a = part[1] - part[0], b = part[2] - part[0];
        area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
    }
    CHECK(area == Approx(4.5 * 0.75));
}

TEST_CASE("The oblique view and the section show a mesh and the pressure on it", "[space]") {
    if (cannot_draw()) return;
    const Colour pressed = colour_at(Colormap::pressure, 1.0);
    Figure3d with = figure_with(pushed_wedge()), without = with;
    without.moment.barriers.clear();
    without.look = with.look = best_view(with);
    without.room = with.room = {{33, 5, 12}, {33, 15, 12}};
    REQUIRE(with.view.pressure == Approx(kPressure));
    const Pixels section = drawn(render_section, with);
    CHECK(all(pixels_of(section, pressed)) > 50);
    const std::vector<int> rows = pixels_of(section, colours::unloaded);
    CHECK(all(rows) > 500);
    const int widest = *std::max_element(rows.begin(), rows.end());
    const auto narrow = [&](int n) { return n > 0 && n < widest / 3; };
    CHECK(std::count_if(rows.begin(), rows.end(), narrow) > 5);  // a triangle, not a box
    CHECK(all(pixels_of(drawn(render_section, without), colours::unloaded)) == 0);
    // right of the inset
    const Pixels view = drawn(render_3d, with), bare = drawn(render_3d, without);
    int changed = 0;
    for (int y = 0; y < view.height; ++y)
        for (int x = view.width * 4 / 10; x < view.width * 8 / 10; ++x)
            changed += figures::distance(view.at(x, y), bare.at(x, y)) > 10;
    CHECK(changed > 2000);
}

TEST_CASE("Figures of a finished run show its points and its mesh when both, and the mesh's file, have gone",
          "[space]") {
    if (cannot_draw()) return;
    const FreshFolder folder;
    const std::string data = std::string(FRANA_SOURCE_DIR) + "/cases/wall/data/";
    write_block(folder.path() / "block.obj");
    std::ofstream(folder.path() / "case.toml")
        << "[case]\ntitle = \"A block\"\n[terrain]\ndem = \"" << data << "dem.tif\"\n[[release]]\noutline = \"" << data
        << "release.geojson\"\nsurface = 9.5\n[material]\ndensity = 1000.0\n[material.bed]\nlaw = \"none\"\n"
           "[boundary]\nsides = \"wall\"\n[[stage]]\nmodel = \"depth_averaged\"\nuntil = 2.0\n[[stage]]\nmodel = "
           "\"mpm3d\"\n"
           "cell = 0.5\nuntil = 2.6\n[[stage]]\nmodel = \"depth_averaged\"\n"
           "[[barrier]]\nmesh = \"block.obj\"\norigin = [20, -1, 5.67]\n[time]\nend = 2.8\n"
           "[output]\nevery = 0.1\nformats = [\"vtk\"]\n";
    RunOptions run;
    run.case_file = folder.path() / "case.toml";
    run.out = folder.path() / "run";
    run.quiet = true;
    REQUIRE(run_command(run) == 0);
    const BarrierMeshes meshes = read_barrier_meshes(run.out);
    REQUIRE(meshes.size() == 1);
    CHECK(meshes[0]->points.front().isApprox(Vec3(20, -1, 5.67)));
    const LoadedParticles last = read_particles(run.out, -1);
    const std::vector<double>& model = last.arrays.at("model");
    CHECK(std::count(model.begin(), model.end(), 0.0) == last.count);  // particles again
    std::filesystem::remove(folder.path() / "block.obj");
    FiguresOptions again;
    again.run_dir = run.out;
    REQUIRE(figures_command(again) == 0);
    CHECK(std::filesystem::exists(run.out / "figures" / "view_impact.png"));
    CHECK(std::filesystem::exists(run.out / "figures" / "view_points.png"));
    const Pixels section = read_png(run.out / "figures" / "section_impact.png");
    CHECK(all(pixels_of(section, colours::unloaded)) > 500);  // a metre of some 20 m across, 2 m high
}
