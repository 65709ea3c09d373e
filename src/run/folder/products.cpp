#include "run/folder/products.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iterator>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/on_threads.h"
#include "base/version.h"
#include "compare/deposit.h"
#include "io/gdal_reader.h"
#include "io/gdal_writer.h"
#include "scene/law_places.h"
#include "scene/parameters.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

constexpr const char *kElevation = "elevation", *kFinalElevation = "final_elevation", *kMetres = "m";
constexpr const char* kForestKey = "forest.detrainment";
constexpr const char *kGroundAtEnd = "elevation of the bed at the end of the run", *kLying = "lying_depth",
                     *kLiesThere = "depth of what lies there at the end, flow and what has become bed, along gravity",
                     *kPeakOfBoth = "largest depth during the run, flow and what has become bed, along gravity";

/// Of a run with erodible.bed_evolves = false, together with a bed_change that is not 0.
constexpr const char* kGroundStayed =
    "elevation of the bed at the end of the run: that of the start, since erodible.bed_evolves is false; bed_change is "
    "not "
    "in it";

/// How a node field becomes a raster.
struct ProductRule {
    const char* name;
    const char* field;
    int component;
    const char* unit;
    const char* description;
    bool of_flow = true;  ///< zero where the flow never came
};

constexpr ProductRule rules[] = {
    {"peak_depth", "peak_depth", 0, "m", "largest depth during the run, along gravity"},
    {"peak_speed", "peak_speed", 0, "m/s", "largest speed during the run"},
    {"peak_pressure", "peak_pressure", 0, "Pa", "largest pressure on the bed during the run"},
    {"peak_dynamic_pressure", "peak_dynamic_pressure", 0, "Pa", "largest density * speed^2 during the run"},
    {"arrival_time", "arrival_time", 0, "s", "time when the flow first arrived", false},
    {"final_depth", "depth", 0, "m", "depth at the end of the run, along gravity"},
    {"final_velocity_x", "velocity", 0, "m/s", "velocity to the east at the end of the run"},
    {"final_velocity_y", "velocity", 1, "m/s", "velocity to the north at the end of the run"},
    {"eroded_depth", "eroded_depth", 0, "m", "depth of the original bed that the flow took, along gravity"},
    {"deposited_depth", "deposited_depth", 0, "m",
     "depth of what the flow left on the bed and lies there at the end, along gravity"},
    {kLying, "deposited_depth", 0, kMetres, kLiesThere},
    {"bed_change", "bed_change", 0, "m",
     "deposited depth less eroded depth, and less that of late releases that stood in the bed"},
    {kFinalElevation, kElevation, 0, kMetres, kGroundAtEnd, false},
    {"final_damage", "damage", 0, "1", "damage at the end of the run: 0 intact, 1 fragmented; where material lies",
     false},
    {"final_water_depth", "water_depth", 0, "m", "depth of free water at the end of the run, along gravity"},
};

Raster raster_of(const Frame& frame, const ProductRule& rule, const std::string& crs_wkt) {
    const Field* field = frame.node(rule.field);
    const Field* elevation = frame.node("elevation");
    expect(field != nullptr && elevation != nullptr && rule.component < field->components,
           "a frame has the node fields that the rasters show");
    Raster raster = Raster::filled(frame.grid, Raster::nodata);
    raster.crs_wkt = crs_wkt;
    raster.source = rule.name;
    const bool time = std::string(rule.field) == "arrival_time", inner = std::string(rule.field) == "damage";
    const Field *depth = frame.node("depth"), *water = frame.node("water_depth");
    const auto lies = [&](Index node) {  // depth is that of both, a sum
        return depth == nullptr || depth->data[node] - (water ? water->data[node] : 0.0) > 1e-9 * depth->data[node];
    };
    for (Index node = 0; node < frame.grid.size(); ++node) {
        const double value = field->data[node * field->components + rule.component];
        const bool never = (time && !(value >= 0.0)) || (inner && !lies(node));
        if (!std::isnan(elevation->data[node]) && !never) raster.values[static_cast<std::size_t>(node)] = value;
    }
    return raster;
}

/// Not every solver has it; all others must be there.
bool needed(const std::string& name) {
    for (const char* other : {"peak_dynamic_pressure", "final_damage", "final_water_depth", "eroded_depth",
                              "deposited_depth", "bed_change"})
        if (name == other) return false;
    return true;
}

bool is_of(const Frame& last, const ProductRule& rule) {
    const std::string name = rule.name;
    if (name == kFinalElevation) return false;  // a frame's bed is filtered: add_ground_at_end()
    if (name == kLying) return false;           // of two fields: add_lying_depth()
    return last.node(rule.field) != nullptr || needed(rule.name);
}

bool is_of_flow(const std::string& name) {
    const auto* rule = std::find_if(std::begin(rules), std::end(rules), [&](const auto& r) { return name == r.name; });
    return rule != std::end(rules) && rule->of_flow;
}

/// Nodata where the flow never came and the value says nothing.
Raster without_untouched(const Raster& raster, const Raster& peak_depth) {
    Raster left = raster;
    for (std::size_t k = 0; k < left.values.size(); ++k)
        if (left.values[k] == 0.0 && !(peak_depth.values[k] > 0.0)) left.values[k] = Raster::nodata;
    return left;
}

/// The other way. The terrain has the same pixels.
void with_untouched(Raster& raster, const Raster& elevation) {
    if (!(raster.geometry == elevation.geometry)) return;
    for (std::size_t k = 0; k < raster.values.size(); ++k)
        if (std::isnan(raster.values[k]) && !std::isnan(elevation.values[k])) raster.values[k] = 0.0;
}

FileTags tags_of(const std::string& title) {
    FileTags tags{{"TIFFTAG_SOFTWARE", std::string("frana ") + FRANA_VERSION}, {"TIFFTAG_DOCUMENTNAME", title}};
    const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");  // reproducible-builds.org
    if (epoch == nullptr) return tags;
    const std::time_t seconds = std::strtoll(epoch, nullptr, 10);
    tags["TIFFTAG_DATETIME"] = fmt::format("{:%Y:%m:%d %H:%M:%S}", fmt::gmtime(seconds));
    return tags;
}

fs::path raster_file(const fs::path& run_dir, const std::string& name) { return run_dir / "rasters" / (name + ".tif"); }

}  // namespace

void LastFields::end(const Frame& last) { into_ = product_rasters(last, crs_wkt_); }

std::vector<ProductRaster> product_rasters(const Frame& last, const std::string& crs_wkt) {
    std::vector<ProductRaster> rasters;
    for (const ProductRule& rule : rules)
        if (is_of(last, rule))
            rasters.push_back({rule.name, rule.unit, rule.description, raster_of(last, rule, crs_wkt)});
    return rasters;
}

void add_ground_at_end(std::vector<ProductRaster>& rasters, const Raster& bed, bool follows) {
    const ProductRaster* const change = find_product(rasters, "bed_change");
    if (change == nullptr) return;
    ProductRaster ground{kFinalElevation, kMetres, follows ? kGroundAtEnd : kGroundStayed, change->raster};
    ground.raster.source = kFinalElevation;
    std::vector<double>& z = ground.raster.values;  // its change so far
    expect(bed.values.size() == z.size(), "rasters and the bed that they show have the same nodes");
    for (std::size_t node = 0; node < z.size(); ++node)
        if (!std::isnan(z[node])) z[node] = bed.values[node] + (follows ? z[node] : 0.0);
    rasters.push_back(std::move(ground));
}

void add_lying_depth(std::vector<ProductRaster>& rasters) {
    const ProductRaster *flow = find_product(rasters, "final_depth"), *bed = find_product(rasters, "deposited_depth");
    if (flow == nullptr || bed == nullptr) return;
    ProductRaster lying{kLying, kMetres, kLiesThere, with_deposit(flow->raster, &bed->raster)};
    lying.raster.source = kLying;
    for (ProductRaster& raster : rasters)
        if (raster.name == "peak_depth") raster.description = kPeakOfBoth;
    rasters.push_back(std::move(lying));
}

const ProductRaster* find_lying(const std::vector<ProductRaster>& rasters) {
    const ProductRaster* const lying = find_product(rasters, kLying);
    return lying ? lying : find_product(rasters, "final_depth");
}

std::optional<Raster> ever_covered(const std::vector<ProductRaster>& rasters) {
    const ProductRaster *peak = find_product(rasters, "peak_depth"), *flow = find_product(rasters, "final_depth"),
                        *bed = find_product(rasters, "deposited_depth");
    if (peak == nullptr) return {};
    if (flow == nullptr || bed == nullptr) return peak->raster;
    return deepest_cover(peak->raster, with_deposit(flow->raster, &bed->raster));
}

/// "rheology_viscosity" of what zones call rheology.viscosity.
static std::string raster_name(std::string of_zone) {
    std::replace(of_zone.begin(), of_zone.end(), '.', '_');
    return of_zone;
}

/// A number of a law on the nodes, by its key in a case.
static std::vector<double> values_of(const Friction& friction, const std::string& key) {
    const auto of = [&](const LawPlace& place, const auto& map) {
        const std::size_t begins = std::string(place.table).size();
        return key.compare(0, begins, place.table) == 0 ? laws::parameter_on_nodes(map, key.substr(begins))
                                                        : std::vector<double>();
    };
    std::vector<double> values = of(kBedPlace, friction.laws);
    if (values.empty()) values = of(kRheologyPlace, friction.rheologies);
    return values.empty() ? of(kWaterPlace, friction.water) : values;
}

std::vector<ProductRaster> friction_rasters(const Friction& friction, const Raster& bed) {
    std::vector<ProductRaster> rasters;
    for (const std::string& name : friction.keys) {
        Raster raster = bed;
        const std::string key_name = key_of_zone_name(name), file = raster_name(name);
        raster.source = file;
        const std::vector<double> values = values_of(friction, key_name);
        for (std::size_t node = 0; node < values.size(); ++node)
            if (!std::isnan(raster.values[node])) raster.values[node] = values[node];
        const Parameter& key = *find_parameter(key_name);
        rasters.push_back({file, key.unit, key.meaning, std::move(raster)});
    }
    return rasters;
}

std::optional<ProductRaster> forest_raster(const Raster& pressure, const Raster& bed) {
    if (pressure.values.size() != bed.values.size()) return {};
    ProductRaster product{kForestRaster, find_parameter(kForestKey)->unit, find_parameter(kForestKey)->meaning, bed};
    product.raster.source = kForestRaster;
    double low = INFINITY, high = -INFINITY;
    for (std::size_t node = 0; node < pressure.values.size(); ++node) {
        if (std::isnan(bed.values[node])) continue;
        const double value = product.raster.values[node] = pressure.values[node];
        low = std::min(low, value), high = std::max(high, value);
    }
    if (!(low < high)) return {};
    return product;
}

std::vector<std::pair<std::string, const Parameter*>> friction_keys() {
    std::vector<std::pair<std::string, const Parameter*>> keys = {{kForestRaster, find_parameter(kForestKey)}};
    for (const LawPlace& place : kLawPlaces)
        for (const Parameter& key : parameters())
            if (key.switch_key == place.choice && key.kind == Kind::number_or_path)
                keys.emplace_back(raster_name(place.in_zone + key.name()), &key);
    return keys;
}

bool is_friction(const std::string& name) {
    const auto keys = friction_keys();
    return std::any_of(keys.begin(), keys.end(), [&](const auto& key) { return key.first == name; });
}

const ProductRaster* find_product(const std::vector<ProductRaster>& rasters, const std::string& name) {
    const auto found = std::find_if(rasters.begin(), rasters.end(),
                                    [&](const ProductRaster& product) { return product.name == name; });
    return found == rasters.end() ? nullptr : &*found;
}

double area_deeper(const Raster& depth, double limit) {
    const auto deeper = std::count_if(depth.values.begin(), depth.values.end(), [&](double h) { return h > limit; });
    return static_cast<double>(deeper) * depth.geometry.cell * depth.geometry.cell;
}

ProductRaster elevation_raster(const Raster& bed) {
    return {kElevation, "m", "elevation of the bed at the start of the run", bed};
}

Raster as_in_file(const ProductRaster& product, const std::vector<ProductRaster>& rasters) {
    const ProductRaster* peak = find_product(rasters, "peak_depth");
    return peak && is_of_flow(product.name) ? without_untouched(product.raster, peak->raster) : product.raster;
}

void write_rasters(const fs::path& run_dir, const std::vector<ProductRaster>& rasters, const std::string& title,
                   int threads) {
    fs::create_directories(run_dir / "rasters");
    const FileTags tags = tags_of(title);
    constexpr std::size_t kMany = 16'000'000;  // pixels; a raster that is being written is held three times
    const bool large = !rasters.empty() && rasters.front().raster.values.size() > kMany;
    for_each_on_threads(rasters.size(), large ? 1 : threads, [&](std::size_t k) {
        const ProductRaster& product = rasters[k];
        write_geotiff(raster_file(run_dir, product.name), as_in_file(product, rasters), product.unit,
                      product.description, tags);
    });
}

std::vector<ProductRaster> read_rasters(const fs::path& run_dir) {
    std::vector<ProductRaster> rasters;
    const GdalReader reader;
    const double far = 1e300;
    const auto read = [&](const std::string& name, const std::string& unit, const std::string& description) {
        const fs::path file = raster_file(run_dir, name);
        if (!fs::exists(file)) return;
        std::vector<std::string> log;
        rasters.push_back({name, unit, description, reader.read_raster(file, {-far, -far, far, far}, "", log)});
    };
    read(kElevation, "", "");
    const std::optional<Raster> elevation =
        rasters.empty() ? std::nullopt : std::optional<Raster>(std::move(rasters.front().raster));
    rasters.clear();
    for (const ProductRule& rule : rules) read(rule.name, rule.unit, rule.description);
    if (elevation)
        for (ProductRaster& product : rasters)
            if (is_of_flow(product.name)) with_untouched(product.raster, *elevation);
    for (const auto& [name, key] : friction_keys()) read(name, key->unit, key->meaning);
    return rasters;
}

void write_outline(const fs::path& run_dir, const Raster& covered, double limit) {
    write_footprint(run_dir / "footprint.geojson", covered, limit);
}

}  // namespace frana
