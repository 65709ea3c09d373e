#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cmath>

#include "vtk_io/pvd.h"
#include "vtk_io/writers.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

using Place = std::array<double, 3>;

Place moved(const Place& from, const Place& right, double a, const Place& up, double b) {
    return {from[0] + a * right[0] + b * up[0], from[1] + a * right[1] + b * up[1], from[2] + a * right[2] + b * up[2]};
}

double dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Patches that are not on the face, and had no force, are not shown.
bool shown(const PatchedFace& face, std::size_t square) {
    const Place& given = face.impulse[square];
    return face.off_face.empty() || !face.off_face[square] || dot(given, given) > 0.0;
}

class BarrierWriter final : public Observer {
public:
    BarrierWriter(const std::filesystem::path& run_dir, std::vector<BarrierTop> tops, Raster bed)
        : series_(run_dir / "barriers.pvd", "barriers", ".vtp"), tops_(std::move(tops)), bed_(std::move(bed)) {}

    std::string name() const override { return "vtk barriers"; }

    void observe(const Frame& frame) override {
        if (frame.faces.empty()) {  // points are still to come
            time_ = frame.status.time;
            return;
        }
        const double span = frame.status.time - time_;
        const auto data = polydata_of(frame, span > 0.0 ? span : 0.0);
        add_heights(frame, data);
        add_time(data->GetFieldData(), frame.status.time);
        vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
        write_xml(writer, data, series_.file(frame.number));
        series_.add(frame.number, frame.status.time);
        if (span > 0.0) time_ = frame.status.time;
    }
    void serialize(Archive& archive) override {
        series_.serialize(archive);
        archive.numbers("time", {&time_});
        archive.array("before", before_);
        archive.array("peak", peak_);
    }

private:
    vtkSmartPointer<vtkPolyData> polydata_of(const Frame& frame, double span) {
        auto data = vtkSmartPointer<vtkPolyData>::New();
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> cells;
        vtkNew<vtkFloatArray> pressure, peak, impulse, areas;
        vtkNew<vtkIntArray> barrier, face_number;
        std::size_t n = 0;
        for (const PatchedFace& face : frame.faces) {
            const Place normal = {face.right[1] * face.up[2] - face.right[2] * face.up[1],
                                  face.right[2] * face.up[0] - face.right[0] * face.up[2],
                                  face.right[0] * face.up[1] - face.right[1] * face.up[0]};
            for (Index b = 0; b < face.count[1]; ++b)
                for (Index a = 0; a < face.count[0]; ++a, ++n) {
                    const auto square = static_cast<std::size_t>(b * face.count[0] + a);
                    if (before_.size() <= n) before_.push_back(0.0), peak_.push_back(0.0);
                    if (!shown(face, square)) continue;
                    const double u = face.size * static_cast<double>(a), v = face.size * static_cast<double>(b);
                    cells->InsertNextCell(4);
                    for (const auto& [du, dv] :
                         {std::pair{0.0, 0.0}, {face.size, 0.0}, {face.size, face.size}, {0.0, face.size}})
                        cells->InsertCellPoint(
                            points->InsertNextPoint(moved(face.corner, face.right, u + du, face.up, v + dv).data()));
                    const Place& given = face.impulse[square];
                    const double area = face.area[square];
                    const double push = std::abs(dot(given, normal));
                    const double mean = span > 0.0 ? (push - before_[n]) / (span * area) : 0.0;
                    if (span > 0.0) before_[n] = push, peak_[n] = std::max(peak_[n], mean);
                    pressure->InsertNextValue(static_cast<float>(mean));
                    peak->InsertNextValue(static_cast<float>(peak_[n]));
                    impulse->InsertNextValue(static_cast<float>(push / area));
                    areas->InsertNextValue(static_cast<float>(area));
                    barrier->InsertNextValue(static_cast<int>(face.barrier));
                    face_number->InsertNextValue(static_cast<int>(face.face));
                }
        }
        data->SetPoints(points);
        data->SetPolys(cells);
        const auto add = [&](vtkDataArray* array, const char* name, const char* unit) {
            array->SetName(name);
            data->GetCellData()->AddArray(array);
            add_unit(data->GetFieldData(), name, unit);
        };
        add(pressure, "pressure", "Pa");
        add(peak, "peak_pressure", "Pa");
        add(impulse, "impulse_per_area", "Pa s");
        add(areas, "area", "m2");
        add(barrier, "barrier", "1");
        add(face_number, "face", "1");
        return data;
    }

    /// What to add to the elevation of each corner, so that it lies on what is seen of the barrier.
    void add_heights(const Frame& frame, vtkPolyData* data) const {
        vtkNew<vtkFloatArray> shifts;
        shifts->SetName("to_true_height");
        vtkIdType corner = 0;
        for (const PatchedFace& face : frame.faces)
            for (std::size_t k = 0; k < 4 * face.impulse.size(); ++k) {
                if (!shown(face, k / 4)) continue;
                double p[3];
                data->GetPoint(corner++, p);
                shifts->InsertNextValue(static_cast<float>(shift(face, {p[0], p[1], p[2]})));
            }
        data->GetPointData()->AddArray(shifts);
        add_unit(data->GetFieldData(), "to_true_height", "m");
    }

    /// Half a patch of it stands in the ground, or a gap would show between two nodes.
    double shift(const PatchedFace& face, const Place& corner) const {
        const auto barrier = static_cast<std::size_t>(face.barrier);
        if (bed_.values.empty()) return 0.0;
        const Vec2 at(corner[0], corner[1]);
        const double z = corner[2], ground = elevation_at(bed_, at) - 0.5 * face.size;
        const double crest = barrier < tops_.size() ? top_at(tops_[barrier], bed_, at, z) : HUGE_VAL;
        return std::min(std::isnan(ground) ? z : std::max(z, ground), crest) - z;
    }

    PvdSeries series_;
    std::vector<BarrierTop> tops_;
    Raster bed_;  ///< without barriers, which a frame's elevation may have where particles meet them
    double time_ = 0.0;
    std::vector<double> before_, peak_;  ///< per patch: impulse across the face [kg m/s]; largest mean [Pa]
};

}  // namespace

void write_barrier_meshes(const std::filesystem::path& run_dir, const BarrierMeshes& meshes) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkIntArray> barrier;
    barrier->SetName("barrier");
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        if (!meshes[n]) continue;
        const vtkIdType first = points->GetNumberOfPoints();
        for (const Vec3& x : meshes[n]->points) points->InsertNextPoint(x.data());
        for (const auto& triangle : meshes[n]->triangles) {
            cells->InsertNextCell({first + triangle[0], first + triangle[1], first + triangle[2]});
            barrier->InsertNextValue(static_cast<int>(n));
        }
    }
    if (cells->GetNumberOfCells() == 0) return;
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetCellData()->AddArray(barrier);
    add_unit(data->GetFieldData(), "barrier", "1");
    vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
    write_xml(writer, data, run_dir / "barrier_meshes.vtp");
}

std::unique_ptr<Observer> make_barrier_writer(const std::filesystem::path& run_dir, std::vector<BarrierTop> tops,
                                              Raster bed) {
    return std::make_unique<BarrierWriter>(run_dir, std::move(tops), std::move(bed));
}

}  // namespace frana
