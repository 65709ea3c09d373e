#include "io/netcdf_series.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_crs.h"
#include "io/gdal_support.h"
#include "terrain/places.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

constexpr float kNothing = -9999.0F;

/// A variable of the file, and the node field that it shows.
struct Variable {
    const char *name, *field;
    int component;
    const char *unit, *meaning;
};

constexpr Variable kVariables[] = {{"depth", "depth", 0, "m", "depth of the flow along gravity"},
                                   {"speed", "speed", 0, "m s-1", "speed of the flow along the bed"},
                                   {"velocity_x", "velocity", 0, "m s-1", "velocity of the flow to the east"},
                                   {"velocity_y", "velocity", 1, "m s-1", "velocity of the flow to the north"}};

constexpr Variable kBedChange = {"bed_change", "bed_change", 0, "m",
                                 "what the bed has gained since the start, below 0 what it has lost"};

/// The wet nodes of an output, and those whose bed is no more what it was at the start.
struct Moment {
    double time = 0.0;
    GridGeometry grid;
    std::vector<Index> nodes;
    std::vector<float> values;  ///< all nodes of the first variable, then of the next
    bool bed_changes = false;   ///< the run has a bed that can
    std::vector<Index> changed;
    std::vector<float> change;  ///< of the bed there [m]

    void serialize(Archive& archive) {
        archive.numbers("place", {&time, &grid.x0, &grid.y0, &grid.cell});
        archive.number("nx", grid.nx);
        archive.number("ny", grid.ny);
        archive.array("nodes", nodes);
        serialize(archive, "values", values);
        Index changes = bed_changes ? 1 : 0;
        archive.number("bed_changes", changes);
        bed_changes = changes != 0;
        if (!bed_changes) return;
        archive.array("changed", changed);
        serialize(archive, "change", change);
    }

private:
    static void serialize(Archive& archive, const char* name, std::vector<float>& numbers) {
        std::vector<std::uint8_t> bytes(numbers.size() * sizeof(float));
        if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
        archive.array(name, bytes);
        numbers.resize(bytes.size() / sizeof(float));
        if (!bytes.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    }
};

[[noreturn]] void refuse(const fs::path& file, const gdal::Messages& messages) {
    throw UserError(fmt::format("{}: cannot be written ({}); check the folder, its permissions and free space",
                                file.string(), messages.reason("no reason given")));
}

/// What was refused is told by GDAL's messages.
void note(GDALIHasAttribute& owner, const char* name, const std::string& text) {
    const auto attribute = owner.CreateAttribute(name, {}, GDALExtendedDataType::CreateString());
    if (attribute) attribute->Write(text.c_str());
}

using Dimensions = std::vector<std::shared_ptr<GDALDimension>>;

/// The coordinates of a dimension, as a variable of its name.
bool write_axis(GDALGroup& root, const std::shared_ptr<GDALDimension>& dimension, const std::vector<double>& values,
                const char* unit, const char* axis, const char* standard_name) {
    const auto type = GDALExtendedDataType::Create(GDT_Float64);
    const auto array = root.CreateMDArray(dimension->GetName(), {dimension}, type, nullptr);
    if (!array) return false;
    array->SetUnit(unit);
    note(*array, "axis", axis);
    note(*array, "standard_name", standard_name);
    if (axis[0] == 'T') note(*array, "calendar", "standard");
    const GUInt64 start = 0;
    const std::size_t count = values.size();
    return array->Write(&start, &count, nullptr, nullptr, type, values.data());
}

/// GDAL writes the grid mapping of the systems that its table of CF names has. For others the mapping has the
/// well-known text alone, which CF 1.7 and later allow.
void place(GDALGroup& root, GDALMDArray& array, const OGRSpatialReference& crs) {
    array.SetSpatialRef(&crs);
    if (array.GetAttribute("grid_mapping")) return;
    constexpr const char* kName = "crs";
    if (!root.OpenMDArray(kName)) {
        const auto mapping = root.CreateMDArray(kName, {}, GDALExtendedDataType::Create(GDT_Int32), nullptr);
        if (!mapping) return;
        for (const char* key : {"crs_wkt", "spatial_ref"}) note(*mapping, key, gdal::horizontal_wkt(crs));
    }
    note(array, "grid_mapping", kName);
}

std::shared_ptr<GDALMDArray> make_field(GDALGroup& root, const Dimensions& dimensions, const Variable& variable,
                                        const OGRSpatialReference* crs) {
    constexpr GUInt64 kLargest = 512;
    std::string block;
    for (const auto& dimension : dimensions)
        block += fmt::format("{}{}", block.empty() ? "" : ",",
                             dimension->GetName() == "time" ? 1 : std::min(kLargest, dimension->GetSize()));
    CPLStringList options;
    options.SetNameValue("COMPRESS", "DEFLATE");
    options.SetNameValue("BLOCKSIZE", block.c_str());
    auto array =
        root.CreateMDArray(variable.name, dimensions, GDALExtendedDataType::Create(GDT_Float32), options.List());
    if (!array) return nullptr;
    array->SetNoDataValue(double(kNothing));
    array->SetUnit(variable.unit);
    note(*array, "long_name", variable.meaning);
    if (crs) place(root, *array, *crs);
    return array;
}

/// One plane of a field, all of it for a field without time.
bool write_plane(GDALMDArray& array, Index time, const GridGeometry& grid, const std::vector<float>& plane) {
    const GUInt64 start[] = {GUInt64(time), 0, 0};
    const std::size_t count[] = {1, std::size_t(grid.ny), std::size_t(grid.nx)};
    const std::size_t skip = array.GetDimensionCount() == 3 ? 0 : 1;
    return array.Write(start + skip, count + skip, nullptr, nullptr, GDALExtendedDataType::Create(GDT_Float32),
                       plane.data());
}

std::vector<double> coordinates(double first, double step, Index count) {
    std::vector<double> values;
    for (Index i = 0; i < count; ++i) values.push_back(first + double(i) * step);
    return values;
}

float as_float(double value, const char* what, double time) {
    const auto stored = static_cast<float>(value);
    if (!std::isfinite(stored))
        throw NumericsError(fmt::format("series.nc: {} is {} at {} s, no number", what, value, time));
    return stored;
}

class NetcdfWriter final : public Observer {
public:
    NetcdfWriter(const fs::path& run_dir, std::string title, std::string crs_wkt,
                 const std::vector<std::string>& fields, std::vector<std::string>& warnings)
        : file_(run_dir / "series.nc"), title_(std::move(title)), crs_wkt_(std::move(crs_wkt)), warnings_(warnings) {
        for (const Variable& variable : kVariables)
            if (fields.empty() || std::find(fields.begin(), fields.end(), variable.field) != fields.end())
                variables_.push_back(variable);
        tells_change_ = fields.empty() || std::find(fields.begin(), fields.end(), kBedChange.field) != fields.end();
        gdal::register_drivers();
        driver_ = GetGDALDriverManager()->GetDriverByName("netCDF");
        if (driver_ == nullptr || driver_->GetMetadataItem(GDAL_DCAP_CREATE_MULTIDIMENSIONAL) == nullptr)
            throw UserError(
                "output.formats: this GDAL cannot write netCDF; install one that can, or leave \"netcdf\" out");
    }
    std::string name() const override { return "netcdf"; }

    void observe(const Frame& frame) override {
        Moment moment;
        moment.time = frame.status.time;
        moment.grid = frame.grid;
        const Field* depth = frame.node("depth");
        expect(depth != nullptr, "a frame has the depth of its nodes");
        for (Index node = 0; node < frame.grid.size(); ++node)
            if (depth->data[node] > 0.0) moment.nodes.push_back(node);
        for (const Variable& variable : variables_) {
            const Field* field = frame.node(variable.field);
            expect(field != nullptr && variable.component < field->components, "a frame has the fields of series.nc");
            for (const Index node : moment.nodes)
                moment.values.push_back(
                    as_float(field->data[node * field->components + variable.component], variable.name, moment.time));
        }
        note_change(frame, moment);
        if (!moments_.empty() && !(moment.time > moments_.back().time)) moments_.pop_back();
        moments_.push_back(std::move(moment));
    }

    /// The run is worth more than this file.
    void end(const Frame& last) override try { write_file(last); } catch (const UserError& error) {
        warnings_.push_back(fmt::format("series.nc was not written: {}", error.what()));
    }

    void write_file(const Frame& last) const {
        AtomicFile file(file_);
        const gdal::Messages messages;
        const char* const options[] = {"FORMAT=NC4", nullptr};
        gdal::Dataset dataset(driver_->CreateMultiDimensional(file.path().c_str(), nullptr, options));
        if (!dataset || !write(*dataset->GetRootGroup(), last) || messages.failed()) refuse(file_, messages);
        dataset.reset();  // flushes; a full disk shows here
        if (messages.failed()) refuse(file_, messages);
        file.commit();
    }

    void serialize(Archive& archive) override {
        Index count = static_cast<Index>(moments_.size());
        archive.number("count", count);
        moments_.resize(static_cast<std::size_t>(count));
        for (Index n = 0; n < count; ++n) {
            const Archive::Part part(archive, fmt::format("moment_{}", n));
            moments_[static_cast<std::size_t>(n)].serialize(archive);
        }
    }

private:
    void note_change(const Frame& frame, Moment& moment) const {
        const Field* change = frame.node(kBedChange.field);
        moment.bed_changes = tells_change_ && change != nullptr;
        if (!moment.bed_changes) return;
        for (Index node = 0; node < frame.grid.size(); ++node) {
            if (change->data[node] == 0.0 || std::isnan(change->data[node])) continue;
            moment.changed.push_back(node);
            moment.change.push_back(as_float(change->data[node], kBedChange.name, moment.time));
        }
    }

    bool write(GDALGroup& root, const Frame& last) const {
        const GridGeometry& grid = last.grid;
        note(root, "Conventions", "CF-1.8");
        note(root, "title", title_);
        note(root, "comment", "time 2000-01-01 00:00:00 stands for the start of the run");
        const auto time = root.CreateDimension("time", GDAL_DIM_TYPE_TEMPORAL, "", moments_.size());
        const auto y = root.CreateDimension("y", GDAL_DIM_TYPE_HORIZONTAL_Y, "NORTH", GUInt64(grid.ny));
        const auto x = root.CreateDimension("x", GDAL_DIM_TYPE_HORIZONTAL_X, "EAST", GUInt64(grid.nx));
        if (!time || !y || !x) return false;
        std::vector<double> times;
        for (const Moment& moment : moments_) times.push_back(moment.time);
        if (!write_axis(root, time, times, "seconds since 2000-01-01 00:00:00", "T", "time") ||
            !write_axis(root, y, coordinates(grid.y0, grid.cell, grid.ny), "m", "Y", "projection_y_coordinate") ||
            !write_axis(root, x, coordinates(grid.x0, grid.cell, grid.nx), "m", "X", "projection_x_coordinate"))
            return false;
        const OGRSpatialReference crs = crs_wkt_.empty() ? OGRSpatialReference() : gdal::crs_from_wkt(crs_wkt_);
        const OGRSpatialReference* placed = crs.IsEmpty() ? nullptr : &crs;
        for (std::size_t v = 0; v < variables_.size(); ++v) {
            const auto field = make_field(root, {time, y, x}, variables_[v], placed);
            for (std::size_t t = 0; t < moments_.size(); ++t)
                if (!field || !write_plane(*field, Index(t), grid, plane(moments_[t], v, grid))) return false;
        }
        const bool changes = !moments_.empty() && moments_.back().bed_changes;
        if (changes && !write_change(root, {time, y, x}, grid, placed)) return false;
        return write_bed(root, {y, x}, last, placed, changes);
    }

    bool write_change(GDALGroup& root, const Dimensions& dimensions, const GridGeometry& grid,
                      const OGRSpatialReference* placed) const {
        const auto field = make_field(root, dimensions, kBedChange, placed);
        for (std::size_t t = 0; t < moments_.size(); ++t) {
            const auto all = placed_on(grid, moments_[t].grid, moments_[t].changed, moments_[t].change.data(),
                                       std::vector<float>(static_cast<std::size_t>(grid.size()), 0.0F));
            if (!field || !write_plane(*field, Index(t), grid, all)) return false;
        }
        return true;
    }

    static bool write_bed(GDALGroup& root, const Dimensions& dimensions, const Frame& last,
                          const OGRSpatialReference* placed, bool changes) {
        const Field* elevation = last.node("elevation");
        expect(elevation != nullptr, "a frame has the elevation of its nodes");
        std::vector<float> bed(static_cast<std::size_t>(last.grid.size()), kNothing);
        for (std::size_t k = 0; k < bed.size(); ++k)
            if (!std::isnan(elevation->data[k])) bed[k] = as_float(elevation->data[k], "elevation", last.status.time);
        const auto field = make_field(
            root, dimensions,
            {"elevation", "elevation", 0, "m",
             changes ? "bed as the flow has it at the last time: the mean of the elevation model around a node, and "
                       "changes so far where the flow follows them"
                     : "bed as the flow has it: the mean of the elevation model around a node"},
            placed);
        return field && write_plane(*field, 0, last.grid, bed);
    }

    /// A moment's values on the grid of the last frame, which holds those of all others.
    static std::vector<float> plane(const Moment& moment, std::size_t variable, const GridGeometry& grid) {
        return placed_on(grid, moment.grid, moment.nodes, moment.values.data() + variable * moment.nodes.size(),
                         std::vector<float>(static_cast<std::size_t>(grid.size()), kNothing));
    }

    /// Numbers of some nodes of a part, in place of those of the grid.
    static std::vector<float> placed_on(const GridGeometry& grid, const GridGeometry& part,
                                        const std::vector<Index>& nodes, const float* numbers,
                                        std::vector<float> values) {
        const NodeAt first = first_node(part, grid);
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const NodeAt node{nodes[k] % part.nx + first.i, nodes[k] / part.nx + first.j};
            if (has_node(grid, node)) values[static_cast<std::size_t>(node.j * grid.nx + node.i)] = numbers[k];
        }
        return values;
    }

    fs::path file_;
    std::string title_, crs_wkt_;
    std::vector<std::string>& warnings_;
    std::vector<Variable> variables_;
    bool tells_change_ = false;  ///< of the bed, where the run has one that changes
    GDALDriver* driver_ = nullptr;
    std::vector<Moment> moments_;
};

}  // namespace

std::unique_ptr<Observer> make_netcdf_writer(const fs::path& run_dir, const std::string& title,
                                             const std::string& crs_wkt, const std::vector<std::string>& fields,
                                             std::vector<std::string>& warnings) {
    return std::make_unique<NetcdfWriter>(run_dir, title, crs_wkt, fields, warnings);
}

}  // namespace frana
