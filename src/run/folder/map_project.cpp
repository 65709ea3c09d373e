#include "run/folder/map_project.h"

#include <fmt/core.h>

#include <algorithm>

#include "io/zip_file.h"
#include "run/folder/map_style.h"

namespace frana {
namespace {

/// A layer of the project.
struct MapLayer {
    std::string id, title;
    bool shown = false;
    std::string xml;  ///< its `<maplayer>`
};

struct MapGroup {
    std::string name;
    std::vector<MapLayer> layers;
};

/// How shapes are shown.
struct ShapeRule {
    const char *group, *layer, *title;
    Colour colour;
    bool shown, dashed = false;
};

// From the top.
constexpr ShapeRule kShapes[] = {
    {"Results", "footprint", "Footprint", colours::black, true},
    {"Results", "outlines", "Outlines of peak depth", colours::note, false},
    {"Input", "gauges", "Gauges", colours::black, true},
    {"Input", "barriers", "Barriers", {213, 94, 0}, true},
    {"Input", "sections", "Sections", {204, 121, 167}, true},
    {"Input", "inflow", "Inflows", {0, 158, 115}, true},
    {"Input", "inflow_areas", "Areas of inflows", {0, 158, 115}, true},
    {"Input", "profiles", "Profiles", {0, 114, 178}, true},
    {"Input", "release", "Release", colours::black, true, true},
    {"Survey", "survey", "Surveyed footprint", colours::survey, true},
};

struct RasterRule {
    const char *group, *name, *title;
    bool shown = false;
};

constexpr RasterRule kRasters[] = {
    {"Results", "peak_depth", "Peak depth", true},
    {"Results", "peak_speed", "Peak speed"},
    {"Results", "peak_dynamic_pressure", "Peak dynamic pressure"},
    {"Results", "peak_pressure", "Peak pressure on the bed"},
    {"Results", "arrival_time", "Arrival time"},
    {"Results", "lying_depth", "Depth at the end, with what became bed"},
    {"Results", "final_depth", "Depth at the end"},
    {"Results", "final_water_depth", "Free water at the end"},
    {"Results", "final_damage", "Damage at the end"},
    {"Results", "bed_change", "Change of the bed"},
    {"Results", "eroded_depth", "Eroded depth"},
    {"Results", "deposited_depth", "Deposited depth"},
    {"Input", "elevation", "Terrain", true},
};

std::string crs_xml(const char* element, const std::string& wkt) {
    if (wkt.empty()) return "";
    return fmt::format("<{0}>\n<spatialrefsys>\n<wkt>{1}</wkt>\n</spatialrefsys>\n</{0}>\n", element, xml(wkt));
}

std::string source_xml(const std::string& id, const std::string& title, const std::string& source,
                       const std::string& wkt) {
    return fmt::format("<id>{}</id>\n<datasource>{}</datasource>\n<layername>{}</layername>\n{}", xml(id), xml(source),
                       xml(title), crs_xml("srs", wkt));
}

MapLayer raster_layer(const RasterRule& rule, const ProductRaster& product, const ProductRaster* peak,
                      const MapProject& project) {
    const std::string unit = product.unit == "Pa" ? "kPa" : product.unit, id = fmt::format("raster_{}", rule.name);
    const bool bare = std::string(rule.name) == "elevation" || unit == "1";
    const std::string title = bare ? std::string(rule.title) : fmt::format("{} [{}]", rule.title, unit);
    return {id, title, rule.shown,
            "<maplayer type=\"raster\">\n" +
                source_xml(id, title, fmt::format("./rasters/{}.tif", rule.name), project.crs_wkt) +
                "<provider>gdal</provider>\n" + raster_pipe(product, peak, project.limit) + "</maplayer>\n"};
}

MapLayer shape_layer(const ShapeRule& rule, const ShapeLayer& layer, const MapProject& project) {
    struct Kind {
        const char* geometry;
        Shapes shapes;
        double millimetres;
    };
    constexpr Kind kinds[] = {{"Polygon", Shapes::outlines, kOutline},
                              {"Line", Shapes::lines, kOutline},
                              {"Point", Shapes::points, 2.5},
                              {"Polygon", Shapes::outlines, kOutline}};  // several of one row
    static_assert(std::size(kinds) == std::variant_size_v<decltype(AttributedShape::shape)>, "one for each kind");
    const Kind& kind = kinds[layer.shapes.front().shape.index()];
    const std::string id = fmt::format("shapes_{}", rule.layer);
    return {id, rule.title, rule.shown,
            fmt::format("<maplayer type=\"vector\" geometry=\"{}\">\n", kind.geometry) +
                source_xml(id, rule.title, fmt::format("./results.gpkg|layername={}", rule.layer), project.crs_wkt) +
                "<provider encoding=\"UTF-8\">ogr</provider>\n" +
                shape_renderer(kind.shapes, rule.colour, kind.millimetres, rule.dashed) + "</maplayer>\n"};
}

std::vector<MapGroup> groups_of(const MapProject& project, const std::vector<ProductRaster>& rasters,
                                const std::vector<ShapeLayer>& layers) {
    std::vector<MapGroup> groups{{"Results", {}}, {"Input", {}}, {"Survey", {}}};
    const auto group = [&](const std::string& name) -> MapGroup& {
        return *std::find_if(groups.begin(), groups.end(), [&](const MapGroup& g) { return g.name == name; });
    };
    for (const ShapeRule& rule : kShapes)
        for (const ShapeLayer& layer : layers)
            if (layer.name == rule.layer && !layer.shapes.empty())
                group(rule.group).layers.push_back(shape_layer(rule, layer, project));
    const ProductRaster* peak = find_product(rasters, "peak_depth");
    for (const RasterRule& rule : kRasters)
        if (const ProductRaster* product = find_product(rasters, rule.name))
            group(rule.group).layers.push_back(raster_layer(rule, *product, peak, project));
    groups.erase(std::remove_if(groups.begin(), groups.end(), [](const MapGroup& g) { return g.layers.empty(); }),
                 groups.end());
    return groups;
}

/// Shapes over rasters, the terrain under all, whatever group they are in.
std::string drawing_order(const std::vector<MapGroup>& groups) {
    std::string shapes, rasters, terrain;
    for (const MapGroup& group : groups)
        for (const MapLayer& layer : group.layers) {
            const bool is_shape = layer.id.rfind("shapes_", 0) == 0;
            std::string& part = is_shape ? shapes : layer.id == "raster_elevation" ? terrain : rasters;
            part += fmt::format("<item>{}</item>\n", layer.id);
        }
    return "<custom-order enabled=\"1\">\n" + shapes + rasters + terrain + "</custom-order>\n";
}

std::string tree(const std::vector<MapGroup>& groups) {
    std::string text = "<layer-tree-group>\n";
    for (const MapGroup& group : groups) {
        text += fmt::format("<layer-tree-group name=\"{}\" checked=\"Qt::Checked\" expanded=\"1\">\n", group.name);
        for (const MapLayer& layer : group.layers)
            text += fmt::format("<layer-tree-layer id=\"{}\" name=\"{}\" checked=\"{}\" expanded=\"{}\"/>\n", layer.id,
                                xml(layer.title), layer.shown ? "Qt::Checked" : "Qt::Unchecked", layer.shown ? 1 : 0);
        text += "</layer-tree-group>\n";
    }
    return text + drawing_order(groups) + "</layer-tree-group>\n";
}

std::string view(const MapProject& project) {
    const auto& e = project.extent;
    return fmt::format(
               "<mapcanvas name=\"theMapCanvas\">\n<units>meters</units>\n<extent>\n<xmin>{:.3f}</xmin>\n"
               "<ymin>{:.3f}</ymin>\n<xmax>{:.3f}</xmax>\n<ymax>{:.3f}</ymax>\n</extent>\n<rotation>0</rotation>\n",
               e[0], e[1], e[2], e[3]) +
           crs_xml("destinationsrs", project.crs_wkt) + "</mapcanvas>\n";
}

}  // namespace

void write_project(const std::filesystem::path& run_dir, const MapProject& project,
                   const std::vector<ProductRaster>& rasters, const std::vector<ShapeLayer>& layers) {
    const std::vector<MapGroup> groups = groups_of(project, rasters, layers);
    std::string text = fmt::format(
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22\" projectname=\"{0}\">\n"
        "<title>{0}</title>\n",
        xml(project.title));
    text += crs_xml("projectCrs", project.crs_wkt) + tree(groups) + view(project) + "<projectlayers>\n";
    for (const MapGroup& group : groups)
        for (const MapLayer& layer : group.layers) text += layer.xml;
    text +=
        "</projectlayers>\n<properties>\n<Paths>\n<Absolute "
        "type=\"bool\">false</Absolute>\n</Paths>\n<SpatialRefSys>\n<ProjectionsEnabled "
        "type=\"int\">1</ProjectionsEnabled>\n</SpatialRefSys>\n</properties>\n</qgis>\n";
    write_zip(run_dir / "run.qgz", "run.qgs", text);
}

}  // namespace frana
