#include "run/web/web_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/version.h"
#include "io/deflate.h"
#include "run/web/resources.h"

namespace frana {
namespace {

using Json = nlohmann::ordered_json;

constexpr Index kMostTerrain = 500'000;      // nodes of the surface: more make no smoother picture
constexpr Index kMostOfPicture = 1'000'000;  // of a drape
constexpr std::size_t kMostPoints = 600;     // of a curve

/// The places of a page are told from the terrain's south-west node, to a thousandth of a cell.
class Places {
public:
    explicit Places(const GridGeometry& grid) : grid_(grid) {}
    double x(double map_x) const { return rounded(map_x - grid_.x0); }
    double y(double map_y) const { return rounded(map_y - grid_.y0); }
    /// x, y, x, y, ...
    Json line(const Polyline& line) const {
        Json flat = Json::array();
        for (const Vec2& p : line) flat.push_back(x(p.x())), flat.push_back(y(p.y()));
        return flat;
    }
    Json rings(const Polygons& polygons) const {
        Json list = Json::array();
        for (const Polygon& part : polygons.parts)
            for (const auto& ring : part.rings) list.push_back(line(ring));
        return list;
    }
    Json grid(const GridGeometry& g) const {
        return {{"nx", g.nx}, {"ny", g.ny}, {"x", x(g.x0)}, {"y", y(g.y0)}, {"cell", g.cell}};
    }

private:
    double rounded(double length) const {
        const double fine = 1e-3 * grid_.cell;
        const double digits = std::pow(10.0, std::ceil(-std::log10(fine)));
        return std::round(length * digits) / digits;
    }
    const GridGeometry& grid_;
};

Json raster_json(const Raster& raster, double finest, const Places& places) {
    const PackedRaster small = packed(raster, finest);
    Json json = places.grid(small.grid);
    json["low"] = small.low, json["step"] = small.step, json["values"] = base64(small.bytes);
    return json;
}

Json colours_json(Colormap map) {
    Json list = Json::array();
    constexpr int kSteps = 64;
    for (int k = 0; k <= kSteps; ++k) {
        const Colour c = colour_at(map, static_cast<double>(k) / kSteps);
        list.push_back({c.r, c.g, c.b});
    }
    return list;
}

Json drapes_json(const WebPage& page, const Places& places, std::vector<std::string>& notes) {
    Json list = Json::array();
    Index coarsest = 1;
    for (const PageDrape& drape : page.drapes) {
        const Raster whole = part_with_values(drape.raster);
        const Index k = block_for(whole.geometry, kMostOfPicture);
        coarsest = std::max(coarsest, k);
        Json json = raster_json(largest_in_blocks(whole, k), 1e-4 * (drape.high - drape.low), places);
        json["name"] = drape.name, json["label"] = drape.label, json["unit"] = drape.unit;
        json["from"] = drape.low, json["to"] = drape.high, json["above"] = drape.above, json["below"] = drape.below,
        json["colours"] = colours_json(drape.colours);
        list.push_back(json);
    }
    if (coarsest > 1)
        notes.push_back(
            fmt::format("Peaks are shown in blocks of {0} x {0} cells, each with its largest value.", coarsest));
    return list;
}

/// A raster whose rows are no places on the map.
Json table_json(const Raster& table, double finest) {
    const PackedRaster small = packed(table, finest);
    return {{"nx", small.grid.nx},
            {"ny", small.grid.ny},
            {"low", small.low},
            {"step", small.step},
            {"values", base64(small.bytes)}};
}

/// Of rasters that are packed a ten-thousandth of their largest value is known.
double fine_step(const Raster& raster) {
    double most = 0.0;
    for (const double value : raster.values)
        if (std::isfinite(value)) most = std::max(most, std::abs(value));
    return most > 0.0 ? 1e-4 * most : 1.0;
}

Json runs_json(const WebPage& page, const Places& places) {
    if (!page.runs) return nullptr;
    const PageRuns& runs = *page.runs;
    const double finest = runs.count > 0.0 && runs.count < 6e4 ? 1.0 / runs.count : 1e-4;
    Json json = {
        {"reached", raster_json(runs.reached, finest, places)},
        {"effective", runs.effective},
        {"failed_share", runs.failed_share},
        {"shown_above", runs.shown_above},
        {"start", Json()},
        {"shares", runs.shares},
        {"probability", {{"from", 0.0}, {"to", 100.0}, {"unit", "%"}, {"colours", colours_json(Colormap::depth)}}},
        {"ladders", Json::array()}};
    if (runs.start) json["start"] = {places.x(runs.start->x()), places.y(runs.start->y())};
    for (const PageLadder& ladder : runs.ladders)
        json["ladders"].push_back({{"name", ladder.name},
                                   {"label", ladder.label},
                                   {"unit", ladder.unit},
                                   {"thresholds", ladder.thresholds},
                                   {"first", ladder.first},
                                   {"probabilities", table_json(ladder.probabilities, finest)},
                                   {"quantiles", table_json(ladder.quantiles, fine_step(ladder.quantiles))}});
    return json;
}

Json top_json(const PageTop& top, Colormap colours) {
    return {{"from", 0.0}, {"to", top.high}, {"above", top.above}, {"colours", colours_json(colours)}};
}

Json frames_json(const WebPage& page, const Places& places, std::vector<std::string>& notes) {
    Json list = Json::array();
    if (page.frames == nullptr) return list;
    double coarsest = 1.0;
    for (const PackedFrame& frame : page.frames->frames()) {
        Json json = {{"t", frame.time}};
        if (frame.grid.size() > 0) {
            coarsest = std::max(coarsest, frame.grid.cell / page.bed.geometry.cell);
            json["grid"] = places.grid(frame.grid);
            json["deepest"] = frame.deepest, json["values"] = base64(frame.bytes);
            if (frame.has_speed) json["fastest"] = frame.fastest;
        }
        list.push_back(json);
    }
    if (page.frames->every() > 1)
        notes.push_back(
            fmt::format("One in {} outputs is shown; all of them would make too large a page.", page.frames->every()));
    if (coarsest > 1.0)
        notes.push_back(
            fmt::format("Where the flow is wide it is shown in blocks of up to {0:.0f} x {0:.0f} cells, each with its "
                        "largest value.",
                        coarsest));
    return list;
}

Json barriers_json(const WebPage& page, const Places& places) {
    Json list = Json::array();
    for (const PageBarrier& barrier : page.barriers) {
        Json json = {{"name", barrier.name}};
        if (barrier.mesh) {
            Json points = Json::array(), corners = Json::array();
            for (const Vec3& p : barrier.mesh->points)
                points.push_back(places.x(p.x())), points.push_back(places.y(p.y())), points.push_back(p.z());
            for (const auto& triangle : barrier.mesh->triangles)
                for (const Index corner : triangle) corners.push_back(corner);
            json["points"] = points, json["corners"] = corners;
        } else {
            json["polygons"] = Json::array();
            for (const Polygon& part : barrier.outline.parts)
                json["polygons"].push_back(places.rings(Polygons{{part}, "", ""}));
            if (!barrier.line.empty()) json["line"] = places.line(barrier.line);
            if (barrier.level) json["level"] = *barrier.level;
            json["height"] = barrier.height;
        }
        list.push_back(json);
    }
    return list;
}

Json curves_json(const PageCurves& curves) {
    const std::size_t stride = curves.time.size() / kMostPoints + 1;
    Json time = Json::array(), runout = Json::array(), volume = Json::array();
    for (std::size_t k = 0; k < curves.time.size(); ++k) {
        if (k % stride != 0 && k + 1 != curves.time.size()) continue;
        const auto short_number = [](double value) {  // whatever language the process speaks
            const std::string text = fmt::format("{:.7g}", value);
            std::from_chars(text.data(), text.data() + text.size(), value);
            return value;
        };
        time.push_back(short_number(curves.time[k]));
        runout.push_back(short_number(curves.runout[k]));
        volume.push_back(short_number(curves.volume[k]));
    }
    return {{"time", time},
            {"runout", runout},
            {"volume", volume},
            {"runout_name", curves.runout_name},
            {"volume_name", curves.volume_name}};
}

Json terrain_json(const WebPage& page, const Places& places, std::vector<std::string>& notes) {
    const Index k = block_for(page.bed.geometry, kMostTerrain);
    if (k > 1)
        notes.push_back(fmt::format("The terrain is shown in blocks of {0} x {0} cells, each with its mean.", k));
    return raster_json(in_blocks(page.bed, k), 1e-3 * page.bed.geometry.cell, places);
}

Json data_json(const WebPage& page) {
    const Places places(page.bed.geometry);
    std::vector<std::string> notes = page.remarks;
    Json json = {{"title", page.title},
                 {"caption", page.caption},
                 {"version", FRANA_VERSION},
                 {"origin", {page.bed.geometry.x0, page.bed.geometry.y0}},
                 {"footprint_depth", page.footprint_depth},
                 {"terrain", terrain_json(page, places, notes)},
                 {"frames", frames_json(page, places, notes)},
                 {"drapes", drapes_json(page, places, notes)},
                 {"depth", top_json(page.depth, Colormap::depth)},
                 {"speed", top_json(page.speed, Colormap::speed)},
                 {"runs", runs_json(page, places)},
                 {"survey", page.survey ? places.rings(*page.survey) : Json::array()},
                 {"lines", Json::array()},
                 {"gauges", Json::array()},
                 {"barriers", barriers_json(page, places)},
                 {"curves", curves_json(page.curves)},
                 {"facts", page.facts},
                 {"notes", notes}};
    for (const PageLine& line : page.lines)
        json["lines"].push_back({{"name", line.name}, {"line", places.line(line.line)}});
    for (const PagePlace& gauge : page.gauges)
        json["gauges"].push_back(
            {{"name", gauge.name}, {"x", places.x(gauge.point.x())}, {"y", places.y(gauge.point.y())}});
    return json;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Nothing in it ends a script, opens a tag or is beyond ASCII.
std::string script_safe(const Json& json) {
    std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    replace_all(text, "<", "\\u003c");
    return text;
}

/// A text between tags, in UTF-8.
std::string html_safe(const std::string& text) {
    std::string safe;
    // JSON's writer can replace what is no UTF-8.
    const std::string valid = Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
    for (const char c : valid)
        safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
    return safe;
}

/// As browsers unpack it: a third of its size.
std::string three_small() {
    const std::string three = page_resources().three;
    return base64(deflated({three.begin(), three.end()}));
}

/// Puts each text in its place of the frame; what a text itself holds is left as it is.
std::string filled(const std::string& frame, const std::vector<std::pair<std::string, std::string>>& texts) {
    std::string page;
    std::size_t done = 0;
    for (std::size_t open = frame.find("{{"); open != std::string::npos; open = frame.find("{{", done)) {
        const std::size_t close = frame.find("}}", open);
        const std::string name = frame.substr(open + 2, close - open - 2);
        const auto text = std::find_if(texts.begin(), texts.end(), [&](const auto& t) { return t.first == name; });
        expect(text != texts.end(), "the page's frame has places for what there is");
        page += frame.substr(done, open - done) + text->second;
        done = close + 2;
    }
    return page + frame.substr(done);
}

}  // namespace

std::string no_page_reason() {
    if (*page_resources().three != '\0') return "";
    return "this build of frana has no three.js, which shows pages; install the package libjs-three and build again, "
           "or "
           "leave \"web\" out";
}

std::string web_page(const WebPage& page) {
    const PageResources& parts = page_resources();
    return filled(parts.frame, {{"TITLE", html_safe(page.title)},
                                {"STYLE", parts.style},
                                {"THREE", three_small()},
                                {"DATA", script_safe(data_json(page))},
                                {"SCRIPT", parts.script}});
}

}  // namespace frana
