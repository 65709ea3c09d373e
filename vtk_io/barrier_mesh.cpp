#include "vtk_io/barrier_mesh.h"

#include <fmt/core.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCleanPolyData.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkIdList.h>
#include <vtkIntersectionPolyDataFilter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkStaticCellLocator.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "terrain/mesh_distance.h"
#include "vtk_io/obj_file.h"
#include "vtk_io/xml_reading.h"

namespace frana {
namespace {

using Path = std::filesystem::path;
using Triangle = std::array<vtkIdType, 3>;

UserError unreadable(const Path& file) {
    return UserError(
        fmt::format("{}: cannot be read as a mesh; expected triangles in a {} file: write it "
                    "again from the program that made it",
                    file.string(), file.extension().string()));
}

vtkSmartPointer<vtkPolyData> read_stl(const Path& file) {
    bool complained = false;
    vtkNew<vtkCallbackCommand> listener;
    listener->SetClientData(&complained);
    listener->SetCallback([](vtkObject*, unsigned long, void* flag, void*) { *static_cast<bool*>(flag) = true; });
    vtkNew<vtkSTLReader> reader;
    for (const char* event : {"ErrorEvent", "WarningEvent"}) {
        reader->AddObserver(event, listener);
        reader->GetExecutive()->AddObserver(event, listener);
    }
    reader->SetFileName(file.string().c_str());
    reader->Update();
    if (complained || reader->GetErrorCode() != vtkErrorCode::NoError) throw unreadable(file);
    return reader->GetOutput();
}

vtkSmartPointer<vtkPolyData> read_vtp(const Path& file) {
    vtkNew<vtkXMLPolyDataReader> reader;
    if (!read_xml(reader, file)) throw unreadable(file);
    return reader->GetOutput();
}

vtkSmartPointer<vtkPolyData> read_any(const Path& file) {
    if (!std::filesystem::exists(file))
        throw UserError(fmt::format("{}: not found; expected a mesh (.stl, .vtp or .obj)", file.string()));
    std::string kind = file.extension().string();
    std::transform(kind.begin(), kind.end(), kind.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (kind == ".stl") return read_stl(file);
    if (kind == ".obj") return read_obj(file);
    if (kind == ".vtp") return read_vtp(file);
    throw UserError(fmt::format("{}: a mesh of the kind '{}' is not known; expected .stl, .vtp or .obj: convert it",
                                file.string(), kind));
}

/// Throws UserError with what VTK's filters would die of, or take for something else.
void require_valid(const Path& file, vtkPolyData* mesh) {
    std::string fault = fault_of(mesh);
    for (vtkIdType n = 0; n < mesh->GetNumberOfPoints(); ++n) {
        const Vec3 x = Vec3(mesh->GetPoint(n));
        if (!x.allFinite() && fault.empty())
            fault = fmt::format("point {}, counted from 0, is at no place ({}, {}, {})", n, x.x(), x.y(), x.z());
    }
    if (!fault.empty())
        throw UserError(
            fmt::format("{}: {}; expected a closed surface of triangles: write the mesh again from the "
                        "program that made it",
                        file.string(), fault));
}

/// Triangles only, with one point at each place: files may repeat it for every triangle.
vtkSmartPointer<vtkPolyData> read_triangles(const Path& file) {
    const vtkSmartPointer<vtkPolyData> raw = read_any(file);
    require_valid(file, raw);
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(raw);
    triangles->PassVertsOff(), triangles->PassLinesOff();
    vtkNew<vtkCleanPolyData> clean;
    clean->SetInputConnection(triangles->GetOutputPort());
    clean->ToleranceIsAbsoluteOn();
    clean->SetAbsoluteTolerance(0.0);
    clean->Update();
    vtkSmartPointer<vtkPolyData> mesh = clean->GetOutput();
    mesh->GetPointData()->Initialize();
    if (mesh->GetNumberOfPolys() == 0)
        throw UserError(fmt::format("{}: the mesh has no triangles; expected a closed surface", file.string()));
    return mesh;
}

std::vector<Triangle> triangles_of(vtkPolyData* mesh) {
    std::vector<Triangle> list;
    vtkNew<vtkIdList> corners;
    vtkCellArray* const cells = mesh->GetPolys();
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
        cells->GetCellAtId(c, corners);
        list.push_back({corners->GetId(0), corners->GetId(1), corners->GetId(2)});
    }
    return list;
}

Vec3 point_of(vtkPolyData* mesh, vtkIdType n) { return Vec3(mesh->GetPoint(n)); }

std::string place_of(const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z()); }

/// Every edge has two triangles, which run along it in opposite directions.
void require_closed(const Path& file, vtkPolyData* mesh, const std::vector<Triangle>& triangles) {
    std::map<std::pair<vtkIdType, vtkIdType>, int> ways;
    for (const Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) ++ways[{t[k], t[(k + 1) % 3]}];
    Index open = 0, turned = 0;
    Vec3 first_open, first_turned;
    for (const auto& [way, count] : ways) {
        const auto back = ways.find({way.second, way.first});
        const int returns = back == ways.end() ? 0 : back->second;
        const Vec3 middle = 0.5 * (point_of(mesh, way.first) + point_of(mesh, way.second));
        if (count + returns != 2) {
            if (open++ == 0) first_open = middle;
        } else if (count != 1) {
            if (turned++ == 0) first_turned = middle;
        }
    }
    if (open > 0)
        throw UserError(
            fmt::format("{}: {} edges of the mesh do not have exactly two triangles, the first at {}; "
                        "expected a closed surface: fill its holes and remove inner walls",
                        file.string(), open, place_of(first_open)));
    if (turned > 0)
        throw UserError(
            fmt::format("{}: at {} edges of the mesh, the first at {}, neighbouring triangles turn "
                        "opposite sides outwards; expected all triangles to run one way round: make "
                        "its normals consistent",
                        file.string(), turned, place_of(first_turned)));
}

bool share_point(const Triangle& a, const Triangle& b) {
    for (const vtkIdType p : a)
        for (const vtkIdType q : b)
            if (p == q) return true;
    return false;
}

/// No two triangles without a common point meet. Neighbours that fold onto each other are not noticed.
void require_simple(const Path& file, vtkPolyData* mesh, const std::vector<Triangle>& triangles) {
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(mesh);
    locator->BuildLocator();
    vtkNew<vtkIdList> near;
    for (std::size_t a = 0; a < triangles.size(); ++a) {
        double bounds[6], corner[6][3];
        mesh->GetCellBounds(static_cast<vtkIdType>(a), bounds);
        locator->FindCellsWithinBounds(bounds, near);
        for (std::size_t k = 0; k < 3; ++k) mesh->GetPoint(triangles[a][k], corner[k]);
        for (vtkIdType n = 0; n < near->GetNumberOfIds(); ++n) {
            const auto b = static_cast<std::size_t>(near->GetId(n));
            if (b <= a || share_point(triangles[a], triangles[b])) continue;
            for (std::size_t k = 0; k < 3; ++k) mesh->GetPoint(triangles[b][k], corner[3 + k]);
            int coplanar = 0;
            double one[3], two[3], surface[2];
            if (vtkIntersectionPolyDataFilter::TriangleTriangleIntersection(corner[0], corner[1], corner[2], corner[3],
                                                                            corner[4], corner[5], coplanar, one, two,
                                                                            surface, 1e-9) != 0 &&
                coplanar == 0)
                throw UserError(
                    fmt::format("{}: the mesh cuts through itself at {}; expected a surface that does "
                                "not: unite its parts into one solid",
                                file.string(), place_of(Vec3(one))));
        }
    }
}

/// Every part that hangs together encloses more than round-off: a sheet with two sides is no solid.
void require_volume(const Path& file, vtkPolyData* mesh, const std::vector<Triangle>& triangles) {
    struct Part {
        double volume6 = 0.0, area2 = 0.0;
        Eigen::AlignedBox3d box;
    };
    std::vector<vtkIdType> of(static_cast<std::size_t>(mesh->GetNumberOfPoints()));  // a point of the same part
    std::iota(of.begin(), of.end(), vtkIdType{0});
    const auto root = [&](vtkIdType n) {
        while (of[static_cast<std::size_t>(n)] != n)
            n = of[static_cast<std::size_t>(n)] = of[static_cast<std::size_t>(of[static_cast<std::size_t>(n)])];
        return n;
    };
    for (const Triangle& t : triangles)
        for (const vtkIdType n : t) of[static_cast<std::size_t>(root(n))] = root(t[0]);
    std::map<vtkIdType, Part> parts;
    for (const Triangle& t : triangles) {
        const vtkIdType part_of = root(t[0]);
        Part& part = parts[part_of];
        const Vec3 from = point_of(mesh, part_of), a = point_of(mesh, t[0]) - from, b = point_of(mesh, t[1]) - from,
                   c = point_of(mesh, t[2]) - from;
        part.volume6 += a.dot(b.cross(c));
        part.area2 += (b - a).cross(c - a).norm();
        for (const Vec3& x : {a, b, c}) part.box.extend(x);
    }
    constexpr double kRoundOff = 1e-9;  // of the size: doubles have 16 digits, a sum of many triangles some fewer
    for (const auto& [start, part] : parts) {
        const double thickness = part.area2 > 0.0 ? 2.0 / 3.0 * std::abs(part.volume6) / part.area2 : 0.0;
        if (!(thickness > kRoundOff * part.box.diagonal().norm()))
            throw UserError(
                fmt::format("{}: the part of the mesh at {} has two sides and nothing between them; "
                            "expected a solid: give it a thickness, or give the wall as a line with a "
                            "height",
                            file.string(), place_of(point_of(mesh, start))));
    }
}

/// Six times the volume inside: below zero where the triangles turn inwards.
double volume6(vtkPolyData* mesh, const std::vector<Triangle>& triangles) {
    const Vec3 from = point_of(mesh, 0);
    double sum = 0.0;
    for (const Triangle& t : triangles)
        sum += (point_of(mesh, t[0]) - from).dot((point_of(mesh, t[1]) - from).cross(point_of(mesh, t[2]) - from));
    return sum;
}

TriangleMesh turned_outwards(vtkPolyData* read, const std::vector<Triangle>& triangles) {
    const bool inwards = volume6(read, triangles) < 0.0;
    TriangleMesh mesh;
    for (vtkIdType n = 0; n < read->GetNumberOfPoints(); ++n) mesh.points.emplace_back(point_of(read, n));
    for (const Triangle& t : triangles) mesh.triangles.push_back({t[0], inwards ? t[2] : t[1], inwards ? t[1] : t[2]});
    return mesh;
}

/// An empty field around the mesh.
DistanceField field_around(const Path& file, vtkPolyData* mesh, const MeshSampling& sampling) {
    double bounds[6];
    mesh->GetBounds(bounds);
    DistanceField field;
    field.spacing = sampling.spacing;
    double count = 1.0;
    for (int k = 0; k < 3; ++k) {
        const double* const ends = bounds + 2 * static_cast<std::ptrdiff_t>(k);
        const double low = ends[0] - sampling.margin, size = ends[1] + sampling.margin - low;
        const double nodes = std::ceil(size / sampling.spacing) + 1.0;
        // The box's middle is the field's, so that both ends have the margin.
        field.origin[k] = low - 0.5 * ((nodes - 1.0) * sampling.spacing - size);
        field.nodes[static_cast<std::size_t>(k)] =
            std::isfinite(nodes) && nodes < 1e9 ? std::max<Index>(2, static_cast<Index>(nodes)) : 0;
        count *= nodes;
    }
    constexpr double kMostNodes = 1e8;
    if (!(count <= kMostNodes))
        throw UserError(
            fmt::format("{}: the mesh is {:.6g} m by {:.6g} m by {:.6g} m, and its distances every {} m "
                        "would be {:.3g} numbers; expected 1e8 at most: is it in metres? otherwise take "
                        "a larger spacing",
                        file.string(), bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4],
                        sampling.spacing, count));
    field.distance.resize(static_cast<std::size_t>(field.nodes[0] * field.nodes[1] * field.nodes[2]));
    return field;
}

}  // namespace

static DistanceField distances_of(const Path& file, const MeshSampling& sampling,
                                  const std::function<void(const std::string&)>& say) {
    expect(sampling.spacing > 0.0 && sampling.margin >= 0.0, "a mesh is sampled at a distance above zero");
    const vtkSmartPointer<vtkPolyData> mesh = read_triangles(file);
    const std::vector<Triangle> triangles = triangles_of(mesh);
    require_closed(file, mesh, triangles);
    require_simple(file, mesh, triangles);
    require_volume(file, mesh, triangles);
    DistanceField field = field_around(file, mesh, sampling);
    constexpr std::size_t kMany = 5'000'000;  // a second of one thread
    if (field.distance.size() > kMany && say)
        say(fmt::format("{}: measuring its distance from {:.3g} million places, {:.6g} m apart", file.string(),
                        1e-6 * static_cast<double>(field.distance.size()), sampling.spacing));
    measure_distances(turned_outwards(mesh, triangles), field);
    if (std::none_of(field.distance.begin(), field.distance.end(), [](double d) { return d < 0.0; }))
        throw UserError(
            fmt::format("{}: the mesh is thinner than the {:.6g} m between the nodes of its distances; expected a "
                        "solid of a cell at least: take finer cells, or give the wall as a line with a height",
                        file.string(), sampling.spacing));
    field.origin += sampling.origin;
    return field;
}

DistanceField read_barrier_mesh(const std::filesystem::path& file, const MeshSampling& sampling) {
    return distances_of(file, sampling, nullptr);
}

static MeshField with_its_box(DistanceField&& distances, const MeshSampling& sampling) {
    auto field = std::make_shared<DistanceField>(std::move(distances));
    const Vec3 around = Vec3::Constant(sampling.margin), low = field->origin + around, high = field->end() - around;
    return {std::move(field), low, high};
}

MeshField barrier_mesh_of(const std::filesystem::path& file, const MeshSampling& sampling) {
    return with_its_box(read_barrier_mesh(file, sampling), sampling);
}

MeshReader barrier_meshes_told(std::function<void(const std::string&)> say) {
    return [say = std::move(say)](const Path& file, const MeshSampling& sampling) {
        return with_its_box(distances_of(file, sampling, say), sampling);
    };
}

TriangleMesh barrier_triangles(const std::filesystem::path& file, const Vec3& origin) {
    const vtkSmartPointer<vtkPolyData> read = read_triangles(file);
    const std::vector<Triangle> triangles = triangles_of(read);
    TriangleMesh mesh = turned_outwards(read, triangles);
    for (Vec3& x : mesh.points) x += origin;
    return mesh;
}

}  // namespace frana
