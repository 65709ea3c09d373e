#include "observe/insitu_tables.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "observe/profiles.h"
#include "observe/table.h"

namespace frana {
namespace {

std::vector<Scalar> scalars(const Frame& frame, const std::vector<std::string>& names) {
    std::vector<Scalar> found;
    found.reserve(names.size());
    for (const std::string& name : names) found.push_back(scalar(frame.nodes, name, "the grid"));
    return found;
}

/// A table that is begun with its first row, when the units are known.
class LateTable {
public:
    explicit LateTable(std::filesystem::path file) : file_(std::move(file)) {}
    TableWriter& with_columns(const std::vector<std::string>& columns) {
        if (!table_) table_.emplace(file_, columns);
        return *table_;
    }
    void serialize(Archive& archive) {
        std::vector<std::string> columns;
        if (table_) columns = table_->columns();
        archive.texts("columns", columns);
        if (!columns.empty()) with_columns(columns).serialize(archive);
    }

private:
    std::filesystem::path file_;
    std::optional<TableWriter> table_;
};

class CutTable final : public InsituWork {
public:
    CutTable(std::filesystem::path csv, Polyline line, std::vector<std::string> fields)
        : table_(std::move(csv)), line_(std::move(line)), fields_(std::move(fields)) {}

    void sample(const Frame& frame, Index) override {
        const std::vector<Scalar> values = scalars(frame, fields_);
        const Scalar bed = scalar(frame.nodes, "elevation", "the grid");
        std::vector<std::string> columns = {"t [s]", "distance [m]", "x [m]", "y [m]", "bed [m]"};
        for (const Scalar& value : values) columns.push_back(value.name + " [" + value.unit + "]");
        TableWriter& table = table_.with_columns(columns);
        for (const Station& station : stations(line_, 0.5 * frame.grid.cell)) {
            std::vector<double> row = {frame.status.time, station.distance, station.point.x(), station.point.y(),
                                       value_at(bed, frame.grid, station.point)};
            for (const Scalar& value : values) row.push_back(value_at(value, frame.grid, station.point));
            table.add(row);
        }
        table.flush();
    }
    void serialize(Archive& archive) override { table_.serialize(archive); }

private:
    LateTable table_;
    Polyline line_;
    std::vector<std::string> fields_;
};

/// Extremes and sum of a field over chosen nodes.
struct Extent {
    double low = TableWriter::empty, high = TableWriter::empty, sum = 0.0;
    Index highest = -1, count = 0;

    void add(Index node, double value) {
        low = highest < 0 ? value : std::min(low, value);
        if (highest < 0 || value > high) high = value, highest = node;
        sum += value, ++count;
    }
};

/// What only solids have: where free water is alone it says nothing.
bool is_of_solids(const std::string& field) {
    for (const char* name : {"damage", "cohesion", "stress", "effective_stress"})
        if (field.rfind(name, 0) == 0) return true;
    return false;
}

/// Where the flow never came, -1 stands for its arrival.
bool is_never(const Scalar& values, Index node) { return values.name == "arrival_time" && values[node] < 0.0; }

class Reduction final : public InsituWork {
public:
    Reduction(std::filesystem::path csv, std::vector<std::string> fields, double above)
        : table_(std::move(csv)), fields_(std::move(fields)), above_(above) {}

    void sample(const Frame& frame, Index) override {
        const std::vector<Scalar> values = scalars(frame, fields_);
        const Scalar depth = scalar(frame.nodes, "depth", "the grid");
        const Field* const water = frame.node("water_depth");
        const auto has_solids = [&](Index k) {  // depth is that of both, a sum
            return water == nullptr || depth[k] - water->data[k] > 1e-9 * depth[k];
        };
        std::vector<Extent> extents(values.size());
        double depths = 0.0;
        Index nodes = 0;
        for (Index k = 0; k < depth.count; ++k) {
            if (!(depth[k] > above_)) continue;
            ++nodes;
            depths += depth[k];
            for (std::size_t f = 0; f < values.size(); ++f)
                if ((!is_of_solids(values[f].name) || has_solids(k)) && !is_never(values[f], k))
                    extents[f].add(k, values[f][k]);
        }
        const double pixel = frame.grid.cell * frame.grid.cell;
        std::vector<double> row = {frame.status.time, pixel * static_cast<double>(nodes), pixel * depths};
        for (const Extent& extent : extents) add_cells(row, extent, frame.grid);
        TableWriter& table = table_.with_columns(columns(values));
        table.add(row);
        table.flush();
    }
    void serialize(Archive& archive) override { table_.serialize(archive); }

private:
    static std::vector<std::string> columns(const std::vector<Scalar>& values) {
        std::vector<std::string> result = {"t [s]", "area [m2]", "volume [m3]"};
        for (const Scalar& value : values) {
            const std::string unit = " [" + value.unit + "]";
            result.insert(result.end(),
                          {value.name + "_min" + unit, value.name + "_max" + unit, value.name + "_max_x [m]",
                           value.name + "_max_y [m]", value.name + "_mean" + unit});
        }
        return result;
    }

    static void add_cells(std::vector<double>& row, const Extent& extent, const GridGeometry& grid) {
        const double none = TableWriter::empty;
        const bool any = extent.count > 0;
        row.insert(row.end(), {extent.low, extent.high, any ? grid.x(extent.highest % grid.nx) : none,
                               any ? grid.y(extent.highest / grid.nx) : none,
                               any ? extent.sum / static_cast<double>(extent.count) : none});
    }

    LateTable table_;
    std::vector<std::string> fields_;
    double above_;
};

}  // namespace

double value_at(const Scalar& nodes, const GridGeometry& grid, const Vec2& point) {
    const std::vector<Corner> around = corners(grid, point);
    if (around.empty()) return TableWriter::empty;
    double value = 0.0;
    for (const Corner& corner : around) {
        if (is_never(nodes, corner.node)) return TableWriter::empty;
        value += corner.weight * nodes[corner.node];
    }
    return value;
}

std::unique_ptr<InsituWork> make_cut_table(const std::filesystem::path& csv, const Polyline& line,
                                           const std::vector<std::string>& fields) {
    return std::make_unique<CutTable>(csv, line, fields);
}

std::unique_ptr<InsituWork> make_reduction(const std::filesystem::path& csv, const std::vector<std::string>& fields,
                                           double above) {
    return std::make_unique<Reduction>(csv, fields, above);
}

}  // namespace frana
