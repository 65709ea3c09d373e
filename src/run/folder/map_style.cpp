#include "run/folder/map_style.h"

#include <fmt/core.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/number_text.h"
#include "vtk_io/figures/map_range.h"

namespace frana {
namespace {

bool is_elevation(const std::string& name) { return name == "elevation" || name == "final_elevation"; }

/// As the report's pictures have it.
Colormap colours_of(const std::string& name) {
    const bool is_signed = name == "bed_change" || name.find("velocity") != std::string::npos;
    return is_signed ? Colormap::diverging : Colormap::depth;
}

ColourRange range_of(const ProductRaster& product, const ProductRaster* peak_depth, double limit, Colormap map) {
    std::optional<std::pair<double, double>> given;
    if (product.name.find("damage") != std::string::npos) given = {0.0, 1.0};
    if (product.name == "bed_change")
        return colour_range(product.raster.values, 0.0, map, {}, Top::flow);  // where it changes
    const bool thick = product.unit == "m" && map != Colormap::diverging;     // shown where they are thick themselves
    if (thick)
        return colour_range(product.raster.values, limit, map, given,
                            product.name == "peak_depth" ? Top::flow : Top::percentile);
    const bool flow = peak_depth != nullptr && !is_friction(product.name) &&
                      peak_depth->raster.values.size() == product.raster.values.size();
    if (flow) return colours_within(product.raster.values, peak_depth->raster.values, limit, map, given);
    return colour_range(product.raster.values, kAll, map, given);
}

/// "2.5 m"; pictures and legends have kPa.
std::string label(double value, const std::string& unit) {
    const bool pascal = unit == "Pa";
    const double shown = pascal ? 1e-3 * value : value;
    const std::string number = std::abs(shown) >= 1e4 ? fmt::format("{:.0f}", shown) : fmt::format("{:.4g}", shown);
    return number + after_number(pascal ? "kPa" : unit);
}

std::string item(double value, const Colour& colour, const std::string& words) {
    return fmt::format("<item value=\"{:.9g}\" color=\"#{:02x}{:02x}{:02x}\" alpha=\"{}\" label=\"{}\"/>\n", value,
                       colour.r, colour.g, colour.b, colour.a, xml(words));
}

/// Six colours from the lowest to the highest; depths come out of nothing.
std::string items(const ColourRange& range, Colormap map, double fade_in, const std::string& unit) {
    constexpr int kSteps = 5;
    const auto share = [&](double value) { return (value - range.low) / (range.high - range.low); };
    std::string text;
    for (int k = 0; k <= kSteps; ++k) {
        const double value = range.low + k * (range.high - range.low) / kSteps;
        if (fade_in > 0.0 && value <= fade_in) continue;
        const bool last = k == kSteps && range.more_above, first = k == 0 && range.more_below;
        text += item(value, colour_at(map, share(value)),
                     label(value, unit) + (last    ? " and more"
                                           : first ? " and less"
                                                   : ""));
    }
    if (!(fade_in > 0.0)) return text;
    Colour clear = colour_at(map, share(fade_in));
    const std::string thin = item(fade_in, clear, label(fade_in, unit));
    clear.a = 0;
    return item(0.0, clear, label(0.0, unit)) + thin + text;
}

/// Elevations are resampled before they are lit: pixels that are seen large would be stairs.
std::string hillshade() {
    return "<pipe>\n<provider>\n<resampling enabled=\"true\" maxOversampling=\"2\" zoomedInResamplingMethod=\"cubic\" "
           "zoomedOutResamplingMethod=\"bilinear\"/>\n</provider>\n<rasterrenderer type=\"hillshade\" band=\"1\" "
           "opacity=\"1\" alphaBand=\"-1\" azimuth=\"315\" angle=\"45\" zfactor=\"1\" multidirection=\"1\"/>\n"
           "<resamplingStage>provider</resamplingStage>\n</pipe>\n";
}

std::string option(const char* name, const std::string& value) {
    return fmt::format("<Option type=\"QString\" name=\"{}\" value=\"{}\"/>", name, value);
}

}  // namespace

std::string xml(const std::string& text) {
    std::string escaped;
    for (const char c : text) switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            default:
                if (static_cast<unsigned char>(c) >= 0x20) escaped += c;  // XML 1.0 has no others
        }
    return escaped;
}

std::string raster_pipe(const ProductRaster& product, const ProductRaster* peak_depth, double limit) {
    if (is_elevation(product.name)) return hillshade();
    const Colormap map = colours_of(product.name);
    const ColourRange range = range_of(product, peak_depth, limit, map);
    const bool depth = product.unit == "m" && map != Colormap::diverging;
    return fmt::format(
        "<pipe>\n<rasterrenderer type=\"singlebandpseudocolor\" band=\"1\" opacity=\"0.8\" alphaBand=\"-1\" "
        "classificationMin=\"{0:.9g}\" classificationMax=\"{1:.9g}\">\n<rastershader>\n<colorrampshader "
        "colorRampType=\"INTERPOLATED\" classificationMode=\"1\" clip=\"0\" minimumValue=\"{0:.9g}\" "
        "maximumValue=\"{1:.9g}\">\n{2}<rampLegendSettings useContinuousLegend=\"0\"/>\n</colorrampshader>\n"
        "</rastershader>\n</rasterrenderer>\n</pipe>\n",
        range.low, range.high,
        items(range, map, depth && limit > 0.0 && limit < range.high ? limit : 0.0, product.unit));
}

std::string shape_renderer(Shapes shapes, const Colour& colour, double millimetres, bool dashed) {
    struct Words {
        const char *symbol, *layer, *colour, *width;
    };
    const Words words = shapes == Shapes::lines      ? Words{"line", "SimpleLine", "line_color", "line_width"}
                        : shapes == Shapes::outlines ? Words{"fill", "SimpleLine", "line_color", "line_width"}
                                                     : Words{"marker", "SimpleMarker", "color", "size"};
    return fmt::format(
        "<renderer-v2 type=\"singleSymbol\">\n<symbols>\n<symbol type=\"{}\" name=\"0\" alpha=\"1\">\n<layer "
        "class=\"{}\" enabled=\"1\" pass=\"0\" locked=\"0\">\n<Option type=\"Map\">{}{}{}{}</Option>\n</layer>\n"
        "</symbol>\n</symbols>\n</renderer-v2>\n",
        words.symbol, words.layer,
        option(words.colour, fmt::format("{},{},{},{}", colour.r, colour.g, colour.b, colour.a)),
        option(words.width, fmt::format("{:g}", millimetres)),
        option(shapes == Shapes::points ? "size_unit" : "line_width_unit", "MM"),
        dashed ? option("line_style", "dash") : std::string());
}

void write_styles(const std::filesystem::path& run_dir, const std::vector<ProductRaster>& rasters, double limit) {
    const ProductRaster* peak = find_product(rasters, "peak_depth");
    const auto write = [](const std::filesystem::path& file, const std::string& style) {
        write_text(file, "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22\">\n" +
                             style + "</qgis>\n");
    };
    for (const ProductRaster& product : rasters)
        write(run_dir / "rasters" / (product.name + ".qml"), raster_pipe(product, peak, limit));
    write(run_dir / "footprint.qml", shape_renderer(Shapes::outlines, colours::black, kOutline));
}

}  // namespace frana
