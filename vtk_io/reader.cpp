#include "vtk_io/reader.h"

#include <fmt/core.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataSetAttributes.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "vtk_io/pvd.h"
#include "vtk_io/xml_reading.h"

namespace frana {
namespace {

/// Runs a VTK reader on a file, turning its complaints into a UserError.
void read_file(vtkXMLReader* reader, const std::filesystem::path& file,
               const std::function<bool(const std::string& array)>& wanted = {}) {
    const UserError unreadable(fmt::format("{}: cannot be read as a VTK file; run the case again", file.string()));
    if (!std::filesystem::exists(file)) throw UserError(file.string() + ": not found; run the case again");
    if (!read_xml(reader, file, wanted)) throw unreadable;
}

/// Points and what they make up, every number of a point being that of one.
vtkSmartPointer<vtkPolyData> read_polydata(const std::filesystem::path& file) {
    vtkNew<vtkXMLPolyDataReader> reader;
    read_file(reader, file);
    if (const std::string fault = fault_of(reader->GetOutput()); !fault.empty())
        throw UserError(fmt::format("{}: {}; run the case again", file.string(), fault));
    return reader->GetOutput();
}

std::vector<double> numbers_of(vtkDataArray* array) {
    if (auto* const floats = vtkFloatArray::SafeDownCast(array))  // most are: many times as fast as tuple by tuple
        return {floats->GetPointer(0), floats->GetPointer(0) + floats->GetNumberOfValues()};
    std::vector<double> numbers(static_cast<std::size_t>(array->GetNumberOfValues()));
    for (vtkIdType k = 0; k < array->GetNumberOfTuples(); ++k)
        array->GetTuple(k, numbers.data() + k * array->GetNumberOfComponents());
    return numbers;
}

/// Arrays and units, whatever there is; `Loaded` names them as members `components` and `units`.
template <class Loaded>
void take_arrays(vtkDataSet* data, Loaded& loaded, std::map<std::string, std::vector<double>>& into) {
    vtkPointData* arrays = data->GetPointData();
    for (int k = 0; k < arrays->GetNumberOfArrays(); ++k) {
        vtkDataArray* array = arrays->GetArray(k);
        if (!array || !array->GetName() || array->GetName() == std::string(vtkDataSetAttributes::GhostArrayName()))
            continue;
        into[array->GetName()] = numbers_of(array);
        loaded.components[array->GetName()] = array->GetNumberOfComponents();
    }
    const std::string tail = "_unit";
    for (int k = 0; k < data->GetFieldData()->GetNumberOfArrays(); ++k) {
        vtkStringArray* text = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(k));
        if (!text || !text->GetName() || text->GetNumberOfValues() != 1) continue;
        const std::string name = text->GetName();
        if (name.size() > tail.size() && name.compare(name.size() - tail.size(), tail.size(), tail) == 0)
            loaded.units[name.substr(0, name.size() - tail.size())] = text->GetValue(0);
    }
}

LoadedFrame frame_of(vtkImageData* image) {
    LoadedFrame frame;
    int dimensions[3];
    image->GetDimensions(dimensions);
    const double* origin = image->GetOrigin();
    frame.grid = {dimensions[0], dimensions[1], origin[0], origin[1], image->GetSpacing()[0]};
    take_arrays(image, frame, frame.nodes);
    if (frame.has("elevation") && frame.has("outside")) {
        auto& elevation = frame.nodes["elevation"];
        const auto& outside = frame.nodes["outside"];
        for (std::size_t k = 0; k < elevation.size(); ++k)
            if (outside[k] != 0.0) elevation[k] = Raster::nodata;
    }
    return frame;
}

LoadedFrame read_image(const std::filesystem::path& file, const std::vector<std::string>& only = {}) {
    vtkNew<vtkXMLImageDataReader> reader;
    const auto wanted = [&only](const std::string& name) {
        return name == "elevation" || name == "outside" || std::find(only.begin(), only.end(), name) != only.end();
    };
    only.empty() ? read_file(reader, file) : read_file(reader, file, wanted);
    LoadedFrame frame = frame_of(reader->GetOutput());
    vtkDataArraySelection* const arrays = reader->GetPointDataArraySelection();
    for (int k = 0; k < arrays->GetNumberOfArrays(); ++k) frame.names.emplace_back(arrays->GetArrayName(k));
    return frame;
}

std::vector<double> times_in(const std::filesystem::path& pvd) {
    std::vector<double> times;
    for (const PvdEntry& entry : read_pvd(pvd)) times.push_back(entry.time);
    return times;
}

/// Entry `number` of a .pvd (negative: from the end) and its position.
std::pair<PvdEntry, Index> entry_of(const std::filesystem::path& pvd, Index number) {
    const auto entries = read_pvd(pvd);
    const auto count = static_cast<Index>(entries.size());
    const Index k = number < 0 ? count + number : number;
    if (k < 0 || k >= count)
        throw UserError(fmt::format("{}: has no frame {}; it has {} frames, ask for 0 to {} or -1 for the last one",
                                    pvd.string(), number, count, count - 1));
    return {entries[static_cast<std::size_t>(k)], k};
}

}  // namespace

std::vector<double> frame_times(const std::filesystem::path& run_dir) { return times_in(run_dir / "grid.pvd"); }

std::vector<double> particle_times(const std::filesystem::path& run_dir) { return times_in(run_dir / "particles.pvd"); }

Index nearest_frame(const std::filesystem::path& run_dir, double time) {
    const auto times = frame_times(run_dir);
    if (times.empty()) throw UserError((run_dir / "grid.pvd").string() + ": lists no frame; run the case again");
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < times.size(); ++k)
        if (std::abs(times[k] - time) < std::abs(times[nearest] - time)) nearest = k;
    return static_cast<Index>(nearest);
}

LoadedFrame read_frame(const std::filesystem::path& run_dir, Index number, const std::vector<std::string>& only) {
    const auto [entry, position] = entry_of(run_dir / "grid.pvd", number);
    LoadedFrame frame = read_image(run_dir / entry.file, only);
    frame.number = position;
    frame.time = entry.time;
    return frame;
}

LoadedParticles read_particles(const std::filesystem::path& run_dir, Index number) {
    const auto [entry, position] = entry_of(run_dir / "particles.pvd", number);
    const vtkSmartPointer<vtkPolyData> points = read_polydata(run_dir / entry.file);
    LoadedParticles particles;
    particles.number = position;
    particles.time = entry.time;
    particles.count = points->GetNumberOfPoints();
    take_arrays(points, particles, particles.arrays);
    if (particles.count > 0)
        particles.arrays["position"] = numbers_of(points->GetPoints()->GetData());
    else
        particles.arrays["position"] = {};
    particles.components["position"] = 3;
    return particles;
}

ProfileShape profile_shape(const std::filesystem::path& run_dir) {
    const std::filesystem::path pvd = run_dir / "profiles.pvd";
    const auto frames = static_cast<Index>(times_in(pvd).size());
    ProfileShape shape;
    for (Index k = 0; k < 7; ++k) {
        const vtkSmartPointer<vtkPolyData> lines =
            read_polydata(run_dir / entry_of(pvd, k * (frames - 1) / 6).first.file);
        vtkPointData* const data = lines->GetPointData();
        vtkDataArray *const depth = data->GetArray("depth"), *const surface = data->GetArray("surface"),
                            *const first = data->GetArray("initial_elevation");
        if (lines->GetNumberOfCells() == 0 || !depth) return shape;
        vtkIdList* const stations = lines->GetCell(0)->GetPointIds();
        for (vtkIdType n = 0; n < stations->GetNumberOfIds(); ++n) {
            if (k == 0) shape.elevation.push_back(lines->GetPoint(stations->GetId(n))[2]);
            const vtkIdType at = stations->GetId(n);
            shape.deepest = std::max(shape.deepest, depth->GetTuple1(at));
            if (surface && first)
                shape.deepest = std::max(shape.deepest, std::abs(surface->GetTuple1(at) - first->GetTuple1(at)));
        }
    }
    return shape;
}

std::vector<double> barrier_times(const std::filesystem::path& run_dir) {
    const std::filesystem::path pvd = run_dir / "barriers.pvd";
    return std::filesystem::exists(pvd) ? times_in(pvd) : std::vector<double>{};
}

std::vector<LoadedPatch> read_barriers(const std::filesystem::path& run_dir, Index number) {
    const std::filesystem::path file = run_dir / entry_of(run_dir / "barriers.pvd", number).first.file;
    const vtkSmartPointer<vtkPolyData> faces = read_polydata(file);
    vtkDataArray *pressure = faces->GetCellData()->GetArray("pressure"),
                 *barrier = faces->GetCellData()->GetArray("barrier"), *face = faces->GetCellData()->GetArray("face");
    if (!pressure || !barrier || !face)
        throw UserError(file.string() + ": has no loads of barriers; run the case again");
    std::vector<LoadedPatch> patches;
    for (vtkIdType k = 0; k < faces->GetNumberOfCells(); ++k) {
        LoadedPatch patch;
        vtkIdList* points = faces->GetCell(k)->GetPointIds();
        if (points->GetNumberOfIds() != 4) throw UserError(file.string() + ": has faces other than of four corners");
        for (std::size_t c = 0; c < 4; ++c)
            faces->GetPoint(points->GetId(static_cast<vtkIdType>(c)), patch.corners[c].data());
        patch.pressure = pressure->GetTuple1(k);
        patch.barrier = static_cast<int>(barrier->GetTuple1(k));
        patch.face = static_cast<int>(face->GetTuple1(k));
        patches.push_back(patch);
    }
    return patches;
}

BarrierMeshes read_barrier_meshes(const std::filesystem::path& run_dir) {
    const std::filesystem::path file = run_dir / "barrier_meshes.vtp";
    if (!std::filesystem::exists(file)) return {};
    const vtkSmartPointer<vtkPolyData> data = read_polydata(file);
    vtkDataArray* const barrier = data->GetCellData()->GetArray("barrier");
    std::map<int, TriangleMesh> meshes;
    std::map<int, std::map<vtkIdType, Index>> numbers;  // of a point in its barrier's mesh
    for (vtkIdType k = 0; k < data->GetNumberOfCells(); ++k) {
        vtkIdList* const corners = data->GetCell(k)->GetPointIds();
        if (!barrier || barrier->GetTuple1(k) < 0.0 || corners->GetNumberOfIds() != 3)
            throw UserError(file.string() + ": has no triangles of barriers; run the case again");
        const int n = static_cast<int>(barrier->GetTuple1(k));
        TriangleMesh& mesh = meshes[n];
        auto& triangle = mesh.triangles.emplace_back();
        for (vtkIdType c = 0; c < 3; ++c) {
            const vtkIdType point = corners->GetId(c);
            const auto [number, is_new] = numbers[n].try_emplace(point, static_cast<Index>(mesh.points.size()));
            if (is_new) mesh.points.emplace_back(data->GetPoint(point));
            triangle[static_cast<std::size_t>(c)] = number->second;
        }
    }
    BarrierMeshes all(meshes.empty() ? 0 : static_cast<std::size_t>(meshes.rbegin()->first) + 1);
    for (auto& [n, mesh] : meshes) all[static_cast<std::size_t>(n)] = std::make_shared<TriangleMesh>(std::move(mesh));
    return all;
}

std::optional<std::array<double, 4>> bounds_of(const std::filesystem::path& vtp) {
    const vtkSmartPointer<vtkPolyData> shape = read_polydata(vtp);
    if (shape->GetNumberOfPoints() == 0) return std::nullopt;
    double b[6];
    shape->GetBounds(b);
    return std::array<double, 4>{b[0], b[2], b[1], b[3]};
}

LoadedFrame read_terrain(const std::filesystem::path& run_dir) { return read_image(run_dir / "terrain.vti"); }

LoadedFrame read_maps(const std::filesystem::path& dir) { return read_image(dir / "maps.vti"); }

}  // namespace frana
