#include "vtk_io/writers.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include <numeric>

#include "base/error.h"
#include "observe/file_columns.h"
#include "vtk_io/pvd.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

/// One vertex cell a point: filters that work on cells (Threshold) then see particles one by one.
vtkSmartPointer<vtkCellArray> one_vertex_each(Index count) {
    vtkNew<vtkTypeInt64Array> offsets, points;
    offsets->SetNumberOfValues(count + 1);
    points->SetNumberOfValues(count);
    std::iota(offsets->GetPointer(0), offsets->GetPointer(0) + count + 1, vtkTypeInt64{0});
    std::iota(points->GetPointer(0), points->GetPointer(0) + count, vtkTypeInt64{0});
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    cells->SetData(offsets, points);
    return cells;
}

class ParticleWriter final : public Observer {
public:
    explicit ParticleWriter(const std::filesystem::path& run_dir)
        : series_(run_dir / "particles.pvd", "particles", ".vtp") {}

    std::string name() const override { return "vtk particles"; }

    void see(const Frame& frame) override {
        const Field* position = frame.particle("position");
        expect(position && position->components == 3, "particles have no position of 3 components");
        vtkNew<vtkPolyData> cloud;
        vtkNew<vtkPoints> points;
        points->SetData(to_vtk(*position, {}));
        cloud->SetPoints(points);
        cloud->SetVerts(one_vertex_each(position->count));
        for (const Field& field : frame.particles) {
            expect(field.count == position->count, "particle columns differ in length");
            add_unit(cloud->GetFieldData(), field.name, field.unit);
            if (&field != position) cloud->GetPointData()->AddArray(to_vtk(field, {}));
        }
        add_time(cloud->GetFieldData(), frame.status.time);
        vtkNew<vtkXMLPolyDataWriter> writer;
        write_xml(writer, cloud, series_.file(frame.number));
        series_.add(frame.number, frame.status.time);
    }

private:
    PvdSeries series_;
};

class GridWriter final : public Observer {
public:
    explicit GridWriter(const std::filesystem::path& run_dir)
        : series_(run_dir / "grid.pvd", "grid", ".vti") {}

    std::string name() const override { return "vtk grid"; }

    void see(const Frame& frame) override {
        const auto outside = outside_nodes(frame);
        const auto image = image_of(frame.grid);
        for (const Field& field : frame.nodes) {
            expect(field.count == frame.grid.size(), "a node column is not as long as the grid");
            add_unit(image->GetFieldData(), field.name, field.unit);
            image->GetPointData()->AddArray(to_vtk(field, outside));
        }
        hide_nodes(image, outside);
        add_time(image->GetFieldData(), frame.status.time);
        vtkNew<vtkXMLImageDataWriter> writer;
        write_xml(writer, image, series_.file(frame.number));
        series_.add(frame.number, frame.status.time);
    }

private:
    PvdSeries series_;
};

}  // namespace

std::unique_ptr<Observer> make_particle_writer(const std::filesystem::path& run_dir) {
    return std::make_unique<ParticleWriter>(run_dir);
}

std::unique_ptr<Observer> make_grid_writer(const std::filesystem::path& run_dir) {
    return std::make_unique<GridWriter>(run_dir);
}

}  // namespace frana
