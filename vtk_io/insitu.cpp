#include "vtk_io/insitu.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkThreshold.h>
#include <vtkThresholdPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cmath>

#include "observe/insitu_tables.h"
#include "vtk_io/level_lines.h"
#include "vtk_io/pvd.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

/// A series of files in the folder, one for each sample.
class Series {
public:
    Series(const std::filesystem::path& folder, const std::string& name, const char* extension)
        : files_(folder / (name + ".pvd"), name, extension) {}

    void write(vtkXMLWriter* writer, vtkDataObject* data, const Frame& frame, Index number) {
        write_xml(writer, data, files_.file(number));
        files_.add(number, frame.status.time);
    }
    void serialize(Archive& archive) { files_.serialize(archive); }

private:
    PvdSeries files_;
};

/// A node field, not a number where there is no terrain.
std::vector<double> on_terrain(const Frame& frame, const std::string& field) {
    const Scalar values = scalar(frame.nodes, field, "the grid");
    const Scalar bed = scalar(frame.nodes, "elevation", "the grid");
    std::vector<double> result(static_cast<std::size_t>(values.count), Raster::nodata);
    for (Index k = 0; k < values.count; ++k)
        if (!std::isnan(bed[k])) result[static_cast<std::size_t>(k)] = values[k];
    return result;
}

class Contours final : public InsituWork {
public:
    Contours(const std::filesystem::path& folder, const std::string& name, std::string field,
             std::vector<double> levels)
        : series_(folder, name, ".vtp"), field_(std::move(field)), levels_(std::move(levels)) {}

    void sample(const Frame& frame, Index number) override {
        const Scalar surface = scalar(frame.nodes, "surface", "the grid");
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> lines;
        vtkNew<vtkDoubleArray> level_of;
        level_of->SetName("level");
        for (const auto& [level, line] : level_lines_of(frame, field_, levels_)) {
            lines->InsertNextCell(static_cast<int>(line.size()));
            for (const Vec2& p : line)
                lines->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), value_at(surface, frame.grid, p)));
            level_of->InsertNextValue(level);
        }
        vtkNew<vtkPolyData> contours;
        contours->SetPoints(points);
        contours->SetLines(lines);
        contours->GetCellData()->AddArray(level_of);
        add_unit(contours->GetFieldData(), "level", scalar(frame.nodes, field_, "the grid").unit);
        add_time(contours->GetFieldData(), frame.status.time);
        vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
        series_.write(writer, contours, frame, number);
    }
    void serialize(Archive& archive) override { series_.serialize(archive); }

private:
    Series series_;
    std::string field_;
    std::vector<double> levels_;
};

const char* const kept_name = "kept";

/// Marks the points whose value is within the interval; a value that is not a number never is.
void mark(vtkDataSet* data, const Scalar& values, const Interval& kept) {
    vtkNew<vtkUnsignedCharArray> marks;
    marks->SetName(kept_name);
    marks->SetNumberOfTuples(values.count);
    for (Index k = 0; k < values.count; ++k)
        marks->SetValue(k, values[k] >= kept.low && values[k] <= kept.high ? 1 : 0);
    data->GetPointData()->AddArray(marks);
}

/// What the filters leave, without the marks; the field data (units, time) come along.
template <class Filter>
auto filtered(Filter* filter, vtkDataSet* data) {
    filter->SetInputData(data);
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, kept_name);
    filter->Update();
    auto* result = filter->GetOutput();
    result->GetPointData()->RemoveArray(kept_name);
    result->GetFieldData()->ShallowCopy(data->GetFieldData());
    return result;
}

class CellThreshold final : public InsituWork {
public:
    CellThreshold(const std::filesystem::path& folder, const std::string& name, std::string field, const Interval& kept)
        : series_(folder, name, ".vtu"), field_(std::move(field)), kept_(kept) {}

    void sample(const Frame& frame, Index number) override {
        const std::vector<double> values = on_terrain(frame, field_);
        const auto image = image_of(frame);
        mark(image, {field_, "", values.data(), static_cast<Index>(values.size()), 1}, kept_);
        vtkNew<vtkThreshold> threshold;
        threshold->SetThresholdFunction(vtkThreshold::THRESHOLD_UPPER);
        threshold->SetUpperThreshold(1.0);
        threshold->AllScalarsOn();
        vtkNew<WithBase64Stream<vtkXMLUnstructuredGridWriter>> writer;
        series_.write(writer, filtered(threshold.Get(), image), frame, number);
    }
    void serialize(Archive& archive) override { series_.serialize(archive); }

private:
    Series series_;
    std::string field_;
    Interval kept_;
};

class ParticleThreshold final : public InsituWork {
public:
    ParticleThreshold(const std::filesystem::path& folder, const std::string& name, std::string field,
                      const Interval& kept)
        : series_(folder, name, ".vtp"), field_(std::move(field)), kept_(kept) {}

    void sample(const Frame& frame, Index number) override {
        const auto cloud = cloud_of(frame);
        const Scalar values = scalar(frame.particles, field_, "the particles");
        vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
        if (cloud->GetNumberOfPoints() == 0) {  // VTK's filter calls that an error, loudly
            series_.write(writer, cloud, frame, number);
            return;
        }
        mark(cloud, values, kept_);
        vtkNew<vtkThresholdPoints> threshold;
        threshold->ThresholdByUpper(1.0);
        threshold->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        series_.write(writer, filtered(threshold.Get(), cloud), frame, number);
    }
    void serialize(Archive& archive) override { series_.serialize(archive); }

private:
    Series series_;
    std::string field_;
    Interval kept_;
};

}  // namespace

std::vector<std::pair<double, Polyline>> level_lines_of(const Frame& frame, const std::string& field,
                                                        const std::vector<double>& levels) {
    const Raster raster{frame.grid, on_terrain(frame, field), "", ""};
    std::vector<std::pair<double, Polyline>> lines;
    for (const double level : levels)
        for (Polyline& line : level_lines(raster, level)) lines.emplace_back(level, std::move(line));
    return lines;
}

std::vector<std::uint8_t> cells_within(const Frame& frame, const std::string& field, const Interval& kept) {
    const std::vector<double> values = on_terrain(frame, field);
    const Index nx = frame.grid.nx, ny = frame.grid.ny;
    const auto inside = [&](Index i, Index j) {
        const double value = values[static_cast<std::size_t>(j * nx + i)];
        return value >= kept.low && value <= kept.high;  // never for what is not a number
    };
    std::vector<std::uint8_t> cells;
    for (Index j = 0; j + 1 < ny; ++j)
        for (Index i = 0; i + 1 < nx; ++i)
            cells.push_back(inside(i, j) && inside(i + 1, j) && inside(i, j + 1) && inside(i + 1, j + 1));
    return cells;
}

std::unique_ptr<InsituWork> make_contours(const std::filesystem::path& folder, const std::string& name,
                                          const std::string& field, const std::vector<double>& levels) {
    return std::make_unique<Contours>(folder, name, field, levels);
}

std::unique_ptr<InsituWork> make_cell_threshold(const std::filesystem::path& folder, const std::string& name,
                                                const std::string& field, const Interval& kept) {
    return std::make_unique<CellThreshold>(folder, name, field, kept);
}

std::unique_ptr<InsituWork> make_particle_threshold(const std::filesystem::path& folder, const std::string& name,
                                                    const std::string& field, const Interval& kept) {
    return std::make_unique<ParticleThreshold>(folder, name, field, kept);
}

}  // namespace frana
