#include "io/gdal_crs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "base/constants.h"
#include "base/error.h"
#include "base/shell_word.h"
#include "base/types.h"

namespace frana::gdal {
namespace {

constexpr double foot = 0.3048;              // [m]
constexpr double us_foot = 1200.0 / 3937.0;  // [m]
constexpr double unit_tolerance = 1e-9;      // a US survey foot differs from a foot by 2e-6
constexpr double any_foot = 1e-5;            // relative: many a declaration means one foot and says the other
constexpr double scale_tolerance = 0.01;     // UTM: 0.0004 in the middle of its zone, 0.001 at its edge

std::string authority(const OGRSpatialReference& crs) {
    const char* name = crs.GetAuthorityName(nullptr);
    const char* code = crs.GetAuthorityCode(nullptr);
    return name && code ? fmt::format("{}:{}", name, code) : std::string();
}

OGRSpatialReference horizontal(const OGRSpatialReference& crs) {
    OGRSpatialReference flat(crs);
    if (flat.IsCompound()) flat.StripVertical();
    if (flat.GetAxesCount() == 3) flat.DemoteTo2D(nullptr);
    flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return flat;
}

/// Metric CRS for the place, "EPSG:32632"; a placeholder where it cannot be told.
std::string metric_crs(const Place& place) {
    const Messages quiet;
    OGRSpatialReference degrees;
    degrees.importFromEPSG(4326);
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const OGRSpatialReference flat = horizontal(*place.crs);
    const Transformation to_degrees(OGRCreateCoordinateTransformation(&flat, &degrees));
    double lon = place.centre[0], lat = place.centre[1];
    if (!to_degrees || !to_degrees->Transform(1, &lon, &lat) || !std::isfinite(lon) || !std::isfinite(lat))
        return "EPSG:CODE_OF_A_METRIC_CRS";
    return fmt::format("EPSG:{}", utm_code(lon, lat));
}

struct Unit {
    double metres = 1.0;  ///< NaN: not known
    std::string name;
};

/// Words of a declaration: letters in lower case, digits, and signs that are not between words.
std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words(1);
    for (const unsigned char c : text) {
        const bool between = std::isspace(c) || std::strchr("_-.,;:()[]'", c) != nullptr;
        if (!between)
            words.back() += static_cast<char>(std::tolower(c));
        else if (!words.back().empty())
            words.emplace_back();
    }
    if (words.back().empty()) words.pop_back();
    return words;
}

/// "m", "metres", "m a.s.l.", "metres (EGM2008)": nothing but words follow, which may name a datum.
bool says_metres(const std::vector<std::string>& words) {
    static const std::set<std::string> metres{"m",   "metre", "metres", "meter", "meters", "mètre", "mètres",
                                              "mtr", "metro", "metros", "metri", "masl",   "mamsl"};
    return metres.count(words.front()) > 0 && std::all_of(words.begin() + 1, words.end(), [](const std::string& word) {
               return std::isalpha(static_cast<unsigned char>(word.front())) ||
                      static_cast<unsigned char>(word.front()) >= 0x80;
           });
}

/// The unit that a band declares. Nothing where it declares none; without a length where it is not known.
std::optional<Unit> band_unit(const Place& place) {
    const std::vector<std::string> words = words_of(place.band_unit);
    std::string unit;
    for (const std::string& word : words) unit += word;
    static const std::set<std::string> none{"", "unknown", "undefined", "unspecified", "none", "na", "n/a"};
    if (none.count(unit) > 0) return {};
    if (says_metres(words)) return Unit{1.0, place.band_unit};
    static const std::map<std::string, double> known = {{"ft", foot},
                                                        {"foot", foot},
                                                        {"feet", foot},
                                                        {"internationalfoot", foot},
                                                        {"internationalfeet", foot},
                                                        {"footinternational", foot},
                                                        {"feetinternational", foot},
                                                        {"ftint", foot},
                                                        {"ftintl", foot},
                                                        {"usft", us_foot},
                                                        {"ftus", us_foot},
                                                        {"usfoot", us_foot},
                                                        {"usfeet", us_foot},
                                                        {"footus", us_foot},
                                                        {"feetus", us_foot},
                                                        {"surveyfoot", us_foot},
                                                        {"surveyfeet", us_foot},
                                                        {"ussurveyfoot", us_foot},
                                                        {"ussurveyfeet", us_foot},
                                                        {"footussurvey", us_foot},
                                                        {"yd", 0.9144},
                                                        {"yard", 0.9144},
                                                        {"yards", 0.9144},
                                                        {"in", 0.0254},
                                                        {"inch", 0.0254},
                                                        {"inches", 0.0254},
                                                        {"km", 1000.0},
                                                        {"kilometre", 1000.0},
                                                        {"kilometres", 1000.0},
                                                        {"kilometer", 1000.0},
                                                        {"kilometers", 1000.0},
                                                        {"dm", 0.1},
                                                        {"decimetre", 0.1},
                                                        {"decimetres", 0.1},
                                                        {"decimeter", 0.1},
                                                        {"decimeters", 0.1},
                                                        {"cm", 0.01},
                                                        {"centimetre", 0.01},
                                                        {"centimetres", 0.01},
                                                        {"centimeter", 0.01},
                                                        {"centimeters", 0.01},
                                                        {"mm", 0.001},
                                                        {"millimetre", 0.001},
                                                        {"millimetres", 0.001},
                                                        {"millimeter", 0.001},
                                                        {"millimeters", 0.001}};
    const auto found = known.find(unit);
    return Unit{found == known.end() ? NAN : found->second, place.band_unit};
}

/// The unit of the vertical part of the CRS. Nothing where it has none.
std::optional<Unit> crs_unit(const Place& place) {
    if (!place.crs || !place.crs->IsCompound()) return {};
    const char* name = nullptr;
    const double metres = place.crs->GetTargetLinearUnits("VERT_CS", &name);
    return Unit{metres, name ? name : "unknown"};
}

bool is_metre(const std::optional<Unit>& unit) { return !unit || std::abs(unit->metres - 1.0) <= unit_tolerance; }

/// The declared unit of elevations. The vertical part of the CRS declares it, else the band.
std::optional<Unit> vertical_unit(const Place& place) {
    const std::optional<Unit> unit = crs_unit(place);
    return unit ? unit : band_unit(place);
}

bool contradict(const std::optional<Unit>& a, const std::optional<Unit>& b) {
    return a && b && !(std::abs(a->metres - b->metres) <= any_foot * b->metres);
}

/// Turns values into metres. The detour over a VRT drops the old unit, which gdal_translate alone would
/// carry on, and the vertical CRS. A scale and an offset of the stored numbers are applied before.
std::string scale_line(const Place& place, double metres) {
    std::string crs;
    if (place.crs && place.crs->IsCompound()) {
        const OGRSpatialReference flat = horizontal(*place.crs);
        crs = authority(flat);
        if (crs.empty()) {
            const Messages quiet;
            char* proj = nullptr;
            if (flat.exportToProj4(&proj) == OGRERR_NONE && proj) crs = proj;
            CPLFree(proj);
        }
        if (!crs.empty()) crs = "-a_srs " + shell_word(crs) + " ";
    }
    const std::string target = sibling(place.file, "_metres");
    const std::string between = std::filesystem::path(target).replace_extension(".vrt").string();
    std::string before, source = shell_word(place.file.string());
    if (place.scaled) {
        const std::filesystem::path name = sibling(place.file, "_unscaled");
        const std::string plain = shell_word(std::filesystem::path(name).replace_extension(".vrt").string());
        before = fmt::format("gdal_translate -of VRT -unscale -ot Float64 {} {} && ", source, plain), source = plain;
    }
    return fmt::format(
        "{}gdalbuildvrt {}{} {} && gdal_translate -ot Float32 -scale 0 1 0 {:.12g} -a_nodata -9999 "
        "{} {}",
        before, crs, shell_word(between), source, metres, shell_word(between), shell_word(target));
}

[[noreturn]] void refuse_unit(const Place& place, const char* what, const Unit& unit) {
    if (std::isnan(unit.metres))
        throw UserError(
            fmt::format("{}: its {} are declared in \"{}\", which is no length that is known here; expected metres; "
                        "where one is 0.5 m, for example, run: {}",
                        place.file.string(), what, unit.name, scale_line(place, 0.5)));
    throw UserError(fmt::format("{}: its {} are declared in {}; expected metres; run: {}", place.file.string(), what,
                                unit.name, scale_line(place, unit.metres)));
}

/// The band and the CRS declare the unit of elevations, and not the same.
[[noreturn]] void refuse_contradiction(const Place& place, const Unit& of_band, const Unit& of_crs) {
    const auto cure = [&](const Unit& unit) {
        if (std::isnan(unit.metres))
            return fmt::format("where one is 0.5 m, for example, run: {}", scale_line(place, 0.5));
        return fmt::format("where {} is true run: {}", unit.name, scale_line(place, unit.metres));
    };
    throw UserError(
        fmt::format("{}: its elevations are declared in \"{}\" by the band and in \"{}\" by the CRS; expected metres "
                    "alone; {}; {}",
                    place.file.string(), of_band.name, of_crs.name, cure(of_crs), cure(of_band)));
}

[[noreturn]] void refuse_plane(const Place& place, const std::string& found) {
    const std::optional<Unit> up = vertical_unit(place);
    const bool metres = is_metre(up) || std::isnan(up->metres);
    const std::filesystem::path input = metres ? place.file : std::filesystem::path(sibling(place.file, "_metres"));
    throw UserError(fmt::format(
        "{}: {}{}; expected a projected CRS in metres; run: {}{}{}", place.file.string(), found,
        metres ? "" : ", and its elevations are in " + up->name, metres ? "" : scale_line(place, up->metres) + " && ",
        warp_line(input, metric_crs(place), "_utm"), metres ? " (its elevations are taken as metres)" : ""));
}

/// Of a local CRS no program knows a way to metres. The numbers at the raster's corners do.
[[noreturn]] void refuse_local(const Place& place, const Unit& unit) {
    const std::string begin =
        "gdal_translate -a_srs " + shell_word("LOCAL_CS[\"metres\",UNIT[\"metre\",1]]") + " -a_ullr ";
    std::string corners = "XMIN YMAX XMAX YMIN";
    const Dataset raster(GDALDataset::Open(place.file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
    double t[6];
    if (raster && raster->GetGeoTransform(t) == CE_None) {
        const double m = unit.metres;
        corners =
            fmt::format("{:.12g} {:.12g} {:.12g} {:.12g}", m * t[0], m * t[3],
                        m * (t[0] + raster->GetRasterXSize() * t[1]), m * (t[3] + raster->GetRasterYSize() * t[5]));
    }
    throw UserError(
        fmt::format("{}: its local CRS is in {}; expected metres; run: {} {} {} (its elevations are taken "
                    "as metres)",
                    place.file.string(), unit.name, begin + corners, shell_word(place.file.string()),
                    shell_word(sibling(place.file, "_metres"))));
}

/// A map whose lengths are not those on the ground, such as Web Mercator's.
void require_true_lengths(const Place& place) {
    const auto scale = map_scale(*place.crs, place.centre);
    if (!scale) return;
    const auto [least, most] = *scale;
    if (least >= 1.0 - scale_tolerance && most <= 1.0 + scale_tolerance) return;
    const double worst = most - 1.0 > 1.0 - least ? most : least;
    refuse_plane(place,
                 fmt::format("its CRS is {}, in which 1 m on the ground is {:.4g} m on the map at {:.10g} {:.10g}",
                             crs_name(*place.crs), worst, place.centre[0], place.centre[1]));
}

}  // namespace

std::optional<std::array<double, 2>> map_scale(const OGRSpatialReference& crs, const std::array<double, 2>& place) {
    const Messages quiet;
    const OGRSpatialReference flat = horizontal(crs);
    OGRSpatialReference* cloned = flat.CloneGeogCS();
    if (!cloned) return {};
    cloned->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const Transformation to_degrees(OGRCreateCoordinateTransformation(&flat, cloned));
    const double a = cloned->GetSemiMajor(), inverse = cloned->GetInvFlattening();
    cloned->Release();
    constexpr double reach = 100.0;  // [m]; short against how the scale varies, long against round-off
    const double x = place[0], y = place[1];
    double lon[] = {x, x - reach, x + reach, x, x}, lat[] = {y, y, y, y - reach, y + reach};
    if (!to_degrees || !to_degrees->Transform(5, lon, lat)) return {};
    const double e2 = inverse > 0.0 ? (2.0 - 1.0 / inverse) / inverse : 0.0,
                 sine = std::sin(lat[0] * constants::kDegree);
    const double w2 = 1.0 - e2 * sine * sine;
    const double across = a / std::sqrt(w2) * std::cos(lat[0] * constants::kDegree);  // radius of the parallel
    const double along = a * (1.0 - e2) / (w2 * std::sqrt(w2));                       // of the meridian's curvature
    const auto ground = [&](int from, int to) -> Vec2 {
        const double degrees_east = std::remainder(lon[to] - lon[from], 360.0), degrees_north = lat[to] - lat[from];
        return Vec2(across * degrees_east, along * degrees_north) * (constants::kDegree / (2.0 * reach));
    };
    // The ellipse that a circle of the map is on the ground. Its half axes are the singular values of this matrix.
    const Vec2 east = ground(1, 2), north = ground(3, 4);
    const double sum = 0.5 * (east.squaredNorm() + north.squaredNorm());
    const double area = east.x() * north.y() - east.y() * north.x();
    const double spread = std::sqrt(std::max(0.0, sum * sum - area * area));
    if (!(sum - spread > 0.0) || !std::isfinite(sum)) return {};
    return std::array<double, 2>{1.0 / std::sqrt(sum + spread), 1.0 / std::sqrt(sum - spread)};
}

OGRSpatialReference crs_from_wkt(const std::string& wkt) {
    OGRSpatialReference crs;
    const Messages messages;
    if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
        throw UserError("\"" + wkt.substr(0, 60) + "\": not a coordinate reference system in WKT (" +
                        messages.reason("no reason given") + ")");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

std::string horizontal_wkt(const OGRSpatialReference& crs) {
    if (crs.IsEmpty() || crs.IsLocal()) return {};
    const char* const options[] = {"FORMAT=WKT2_2018", nullptr};
    char* text = nullptr;
    const Messages quiet;
    horizontal(crs).exportToWkt(&text, options);
    std::string wkt(text ? text : "");
    CPLFree(text);
    return wkt;
}

bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b) {
    const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                   "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
    const Messages quiet;
    const OGRSpatialReference flat_b = horizontal(b);
    return horizontal(a).IsSame(&flat_b, options);
}

std::string crs_name(const OGRSpatialReference& crs) {
    const std::string code = authority(crs);
    const char* name = crs.GetName();
    if (code.empty()) return name ? name : "unnamed CRS";
    return name ? fmt::format("{} ({})", code, name) : code;
}

int utm_code(double longitude, double latitude) {
    if (latitude > 84.0) return 32661;
    if (latitude < -80.0) return 32761;
    const int zone = 1 + static_cast<int>(std::floor((longitude + 180.0) / 6.0)) % 60;
    return (latitude < 0.0 ? 32700 : 32600) + (zone < 1 ? zone + 60 : zone);
}

void require_metres(const Place& place, std::vector<std::string>& log) {
    const std::string name = place.file.filename().string();
    if (!place.crs || place.crs->IsEmpty()) {
        log.push_back(name + ": no CRS; its coordinates are taken as local metres");
    } else if (place.crs->IsLocal()) {
        const char* unit = nullptr;
        const double metres = place.crs->GetLinearUnits(&unit);
        if (std::abs(metres - 1.0) > unit_tolerance)
            refuse_local(place, Unit{metres, unit ? unit : "a unit that is not the metre"});
        log.push_back(name + ": local CRS; its coordinates are taken as local metres");
    } else if (place.crs->IsGeographic() || place.crs->IsGeocentric() || !place.crs->IsProjected()) {
        refuse_plane(place, fmt::format("its CRS is {}, which is {}", crs_name(*place.crs),
                                        place.crs->IsGeographic() ? "geographic (degrees)" : "not a map"));
    } else {
        const char* unit = nullptr;
        const double metres = place.crs->GetLinearUnits(&unit);
        if (std::abs(metres - 1.0) > unit_tolerance)
            refuse_plane(place, fmt::format("its CRS is {}, whose unit is {}", crs_name(*place.crs),
                                            unit ? unit : "not the metre"));
        require_true_lengths(place);
    }
    if (const auto band = band_unit(place), up = crs_unit(place); contradict(band, up))
        refuse_contradiction(place, *band, *up);
    if (const auto up = vertical_unit(place); !is_metre(up)) refuse_unit(place, "elevations", *up);
}

void require_metre_values(const Place& place) {
    const std::optional<Unit> unit = band_unit(place);
    if (const auto declared = unit ? unit : crs_unit(place); !is_metre(declared))
        refuse_unit(place, "values", *declared);
}

std::string warp_line(const std::filesystem::path& file, const std::string& target_crs, const std::string& suffix) {
    return fmt::format("gdalwarp {}-r cubic -ot Float32 -dstnodata -9999 {} {}",
                       target_crs.empty() ? "" : "-t_srs " + target_crs + " ", shell_word(file.string()),
                       shell_word(sibling(file, suffix)));
}

}  // namespace frana::gdal
