// The rules of a case that tie several keys together.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/layer_name.h"
#include "law/bed/laws.h"
#include "law/catalogue.h"
#include "law/detrainment.h"
#include "law/rheology/laws.h"
#include "law/water_friction.h"
#include "scene/case_reader.h"
#include "scene/combinations.h"
#include "scene/law_places.h"
#include "scene/salm_table.h"

namespace frana {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// "release.0." + "depth" for the parameter release.depth.
std::string concrete(const std::string& prefix, const std::string& key) { return prefix + find_parameter(key)->name(); }

/// The keys of a law's numbers, and those that a case's choice of the law uses, as zones name them.
struct ZoneKeys {
    std::string choice, chosen;
    std::vector<std::string> all, used;
};

template <class Any>
ZoneKeys keys_of(const CaseFile& file, const LawPlace& place) {
    ZoneKeys keys{place.choice, file.word(place.choice), {}, {}};
    for (const laws::SharedKey& key : laws::Catalogue<Any>::keys()) {
        keys.all.push_back(place.in_zone + key.name);
        if (contains(key.used_by, keys.chosen)) keys.used.push_back(keys.all.back());
    }
    return keys;
}

std::string keys_text(const std::vector<std::string>& keys) {
    std::string text;
    for (const std::string& key : keys) text += (text.empty() ? "" : ", ") + key;
    return text.empty() ? "none" : text;
}

std::vector<std::string> files_of(const Parameter& parameter, const Value& value) {
    if (!names_files(parameter.kind)) return {};
    if (const auto* one = std::get_if<std::string>(&value)) return {*one};
    if (const auto* several = std::get_if<std::vector<std::string>>(&value)) return *several;
    return {};
}

}  // namespace

int CaseReader::line_of(const std::string& key) const {
    const auto setting = case_.settings_.find(key);
    if (setting != case_.settings_.end() && setting->second.from_set) return Problems::no_line;
    const auto line = lines_.find(key);
    if (line != lines_.end()) return line->second;
    const auto table = case_.table_lines_.find(key.substr(0, key.rfind('.')));
    return table != case_.table_lines_.end() ? table->second : 1;
}

void CaseReader::wrong(const std::string& key, const std::string& found, const std::string& expected,
                       const std::string& way_out) {
    problems_.add(line_of(key), case_.place(key), found, expected, way_out);
}

void CaseReader::missing(const std::string& key, const Parameter& parameter, const std::string& why) {
    const bool repeated = contains(repeated_tables(), parameter.table());
    const std::string header = fmt::format(repeated ? "[[{}]]" : "[{}]", parameter.table());
    wrong(key, "not given" + why, fmt::format("expected {}, {}", parameter.expected(), parameter.meaning),
          fmt::format("add {} = ... under {}", parameter.name(), header));
}

void CaseReader::check_rules() {
    check_tables();
    for (const char* table : {"inflow", "profile", "gauge", "section", "barrier", "insitu", "camera"})
        check_line_names(table);
    check_something_flows();
    check_meaning();
    check_combinations();
}

/// Something has to be there, or to come: free water also by its level and as rain.
void CaseReader::check_sources() {
    for (const char* table : {"release", "inflow"})
        if (case_.count(table) > 0 || misread_.count(table)) return;
    const bool free = case_.word("water.model") == "free";
    for (const char* key : {"water.level", "water.rain"})
        if (free && (case_.given(key) || misread_.count(key))) return;
    problems_.add(1, place_of("release", 1), "not given",
                  free ? "expected at least one [[release]] or [[inflow]], or water.level or water.rain"
                       : "expected at least one [[release]] or [[inflow]], or free water with water.level",
                  "add [[release]] with outline and depth below");
}

void CaseReader::check_tables() {
    check_sources();
    std::set<std::string> done;
    for (const Parameter& parameter : parameters()) {
        const std::string table = parameter.table();
        if (!done.insert(table).second) continue;
        const bool repeated = contains(repeated_tables(), table);
        for (Index i = 0; i < (repeated ? case_.count(table) : 1); ++i) {
            const std::string prefix = table + "." + (repeated ? std::to_string(i) + "." : "");
            check_missing(prefix, table);
            check_alternatives(prefix, table);
            check_unused(prefix, table);
            if (table == "release") check_release(prefix);
            if (table == "barrier") check_barrier(prefix);
            if (table == "inflow") check_inflow(prefix);
            if (table == "material.zone") check_zone(prefix);
            if (table == "material.bed") check_friction_table();
            if (table == "survey") check_surveyed_bed();
            if (table == "forest") check_forest(), check_forest_speeds();
        }
    }
}

void CaseReader::check_missing(const std::string& prefix, const std::string& table) {
    for (const Parameter& parameter : parameters()) {
        if (parameter.table() != table) continue;
        const std::string key = concrete(prefix, parameter.key);
        const auto there = [&](const std::string& k) { return case_.given(k) || misread_.count(k) > 0; };
        if (there(key)) continue;
        if (parameter.required) missing(key, parameter, "");
        const std::string choice = parameter.required_by.empty() ? "" : parameter.switch_of(key);
        if (choice.empty() || misread_.count(choice) || !case_.has(choice)) continue;
        const std::string& chosen = case_.word(choice);
        if (!contains(parameter.required_by, chosen)) continue;
        if (table == "material.bed" && friction_table()) continue;  // it says mu and xi
        const std::string other = parameter.instead_of.empty() ? "" : concrete(prefix, parameter.instead_of);
        if (!other.empty() && (there(other) || other < key)) continue;  // of two ways, one complaint
        const std::string either = other.empty() ? "" : fmt::format(" (or {})", find_parameter(other)->name());
        missing(key, parameter, fmt::format(", but {} = \"{}\" needs it{}", parameter.switch_key, chosen, either));
    }
}

void CaseReader::check_alternatives(const std::string& prefix, const std::string& table) {
    for (const Parameter& parameter : parameters()) {
        if (parameter.table() != table || parameter.instead_of.empty()) continue;
        const std::string key = concrete(prefix, parameter.key);
        const std::string other = concrete(prefix, parameter.instead_of);
        if (other > key || !case_.given(key) || !case_.given(other)) continue;
        wrong(key, fmt::format("found together with {}", case_.place(other)), "expected only one of the two",
              "remove one of them");
    }
}

void CaseReader::check_unused(const std::string& prefix, const std::string& table) {
    for (const Parameter& parameter : parameters()) {
        if (parameter.table() != table || parameter.switch_key.empty()) continue;
        const std::string key = concrete(prefix, parameter.key);
        const std::string choice = parameter.switch_of(key);
        if (!case_.given(key) || misread_.count(choice) || !case_.has(choice)) continue;
        const std::string& chosen = case_.word(choice);
        if (contains(parameter.used_by, chosen)) continue;
        std::string users;
        for (const std::string& user : parameter.used_by) users += (users.empty() ? "" : " or ") + user;
        wrong(key, fmt::format("found, but {} = \"{}\" does not use it", parameter.switch_key, chosen),
              fmt::format("expected with {} only", users),
              fmt::format("remove it, or choose {}", parameter.switch_key));
    }
}

void CaseReader::check_release(const std::string& prefix) {
    check_layer(prefix);
    check_release_time(prefix);
    const auto there = [&](const char* name) {
        return case_.given(prefix + name) || misread_.count(prefix + name) > 0;
    };
    if (!there("depth") && !there("surface"))
        wrong(prefix + "depth", "not given, and no surface either",
              "expected the depth of the release [m] or its surface",
              "add depth = ... or surface = ... under [[release]]");
    if (there("depth") && case_.given(prefix + "depth") && case_.is_text(prefix + "depth") &&
        case_.word(prefix + "depth").rfind("field:", 0) == 0 && !there("outline"))
        wrong(prefix + "depth", "found an attribute without an outline", "expected the outline whose features have it",
              "give outline, or a number");
}

void CaseReader::check_release_time(const std::string& prefix) {
    const double at = case_.given(prefix + "at") ? case_.number(prefix + "at") : 0.0;
    if (case_.given("time.end") && at > 0.0 && at >= case_.number("time.end"))
        wrong(prefix + "at", fmt::format("found {:.6g} s", at),
              fmt::format("expected a time before time.end = {:.6g} s, or it never enters", case_.number("time.end")),
              "give an earlier time, or run longer");
}

/// Releases that wait for a flow need one.
void CaseReader::check_something_flows() {
    const Index count = case_.count("release");
    if (count == 0 || case_.count("inflow") > 0 || misread_.count("inflow") > 0) return;
    for (Index i = 0; i < count; ++i) {
        const std::string key = fmt::format("release.{}.when_hit", i);
        if (!case_.given(key) || !case_.flag(key)) return;
    }
    wrong("release.0.when_hit", "found true for every release, and no [[inflow]]",
          "expected something that flows by itself, to hit them", "remove when_hit from one of them");
}

void CaseReader::check_layer(const std::string& prefix) {
    if (!case_.given(prefix + "layer")) return;
    if (!case_.given(prefix + "outline"))
        wrong(prefix + "layer", "found without outline", "expected it with outline only", "remove it, or give outline");
    else if (!split_layer(case_.word(prefix + "outline")).layer.empty())
        wrong(prefix + "layer", "found, but outline names a layer as well", "expected one of the two",
              "remove " + kLayerMark + " from outline");
}

void CaseReader::check_barrier(const std::string& prefix) {
    const auto there = [&](const char* name) {
        return case_.given(prefix + name) || misread_.count(prefix + name) > 0;
    };
    // "left" is what resolved.toml writes for a case that says nothing
    const bool right = case_.given(prefix + "wet") && case_.word(prefix + "wet") == "right";
    const auto said = [&](const std::string& name) { return case_.given(prefix + name) && (name != "wet" || right); };
    if (case_.given(prefix + "each") && case_.flag(prefix + "each") && !there("outline"))
        wrong(prefix + "each", "found without outline", "expected it with outline only", "remove it");
    if (there("mesh")) {
        for (const char* name : {"outline", "line", "wet", "thickness", "height", "height_field", "top"})
            if (said(name))
                wrong(prefix + name, "found together with mesh",
                      "expected the mesh alone, which has its place and height", "remove one of them");
        return;
    }
    if (case_.given(prefix + "origin"))
        wrong(prefix + "origin", "found without mesh", "expected it with mesh only", "remove it");
    if (!there("outline") && !there("line"))
        wrong(prefix + "outline", "not given, and no line or mesh either", "expected where the barrier stands",
              "add outline = ..., line = ... or mesh = ... under [[barrier]]");
    check_height_field(prefix);
    if (!there("height") && !there("top") && !there("height_field"))
        wrong(prefix + "height", "not given, and no top either", "expected how high the barrier is [m]",
              "add height = ... or top = ... under [[barrier]]");
    if (there("line") || there("outline") == there("line")) return;
    for (const char* name : {"thickness", "wet"})
        if (said(name)) wrong(prefix + name, "found together with outline", "expected it with line only", "remove it");
}

/// Whether [material.bed] names a table; what else it says has been read or is misread.
bool CaseReader::friction_table() const {
    return case_.given("material.bed.table") && case_.word("material.bed.table") != "none";
}

/// A change of the bed is held against that of a bed which changes.
void CaseReader::check_surveyed_bed() {
    for (const char* law : {"erodible.law", "deposition.law"})
        if (misread_.count(law) || case_.word(law) != "none") return;
    if (misread_.count("forest.detrainment") || case_.given("forest.detrainment")) return;
    const std::string key = "survey.bed_change";
    if (case_.given(key))
        wrong(key, "found beside a bed that does not change", "expected [erodible], [deposition] or [forest] with it",
              "remove it, or add one of them");
}

/// What its other keys say is where, and of what flow, trees take something.
void CaseReader::check_forest() {
    if (case_.given("forest.detrainment") || misread_.count("forest.detrainment")) return;
    for (const char* key : {"forest.outline", "forest.max_speed", "forest.max_depth"})
        if (case_.given(key))
            wrong(key, "found without detrainment", "expected it with forest.detrainment only",
                  "add detrainment = ... [Pa] under [forest], or remove it");
}

/// Trees take nothing of flow slower than a least speed, so a limit below that leaves them nothing.
void CaseReader::check_forest_speeds() {
    const std::string key = "forest.max_speed";
    if (!case_.given(key) || misread_.count(key)) return;
    const double least = Detrainment().min_speed;
    if (case_.number(key) <= least)
        wrong(key, fmt::format("found {:.6g} m/s", case_.number(key)),
              fmt::format("expected more than {:.6g} m/s, since slower flow loses nothing to trees", least),
              "give a higher speed, or remove it");
}

/// What a table of friction needs.
void CaseReader::check_friction_table() {
    const std::string of = "material.bed.";
    if (!friction_table()) return;
    if (case_.count("inflow") > 0 && !case_.given(of + "volume_class") && !misread_.count(of + "volume_class"))
        wrong(of + "volume_class", "not given, and material comes in by [[inflow]]",
              "expected the size of the avalanche, which releases alone do not tell",
              "add volume_class = ... under [material.bed]");
    check_table_numbers();
}

void CaseReader::check_table_numbers() {
    const std::string of = "material.bed.";
    const auto grows = [&](const std::string& key) {
        if (misread_.count(key)) return;
        const std::vector<double>& limits = case_.numbers(key);
        for (std::size_t k = 1; k < limits.size(); ++k)
            if (!(limits[k] > limits[k - 1]))
                return wrong(key, fmt::format("found {:.6g} after {:.6g}", limits[k], limits[k - 1]),
                             "expected numbers that grow", "put them in order");
    };
    grows(of + "altitude_limits");
    grows(of + "curvature_limits");
    if (misread_.count(of + "return_period")) return;
    const double period = case_.number(of + "return_period");
    for (const double known : salm::return_periods)
        if (period == known) return;
    wrong(of + "return_period", fmt::format("found {:.6g}", period), "expected 10, 30, 100 or 300 years",
          "choose one of them; the table has no other");
}

void CaseReader::check_height_field(const std::string& prefix) {
    if (!case_.given(prefix + "height_field")) return;
    const std::string key = prefix + "height_field";
    if (!case_.given(prefix + "each") || !case_.flag(prefix + "each"))
        wrong(key, "found without each", "expected it with each = true: every polygon has a height of its own",
              "add each = true, or give height");
    for (const char* name : {"height", "top"})
        if (case_.given(prefix + name))
            wrong(key, fmt::format("found together with {}", name), "expected one of them", "remove one of them");
}

void CaseReader::check_inflow(const std::string& prefix) {
    const auto there = [&](const char* name) {
        return case_.given(prefix + name) || misread_.count(prefix + name) > 0;
    };
    if (!there("line") && !there("area"))
        wrong(prefix + "line", "not given, and no area either", "expected where the material comes in",
              "add line = ... or area = ... under [[inflow]]");
    for (const char* of_line : {"towards", "velocity"})
        if (case_.given(prefix + of_line) && there("area"))
            wrong(prefix + of_line, "found together with area",
                  "expected it with line only: over an area the material comes in at rest", "remove it");
    if (!there("table") && !there("volume"))
        wrong(prefix + "table", "not given, and no volume either",
              "expected the discharge over time, or its volume [m3]",
              "add table = ... or volume = ... under [[inflow]]");
    for (const char* of_volume : {"peak", "at", "rise"})
        if (case_.given(prefix + of_volume) && there("table"))
            wrong(prefix + of_volume, "found together with table", "expected it with volume only",
                  "remove one of them");
}

/// A zone has a place, and says something of the case's laws and of nothing else.
void CaseReader::check_zone(const std::string& prefix) {
    const auto there = [&](const std::string& name) {
        return case_.given(prefix + name) || misread_.count(prefix + name) > 0;
    };
    if (!there("outline") && !there("above") && !there("below"))
        wrong(prefix + "outline", "not given, and no above or below either", "expected where the zone is",
              "add outline = ..., above = ... or below = ... under [[material.zone]]");
    if (case_.given(prefix + "above") && case_.given(prefix + "below") &&
        case_.number(prefix + "above") >= case_.number(prefix + "below"))
        wrong(prefix + "above", fmt::format("found {:.6g}", case_.number(prefix + "above")),
              fmt::format("expected less than below = {:.6g}", case_.number(prefix + "below")), "correct one of them");
    std::vector<std::string> known;
    bool any = false;
    for (const LawPlace& place : kLawPlaces)
        if (misread_.count(place.choice)) return;
    for (const ZoneKeys& keys : {keys_of<BedLaw>(case_, kBedPlace), keys_of<Rheology>(case_, kRheologyPlace),
                                 keys_of<WaterLaw>(case_, kWaterPlace)}) {
        for (const std::string& key : keys.all) {
            any = any || there(key);
            if (!there(key) || contains(keys.used, key)) continue;
            wrong(prefix + key, fmt::format("found, but {} = \"{}\" does not use it", keys.choice, keys.chosen),
                  fmt::format("expected keys of that law: {}", keys_text(keys.used)),
                  fmt::format("remove it, or choose {}", keys.choice));
        }
        known.insert(known.end(), keys.used.begin(), keys.used.end());
    }
    if (!any)
        problems_.add(line_of(prefix), case_.table_place(prefix.substr(0, prefix.size() - 1)),
                      "found no number of a law in it",
                      fmt::format("expected keys of the case's laws: {}", keys_text(known)),
                      "add one of them, or remove the zone");
}

void CaseReader::check_line_names(const std::string& table) {
    std::map<std::string, std::string> seen;
    for (Index i = 0; i < case_.count(table); ++i) {
        const std::string key = fmt::format("{}.{}.name", table, i);
        if (!case_.given(key)) continue;
        const auto [first, is_new] = seen.emplace(case_.word(key), case_.place(key));
        if (!is_new)
            wrong(key, fmt::format("found \"{}\" again", first->first),
                  fmt::format("expected a name other than that at {}", first->second), "rename one of them");
    }
}

void CaseReader::check_meaning() {
    if (case_.given("terrain.window")) {
        const std::vector<double>& w = case_.numbers("terrain.window");
        if (w[0] >= w[2] || w[1] >= w[3])
            wrong("terrain.window", "found " + toml_text(w),
                  "expected [xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax",
                  "put the smaller coordinates first");
    }
    for (const laws::SharedKey& key : laws::Catalogue<BedLaw>::keys()) {
        const std::string name = "material.bed." + key.name, smaller = "material.bed." + key.more_than;
        const auto number = [&](const std::string& of) { return case_.given(of) && !case_.is_text(of); };
        if (!key.more_than.empty() && number(name) && number(smaller) && case_.number(name) <= case_.number(smaller))
            wrong(name, fmt::format("found {}", case_.number(name)),
                  fmt::format("expected more than {} = {}", key.more_than, case_.number(smaller)), key.way_out);
    }
}

/// Of two rows that complain of a key in the same words one is enough.
void CaseReader::check_combinations() {
    std::set<std::string> done;
    const auto unread = [&](const Values& values) { return misread_.count(values.key) > 0; };
    for (const Combination& row : combinations()) {
        if (unread(row.refused) || std::any_of(row.with.begin(), row.with.end(), unread)) continue;
        for (const std::string& key : row.found(case_)) {
            if (unused(key) || !done.insert(key + row.expected).second) continue;
            const std::string found = row.found_text(case_, key), first = key + ".0";
            if (row.refused.are != Values::Are::tables)
                wrong(key, found, row.expected, row.way_out);
            else
                problems_.add(line_of(first + "."), case_.table_place(first), found, row.expected, row.way_out);
        }
    }
}

/// Whether the case has chosen what does not use the key, which is complained of already.
bool CaseReader::unused(const std::string& key) const {
    const Parameter* parameter = find_parameter(key);
    if (!parameter || parameter->switch_key.empty()) return false;
    const std::string choice = parameter->switch_of(key);
    return misread_.count(choice) > 0 || !case_.has(choice) || !contains(parameter->used_by, case_.word(choice));
}

void CaseReader::check_files() {
    for (const auto& [key, setting] : case_.settings_) {
        for (const std::string& file : files_of(*find_parameter(key), setting.value)) {
            const std::filesystem::path path = case_.resolve(split_layer(file).file);
            // Names such as /vsizip/a.zip/dem.tif or NETCDF:a.nc:z are GDAL's own; only GDAL can find them.
            const bool virtual_name = file.rfind("/vsi", 0) == 0 || file.find(':') != std::string::npos;
            std::error_code unknown;
            const std::filesystem::file_status status = std::filesystem::status(path, unknown);
            if (std::filesystem::exists(status) && !is_regular_file(status) && !is_directory(status))
                wrong(key, fmt::format("found \"{}\", a pipe or a device", path.string()), "expected a file",
                      "copy what comes out of it into a file, and name that");
            if (virtual_name || std::filesystem::exists(status)) continue;
            wrong(key, fmt::format("found no file \"{}\"", path.string()), "expected an existing file",
                  "correct the name (it is relative to the case file), or put the file there");
        }
    }
}

}  // namespace frana
