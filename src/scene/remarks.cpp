#include "scene/remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "base/error.h"

namespace frana {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

}  // namespace

const std::vector<RemarkRow>& remark_table() {
    static const std::vector<RemarkRow> table = {
        {Remark::density_not_given, "density not given", none, none,
         "not given, so it is {value:.6g} kg/m3{what}; expected the density of the mass; give it"},
        {Remark::density, "density", 100.0, 4000.0,
         "found {value:.6g} kg/m3; expected {low:g} to {high:g}; check its unit"},
        {Remark::friction, "friction angle", 2.0, 60.0,
         "found a friction angle of {value:.3g} degrees; expected {low:g} to {high:g}; check whether an angle was "
         "given as "
         "mu, or the other way round"},
        {Remark::xi, "turbulence coefficient", 20.0, none,
         "found {value:.6g} m/s^2; expected {low:g} or more; check whether it is Voellmy's xi and in this unit"},
        {Remark::kind_range, "value outside of the kind", none, none,
         "found {value:.4g}; expected {what}, as in cases/PARAMETERS.md; check the value and its unit, or change "
         "case.kind"},
        {Remark::water_range, "friction of free water", none, none,
         "found {value:.4g}; expected {what}, as in cases/PARAMETERS.md; check the value and its unit"},
        {Remark::size_class, "size of a snow avalanche", none, none,
         "found {what}; expected the class of the {value:.6g} m3 that are released and come in; correct it, unless the "
         "friction of another size is meant"},
        {Remark::release_slope, "slope of the release", -none, 60.0,
         "found a bed of up to {value:.3g} degrees under it; expected {high:g} at most, since hardly any mass holds on "
         "steeper ground; check the outline and the elevation model there"},
        {Remark::release_depth, "depth of the release", -none, 100.0,
         "found a depth of up to {value:.4g} m; expected {high:g} m at most; check the unit of the depth, or the "
         "surface"},
        {Remark::release_speed, "speed of the release", -none, 150.0,
         "found a speed of {value:.4g} m/s; expected {high:g} m/s at most, since no landslide is faster; check the "
         "unit "
         "of the velocity"},
        {Remark::gravity, "gravity", 1.0, 30.0,
         "found {value:.4g} m/s^2; expected {low:g} to {high:g}; check its unit"},
        {Remark::rain, "rain", -none, 1e-4,
         "found up to {value:.3g} m/s; expected {high:g} m/s at most, which is 360 mm in an hour; check whether it was "
         "given in mm/h"},
        {Remark::detrainment, "detrainment of a forest", 5.0, 150.0,
         "found {value:.4g} Pa; expected {low:g} to {high:g} Pa, as in cases/PARAMETERS.md; check its unit"},
        {Remark::few_particles, "few particles", 100.0, none,
         "found {value:.0f} particles in all; expected {low:g} or more, since fewer do not resolve a flow; give a "
         "smaller grid.cell or more particles"},
        {Remark::depth_without_data, "depth without data", -none, 0.0,
         "found no data in {value:.0f} of {other:.0f} pixels, taken as no material; expected a depth in each; fill the "
         "gaps "
         "if material lies there"},
        {Remark::zero_margin, "margin filled with zeros", -none, 0.0,
         "found {value:.0f} nodes of exactly 0 m below cliffs of up to {other:.4g} m; expected no such steps; if 0 "
         "stands "
         "for no data there, run: gdal_translate -a_nodata 0 {what}"},
        {Remark::steep_as_in_feet, "heights in feet, by the slopes", -none, 33.0,
         "found {value:.3g} % of the terrain steeper than 60 degrees; expected {high:g} % at most; if the heights are "
         "feet, "
         "run: gdal_translate -ot Float32 -scale 0 1 0 0.3048 {what}"},
        {Remark::high_as_in_feet, "heights in feet, by the highest", -none, 8850.0,
         "found a height of {value:.6g} m; expected {high:g} m at most, since no mountain is higher; if the heights "
         "are "
         "feet, run: gdal_translate -ot Float32 -scale 0 1 0 0.3048 {what}"},
        {Remark::named_feet, "heights in feet, by name", none, none,
         "found \"{what}\" in its description; expected heights in metres, and they are taken as such; if they are "
         "feet, "
         "run: gdal_translate -ot Float32 -scale 0 1 0 0.3048 ..."},
        {Remark::walled_holes, "holes that are walls", -none, 0.0,
         "found {value:.0f} nodes without elevation in {other:.0f} hole(s) inside the terrain, the largest of {what}; "
         "they are "
         "walls; expected ground everywhere; fill them (gdal_fillnodata.py), or let mass leave there (boundary.holes = "
         "\"open\")"},
        {Remark::open_holes, "holes that are open", -none, 0.0,
         "found {value:.0f} nodes without elevation in {other:.0f} hole(s) inside the terrain, the largest of {what}; "
         "mass leaves "
         "there; expected ground everywhere; fill them (gdal_fillnodata.py)"},
    };
    return table;
}

void remark_on(std::vector<std::string>& log, Remark remark, const std::string& place, const Found& found) {
    const auto& table = remark_table();
    const auto row = std::find_if(table.begin(), table.end(), [&](const RemarkRow& r) { return r.remark == remark; });
    expect(row != table.end(), "a remark of the table");
    if (found.value >= row->low && found.value <= row->high) return;
    log.push_back(place + ": " +
                  fmt::format(fmt::runtime(row->text), fmt::arg("value", found.value), fmt::arg("low", row->low),
                              fmt::arg("high", row->high), fmt::arg("other", found.other),
                              fmt::arg("what", found.what)));
}

void join_remarks_on_coordinates(std::vector<std::string>& log) {
    struct Joined {
        std::vector<std::string> files;
        std::size_t place;
    };
    std::map<std::string, Joined> by_text;
    std::vector<std::string> kept;
    for (const std::string& remark : log) {
        const std::size_t colon = remark.find(": ");
        const std::string text = colon == std::string::npos ? "" : remark.substr(colon + 2);
        if (text.find("coordinates are taken as") == std::string::npos) {
            kept.push_back(remark);
            continue;
        }
        Joined& joined = by_text.try_emplace(text, Joined{{}, kept.size()}).first->second;
        if (joined.files.empty()) kept.push_back(remark);
        std::istringstream names(remark.substr(0, colon));  // of one that was joined before they are several
        for (std::string name; std::getline(names >> std::ws, name, ',');)
            if (std::find(joined.files.begin(), joined.files.end(), name) == joined.files.end())
                joined.files.push_back(name);
    }
    for (const auto& [text, joined] : by_text)
        kept[joined.place] = fmt::format("{}: {}", fmt::join(joined.files, ", "), text);
    log = std::move(kept);
}

}  // namespace frana
