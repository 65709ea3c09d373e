// Meshes as barriers: distances of those that are closed, a sentence about those that are not.
#include <omp.h>
#include <vtkImplicitPolyDataDistance.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <Eigen/Geometry>

#include <cmath>
#include <ctime>
#include <fstream>

#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "vtk_io/barrier_mesh.h"

using namespace frana;

namespace {

using Corners = std::vector<Vec3>;
using Sides = std::vector<std::array<int, 3>>;

/// An ASCII STL file, which repeats the corners of each triangle.
std::filesystem::path write_stl(const std::filesystem::path& file, const Corners& corners, const Sides& sides) {
    std::ofstream out(file);
    out << "solid made\n";
    for (const auto& side : sides) {
        out << "facet normal 0 0 0\nouter loop\n";
        for (const int c : side) {
            const Vec3& x = corners[static_cast<std::size_t>(c)];
            out << "vertex " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
        }
        out << "endloop\nendfacet\n";
    }
    out << "endsolid made\n";
    return file;
}

std::filesystem::path write_obj(const std::filesystem::path& file, const Corners& corners, const Sides& sides) {
    std::ofstream out(file);
    for (const Vec3& x : corners) out << "v " << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
    for (const auto& side : sides) out << "f " << side[0] + 1 << ' ' << side[1] + 1 << ' ' << side[2] + 1 << '\n';
    return file;
}

/// By hand, so that the reader meets a file that VTK did not write.
std::filesystem::path write_vtp(const std::filesystem::path& file, const Corners& corners, const Sides& sides) {
    std::ofstream out(file);
    out << "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\"><PolyData><Piece "
           "NumberOfPoints=\""
        << corners.size() << "\" NumberOfPolys=\"" << sides.size()
        << "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">";
    for (const Vec3& x : corners) out << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
    out << "</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">";
    for (const auto& side : sides) out << side[0] << ' ' << side[1] << ' ' << side[2] << '\n';
    out << "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">";
    for (std::size_t n = 1; n <= sides.size(); ++n) out << 3 * n << ' ';
    out << "</DataArray></Polys></Piece></PolyData></VTKFile>\n";
    return file;
}

Corners box_corners(const Vec3& low, const Vec3& high) {
    Corners corners;
    for (int c = 0; c < 8; ++c)
        corners.push_back({c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(), c & 4 ? high.z() : low.z()});
    return corners;
}
const Sides kBox = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

const Vec3 kLow(1, 2, -1), kHigh(3, 2.5, 1.25);

double box_distance(const Vec3& x) {
    const Vec3 q = (x - 0.5 * (kLow + kHigh)).cwiseAbs() - 0.5 * (kHigh - kLow);
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

void check_box(const DistanceField& field) {
    double worst = 0.0;
    for (Index k = 0; k < field.nodes[2]; ++k)
        for (Index j = 0; j < field.nodes[1]; ++j)
            for (Index i = 0; i < field.nodes[0]; ++i)
                worst = std::max(worst, std::abs(field.at(i, j, k) - box_distance(field.place(i, j, k))));
    CHECK(worst < 1e-6);  // VTK's STL reader keeps points as float: 1e-7 of 3 m
}

}  // namespace

TEST_CASE("A closed box in any of the formats gives its exact distances, whichever way its triangles run", "[mesh]") {
    const FreshFolder fresh;
    const std::filesystem::path& folder = fresh.path();
    const Corners corners = box_corners(kLow, kHigh);
    Sides inwards = kBox;
    for (auto& side : inwards) std::swap(side[0], side[1]);
    const MeshSampling sampling{0.125, 0.5, Vec3(0, 0, 0)};
    check_box(read_barrier_mesh(write_stl(folder / "box.stl", corners, kBox), sampling));
    check_box(read_barrier_mesh(write_obj(folder / "box.OBJ", corners, kBox), sampling));
    check_box(read_barrier_mesh(write_vtp(folder / "box.vtp", corners, kBox), sampling));
    check_box(read_barrier_mesh(write_stl(folder / "inwards.stl", corners, inwards), sampling));
    const Vec3 origin(500000, 4e6, 100);
    const MeshField moved = barrier_mesh_of(folder / "box.stl", {0.125, 0.5, origin});
    CHECK((moved.low - origin - kLow).norm() < 0.25);  // the box is that of the field, rounded up to its nodes
    CHECK((moved.high - origin - kHigh).norm() < 0.25);
    CHECK(moved.field->contact(origin + Vec3(2, 2.25, 1)).distance == Approx(-0.25).margin(1e-6));
    const DistanceField field = read_barrier_mesh(folder / "box.stl", sampling);
    for (int k = 0; k < 3; ++k) {
        CHECK(field.origin[k] <= kLow[k] - 0.5 + 1e-12);
        CHECK(field.end()[k] >= kHigh[k] + 0.5 - 1e-12);
    }
}

TEST_CASE("Around a sharp spike the field tells inside from outside", "[mesh]") {
    // Angles of 9 degrees at the tip: where the nearest place is an edge or the tip, single normals mislead.
    const Corners corners = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, {0.1, 0.1, 2}};
    const Sides sides = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const FreshFolder folder;
    const DistanceField field = read_barrier_mesh(write_obj(folder.path() / "spike.obj", corners, sides), {0.05, 0.4});
    const auto inside = [&](const Vec3& x) {
        double least = 1e9;
        for (const auto& s : sides) {
            const Vec3 a = corners[static_cast<std::size_t>(s[0])], b = corners[static_cast<std::size_t>(s[1])],
                       c = corners[static_cast<std::size_t>(s[2])];
            least = std::min(least, -(b - a).cross(c - a).normalized().dot(x - a));
        }
        return least;
    };
    Index wrong = 0;
    for (Index k = 0; k < field.nodes[2]; ++k)
        for (Index j = 0; j < field.nodes[1]; ++j)
            for (Index i = 0; i < field.nodes[0]; ++i) {
                const double depth = inside(field.place(i, j, k));
                if (std::abs(depth) > 1e-6) wrong += (depth > 0.0) != (field.at(i, j, k) < 0.0) ? 1 : 0;
            }
    CHECK(wrong == 0);
}

TEST_CASE("Distances of a mesh have the same bits on any number of threads and cost less than a microsecond",
          "[mesh]") {
    const FreshFolder folder;
    const auto file = write_obj(folder.path() / "box.obj", box_corners(kLow, kHigh), kBox);
    const MeshSampling sampling{0.025, 0.5};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const std::clock_t start = std::clock();
    const DistanceField one = read_barrier_mesh(file, sampling);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;  // of the processor
    omp_set_num_threads(3);
    const DistanceField three = read_barrier_mesh(file, sampling);
    omp_set_num_threads(threads);
    CHECK((one.distance == three.distance));
    REQUIRE(one.distance.size() > 900000);
    // VTK's own distance function takes 2.7 microseconds, on one thread only.
    CHECK(seconds < 1e-6 * static_cast<double>(one.distance.size()));
}

TEST_CASE("Distances from a rough mesh are those to the nearest of all its triangles", "[mesh]") {
    // A ball of 20 x 40 bumpy patches: thousands of triangles, edges that point in and edges that point out.
    constexpr int rings = 20, slices = 40;
    Corners corners = {{0, 0, -1}, {0, 0, 1}};
    for (int r = 1; r < rings; ++r)
        for (int s = 0; s < slices; ++s) {
            const double up = std::acos(-1.0) * r / rings, round = 2.0 * std::acos(-1.0) * s / slices;
            const double radius = 1.0 + ((r + s) % 2 == 0 ? 0.1 : -0.1);
            const Vec3 out(std::sin(up) * std::cos(round), std::sin(up) * std::sin(round), -std::cos(up));
            corners.push_back(radius * out);
        }
    const auto at = [](int r, int s) { return 2 + (r - 1) * slices + s % slices; };
    Sides sides;
    for (int s = 0; s < slices; ++s) {
        sides.push_back({0, at(1, s + 1), at(1, s)});
        sides.push_back({1, at(rings - 1, s), at(rings - 1, s + 1)});
        for (int r = 1; r + 1 < rings; ++r) {
            sides.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
            sides.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
        }
    }
    const FreshFolder folder;
    const DistanceField field = read_barrier_mesh(write_vtp(folder.path() / "ball.vtp", corners, sides), {0.11, 0.5});
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((folder.path() / "ball.vtp").c_str());
    reader->Update();
    vtkNew<vtkImplicitPolyDataDistance> reference;
    reference->SetInput(reader->GetOutput());
    double worst = 0.0;
    for (Index k = 0; k < field.nodes[2]; ++k)
        for (Index j = 0; j < field.nodes[1]; ++j)
            for (Index i = 0; i < field.nodes[0]; ++i) {
                Vec3 x = field.place(i, j, k);
                worst = std::max(worst, std::abs(field.at(i, j, k) - reference->EvaluateFunction(x.data())));
            }
    CHECK(worst < 1e-12);  // round-off of places of 1 m
}

TEST_CASE("A mesh that is no solid is refused with what was found and what to do", "[mesh]") {
    const FreshFolder fresh;
    const std::filesystem::path& folder = fresh.path();
    const Corners corners = box_corners(kLow, kHigh);
    const MeshSampling sampling{0.25, 0.5, Vec3(0, 0, 0)};
    const auto refused = [&](const std::filesystem::path& file, const std::string& what) {
        CAPTURE(file.string());
        CHECK_THROWS_AS(read_barrier_mesh(file, sampling), UserError);
        CHECK_THROWS_WITH(read_barrier_mesh(file, sampling), Catch::Contains(what));
    };
    Sides open(kBox.begin() + 1, kBox.end());
    refused(write_stl(folder / "open.stl", corners, open), "3 edges of the mesh do not have exactly two triangles");
    Sides turned = kBox;
    std::swap(turned[4][0], turned[4][1]);
    refused(write_stl(folder / "turned.stl", corners, turned), "opposite sides outwards");
    // Two boxes, one through the other.
    Corners two = corners;
    for (const Vec3& x : box_corners({1.5, 1.5, -0.5}, {2.5, 3.0, 0.5})) two.push_back(x);
    Sides both = kBox;
    for (auto side : kBox) both.push_back({side[0] + 8, side[1] + 8, side[2] + 8});
    refused(write_obj(folder / "through.obj", two, both), "cuts through itself");
    refused(folder / "missing.stl", "not found");
    std::ofstream(folder / "mesh.ply") << "ply\n";
    refused(folder / "mesh.ply", "'.ply' is not known");
    std::ofstream(folder / "empty.obj") << "# nothing\n";
    refused(folder / "empty.obj", "no triangles");
    std::ofstream(folder / "words.vtp") << "not a mesh at all\n";
    refused(folder / "words.vtp", "cannot be read as a mesh");
    refused(write_stl(folder / "thin.stl", box_corners({1, 2, -1}, {3, 2.05, 1.25}), kBox), "thinner than the 0.25 m");
    std::ofstream(folder / "beyond.obj") << "v 1 2 3\nf 1 2 9999999\n";
    refused(folder / "beyond.obj", "a face names point 9999998, counted from 0, of 1 points");
    Sides beyond = kBox;
    beyond[3][1] = 99999999;
    refused(write_vtp(folder / "beyond.vtp", corners, beyond), "a face names point 99999999, counted from 0, of 8");
    std::ofstream(folder / "word.obj") << "v 1 2 3\nv 1 2 O\nf 1 2 2\n";
    refused(folder / "word.obj", "word.obj:2: found \"O\" in a point; expected three numbers");
    std::ofstream(folder / "nowhere.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n";
    refused(folder / "nowhere.obj", "point 2, counted from 0, is at no place (0, 1, nan)");
    Corners large = corners;
    for (Vec3& x : large) x *= 1000.0;
    refused(write_obj(folder / "millimetres.obj", large, kBox), "is it in metres?");
}

TEST_CASE("A sheet with two sides and nothing between them is refused, alone and next to a solid", "[mesh]") {
    const Corners sheet = {{1, 2, 1}, {3, 2, 1}, {3, 4, 2}, {1, 4, 2}};
    const Sides two_sides = {{0, 1, 2}, {0, 2, 3}, {3, 1, 0}, {3, 2, 1}};
    Corners both = sheet;
    for (const Vec3& x : box_corners({10, 0, 0}, {12, 2, 2})) both.push_back(x);
    Sides sides = two_sides;
    for (auto side : kBox) sides.push_back({side[0] + 4, side[1] + 4, side[2] + 4});
    const FreshFolder folder;
    for (const auto& file :
         {write_obj(folder.path() / "sheet.obj", sheet, two_sides), write_obj(folder.path() / "both.obj", both, sides)})
        CHECK_THROWS_WITH(read_barrier_mesh(file, {0.25, 0.5}),
                          Catch::Contains("has two sides and nothing between them; expected a solid"));
}

TEST_CASE("A face of an OBJ may name textures and normals, count from the end, and go on in another line", "[mesh]") {
    const FreshFolder folder;
    std::ofstream out(folder.path() / "box.obj");
    out << "# a box\r\no wall\nvt 0 0\nvn 0 0 1\n";
    out.precision(17);
    const Vec3 far(500000.1, 4000000.3, 0.0);  // single precision would move these points by centimetres
    for (const Vec3& x : box_corners(kLow + far, kHigh + far))
        out << "v " << x.x() << ' ' << x.y() << " \\\n " << x.z() << "\r\n";
    for (const auto& side : kBox)
        out << "f " << side[0] + 1 << "/1/1 " << side[1] - 8 << "//7 " << side[2] + 1 << "/9\n";
    out.close();
    check_box(read_barrier_mesh(folder.path() / "box.obj", {0.125, 0.5, -far}));
}

TEST_CASE("A mesh that takes a second is told of beforehand, a smaller one is not", "[mesh]") {
    const FreshFolder folder;
    const auto file = write_obj(folder.path() / "box.obj", box_corners(kLow, kHigh), kBox);
    std::vector<std::string> lines;
    const MeshReader read = barrier_meshes_told([&](const std::string& line) { lines.push_back(line); });
    CHECK(read(file, {0.125, 0.5}).field->distance == read_barrier_mesh(file, {0.125, 0.5}).distance);
    CHECK(lines.empty());
    read(file, {0.0125, 0.5});
    REQUIRE(lines.size() == 1);
    // 2 m by .5 m by 2.25 m with .5 m around: 241 x 121 x 261
    CHECK_THAT(lines[0], Catch::EndsWith("box.obj: measuring its distance from 7.61 million places, 0.0125 m apart"));
}

TEST_CASE("Parts that stand apart are one barrier", "[mesh]") {
    Corners two = box_corners({0, 0, 0}, {1, 1, 1});
    for (const Vec3& x : box_corners({2, 0, 0}, {3, 1, 1})) two.push_back(x);
    Sides both = kBox;
    for (auto side : kBox) both.push_back({side[0] + 8, side[1] + 8, side[2] + 8});
    const FreshFolder folder;
    const DistanceField field = read_barrier_mesh(write_vtp(folder.path() / "two.vtp", two, both), {0.125, 0.5});
    CHECK(field.inside({0.5, 0.5, 0.5}));
    CHECK(field.inside({2.5, 0.5, 0.5}));
    CHECK(!field.inside({1.5, 0.5, 0.5}));
}
