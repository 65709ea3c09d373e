#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <array>
#include <cmath>
#include <string>

#include "vtk_io/pvd.h"
#include "vtk_io/writers.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

struct Column {
    const char *name, *unit;
};
constexpr Column columns[] = {{"distance", "m"},         {"elevation", "m"},       {"depth", "m"},
                              {"surface", "m"},          {"initial_surface", "m"}, {"velocity_along", "m/s"},
                              {"initial_elevation", "m"}};
constexpr std::size_t column_count = std::size(columns);

/// Stations of one profile at one time; those without terrain are left out.
struct Line {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<double, column_count>> rows;  ///< as `columns`
};

class ProfileWriter final : public Observer {
public:
    ProfileWriter(const std::filesystem::path& run_dir, std::vector<ProfileLine> lines)
        : series_(run_dir / "profiles.pvd", "profiles", ".vtp"), lines_(std::move(lines)) {}

    std::string name() const override { return "vtk profiles"; }

    void observe(const Frame& frame) override {
        std::vector<Line> sampled;
        for (const ProfileLine& line : lines_) sampled.push_back(along(line, frame));
        if (first_.empty()) first_ = column_of(sampled, 3), first_bed_ = column_of(sampled, 1);
        for (std::size_t k = 0; k < sampled.size(); ++k)
            for (std::size_t row = 0; row < sampled[k].rows.size(); ++row)
                sampled[k].rows[row][4] = first_[k][row], sampled[k].rows[row][6] = first_bed_[k][row];
        const auto data = polydata_of(sampled);
        add_time(data->GetFieldData(), frame.status.time);
        vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
        write_xml(writer, data, series_.file(frame.number));
        series_.add(frame.number, frame.status.time);
    }
    void serialize(Archive& archive) override {
        series_.serialize(archive);
        first_.resize(lines_.size());  // a state is saved after the first frame only
        first_bed_.resize(lines_.size());
        for (std::size_t k = 0; k < first_.size(); ++k) {
            archive.array("surface_" + std::to_string(k), first_[k]);
            archive.array("bed_" + std::to_string(k), first_bed_[k]);
        }
    }

private:
    static std::vector<std::vector<double>> column_of(const std::vector<Line>& sampled, std::size_t column) {
        std::vector<std::vector<double>> values(sampled.size());
        for (std::size_t k = 0; k < sampled.size(); ++k)
            for (const auto& row : sampled[k].rows) values[k].push_back(row[column]);
        return values;
    }

    static Line along(const ProfileLine& profile, const Frame& frame) {
        Line line;
        for (const Station& station : stations(profile.line, 0.5 * frame.grid.cell)) {
            const Sample flow = sample(frame, station.point);
            if (!std::isfinite(flow.elevation)) continue;
            line.points.push_back({station.point.x(), station.point.y(), flow.elevation});
            line.rows.push_back({station.distance, flow.elevation, flow.depth, flow.elevation + flow.depth, 0.0,
                                 flow.velocity.dot(station.along), 0.0});
        }
        return line;
    }

    vtkSmartPointer<vtkPolyData> polydata_of(const std::vector<Line>& sampled) const {
        auto data = vtkSmartPointer<vtkPolyData>::New();
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> cells;
        vtkNew<vtkIntArray> profile;
        profile->SetName("profile");
        vtkNew<vtkStringArray> names;
        names->SetName("profile_names");
        for (std::size_t k = 0; k < sampled.size(); ++k) {
            names->InsertNextValue(lines_[k].name);
            if (sampled[k].points.size() < 2) continue;
            cells->InsertNextCell(static_cast<int>(sampled[k].points.size()));
            for (const auto& p : sampled[k].points) cells->InsertCellPoint(points->InsertNextPoint(p.data()));
            profile->InsertNextValue(static_cast<int>(k));
        }
        data->SetPoints(points);
        data->SetLines(cells);
        data->GetCellData()->AddArray(profile);
        data->GetFieldData()->AddArray(names);
        add_columns(sampled, data);
        return data;
    }

    static void add_columns(const std::vector<Line>& sampled, vtkPolyData* data) {
        for (std::size_t c = 0; c < column_count; ++c) {
            vtkNew<vtkFloatArray> values;
            values->SetName(columns[c].name);
            for (const Line& line : sampled)
                if (line.points.size() > 1)
                    for (const auto& row : line.rows) values->InsertNextValue(static_cast<float>(row[c]));
            data->GetPointData()->AddArray(values);
            add_unit(data->GetFieldData(), columns[c].name, columns[c].unit);
        }
        add_unit(data->GetFieldData(), "profile", "1");
    }

    PvdSeries series_;
    std::vector<ProfileLine> lines_;
    std::vector<std::vector<double>> first_;      ///< surface of the first frame at every station [m]
    std::vector<std::vector<double>> first_bed_;  ///< its bed there [m]
};

}  // namespace

std::unique_ptr<Observer> make_profile_writer(const std::filesystem::path& run_dir, std::vector<ProfileLine> lines) {
    return std::make_unique<ProfileWriter>(run_dir, std::move(lines));
}

}  // namespace frana
