#include "vtk_io/writers.h"

#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include "vtk_io/pvd.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

class ParticleWriter final : public Observer {
public:
    explicit ParticleWriter(const std::filesystem::path& run_dir)
        : series_(run_dir / "particles.pvd", "particles", ".vtp") {}

    std::string name() const override { return "vtk particles"; }

    void observe(const Frame& frame) override {
        const auto cloud = cloud_of(frame);
        vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
        write_xml(writer, cloud, series_.file(frame.number));
        series_.add(frame.number, frame.status.time);
    }
    void serialize(Archive& archive) override { series_.serialize(archive); }

private:
    PvdSeries series_;
};

class GridWriter final : public Observer {
public:
    explicit GridWriter(const std::filesystem::path& run_dir) : series_(run_dir / "grid.pvd", "grid", ".vti") {}

    std::string name() const override { return "vtk grid"; }

    void observe(const Frame& frame) override {
        const auto image = image_of(frame);
        vtkNew<WithBase64Stream<vtkXMLImageDataWriter>> writer;
        write_xml(writer, image, series_.file(frame.number));
        series_.add(frame.number, frame.status.time);
    }
    void serialize(Archive& archive) override { series_.serialize(archive); }

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
