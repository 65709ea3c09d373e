#include "ensemble/hazard_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <functional>

namespace frana {
namespace {

constexpr const char* kTable = "ensemble.hazard";
constexpr std::size_t kMostClasses = 254;  ///< that a byte can hold besides "none" and nodata

class HazardReader {
public:
    HazardReader(const std::filesystem::path& file, const std::vector<std::string>& fields, Problems& problems)
        : file_(file), fields_(fields), problems_(problems) {}

    HazardTable read(const toml::table& of, bool scenarios) {
        CheckedTable table(of, kTable, file_, problems_);
        if (table.given("preset"))
            read_preset(table);
        else
            read_own(table, of);
        read_frequency(table, scenarios);
        table.refuse_others(table_.preset.empty() ? "here" : "with a preset");
        require_fields(table);
        return table_;
    }

private:
    void read_preset(CheckedTable& table) {
        const std::string name = table.text("preset");
        std::vector<std::string> names;
        for (const HazardTable& preset : hazard_presets()) {
            names.push_back(preset.preset);
            if (preset.preset == name) table_ = preset;
        }
        if (table_.preset.empty())
            table.wrong("preset", fmt::format("found \"{}\"", name), "expected " + listed(names),
                        "choose one, or give tables of your own");
    }

    void read_own(CheckedTable& table, const toml::table& of) {
        table_.years = table.numbers("years");
        const bool ascending =
            std::adjacent_find(table_.years.begin(), table_.years.end(), std::greater_equal<>()) == table_.years.end();
        if (table_.years.empty() || !ascending || !(table_.years.front() > 0.0))
            table.wrong("years", "found no return periods that grow", "expected a list like [30, 100, 300]",
                        "give it, or a preset");
        for_each_table(table, of, "class",
                       [&](const toml::table& one, const std::string& name) { read_class(one, name); });
        for_each_table(table, of, "level",
                       [&](const toml::table& one, const std::string& name) { read_level(one, name); });
    }

    template <class Body>
    void for_each_table(CheckedTable& table, const toml::table& of, const std::string& key, Body&& body) {
        const toml::array* all = table.given(key) ? of[key].as_array() : nullptr;
        if (!all || all->empty() || !all->is_homogeneous<toml::table>() || all->size() > kMostClasses)
            return table.wrong(key, fmt::format("found no [[{}.{}]]", kTable, key), "expected one or more",
                               "see apps/README.md for an example");
        for (std::size_t k = 0; k < all->size(); ++k)
            body(*(*all)[k].as_table(), fmt::format("{}.{}.{}", kTable, key, k));
    }

    void read_class(const toml::table& of, const std::string& name) {
        CheckedTable table(of, name, file_, problems_);
        HazardClass one;
        one.name = table.text("name");
        const bool again = std::any_of(table_.classes.begin(), table_.classes.end(),
                                       [&](const HazardClass& other) { return other.name == one.name; });
        if (one.name.empty() || one.name == kNone || again)
            table.wrong("name", fmt::format("found \"{}\"", one.name),
                        "expected a name of its own, other than \"none\"", "give one");
        const std::string colour = table.text("colour");
        const bool written_so =
            colour.size() == 7 && colour[0] == '#' &&
            std::all_of(colour.begin() + 1, colour.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
        const auto bits = written_so ? std::strtoul(colour.c_str() + 1, nullptr, 16) : 0;
        if (!written_so)
            table.wrong("colour", fmt::format("found \"{}\"", colour), "expected red, green and blue like \"#d81e28\"",
                        "write it so");
        for (std::size_t k = 0; k < 3; ++k) one.colour[k] = static_cast<std::uint8_t>((bits >> (8 * (2 - k))) & 0xffu);
        table.refuse_others("here");
        table_.classes.push_back(one);
    }

    void read_level(const toml::table& of, const std::string& name) {
        CheckedTable table(of, name, file_, problems_);
        HazardLevel level;
        level.name = table.text("name", fmt::format("level {}", table_.levels.size() + 1));
        for (const std::string& field : fields_) {
            if (field == "arrival_time" || !table.given(field)) continue;
            level.at_least[field] = table.number(field, 0.0);
            if (!(level.at_least[field] >= 0.0))
                table.wrong(field, fmt::format("found {:g}", level.at_least[field]), "expected a number from 0 on",
                            "give one");
        }
        std::vector<std::string> names = {kNone};
        for (const HazardClass& one : table_.classes) names.push_back(one.name);
        for (const std::string& quoted : table.values("classes")) {
            const std::string word = without_quotes(quoted);
            const auto found = std::find(names.begin(), names.end(), word);
            if (found == names.end())
                table.wrong("classes", fmt::format("found \"{}\"", word), "expected " + listed(names),
                            "choose of the classes");
            level.classes.push_back(static_cast<std::size_t>(found - names.begin()));
        }
        if (level.classes.size() != table_.years.size() + 1)
            table.wrong("classes", fmt::format("found {} of them", level.classes.size()),
                        fmt::format("expected {}: for each of the years, and for what comes back later",
                                    table_.years.size() + 1),
                        "give so many");
        table.refuse_others("unless ensemble.fields names it");
        for (const auto& [field, least] : level.at_least)
            for (const HazardLevel& weaker : table_.levels)
                if (const auto found = weaker.at_least.find(field);
                    found != weaker.at_least.end() && found->second > least)
                    table.wrong(field,
                                fmt::format("found {:g}, less than {:g} of \"{}\"", least, found->second, weaker.name),
                                "expected levels from the weakest to the strongest", "order them so");
        table_.levels.push_back(level);
    }

    void read_frequency(CheckedTable& table, bool scenarios) {
        table_.share = table.number("share", table_.share);
        if (!(table_.share > 0.0 && table_.share <= 1.0))
            table.wrong("share", fmt::format("found {:g}", table_.share), "expected a number above 0 and at most 1",
                        "give one");
        if (table.given("return_period")) table_.event_years = table.number("return_period", 1.0);
        if (table_.event_years && !(*table_.event_years > 0.0))
            table.wrong("return_period", fmt::format("found {:g}", *table_.event_years), "expected years above 0",
                        "give them");
        if (scenarios == table_.event_years.has_value())
            table.wrong("return_period",
                        scenarios ? "found it beside the return periods of scenarios"
                                  : "found neither it nor return periods of scenarios",
                        "expected one of both",
                        scenarios ? "remove it"
                                  : "give the return period of the event that all runs are of, or return_periods "
                                    "beside the values of a discrete key");
    }

    /// A preset does not depend on what is stored.
    void require_fields(const CheckedTable& table) {
        for (const HazardLevel& level : table_.levels)
            for (const auto& least : level.at_least)
                if (std::find(fields_.begin(), fields_.end(), least.first) == fields_.end())
                    table.wrong("preset", fmt::format("found it without {}", least.first),
                                fmt::format("expected {} among ensemble.fields", least.first), "add it there");
    }

    static std::string without_quotes(std::string text) {
        text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == '"' || c == '\''; }), text.end());
        return text;
    }

    static constexpr const char* kNone = "none";
    const std::filesystem::path& file_;
    const std::vector<std::string>& fields_;
    Problems& problems_;
    HazardTable table_;
};

}  // namespace

HazardTable read_hazard(const toml::table& table, const std::filesystem::path& file,
                        const std::vector<std::string>& fields, bool scenarios, Problems& problems) {
    return HazardReader(file, fields, problems).read(table, scenarios);
}

}  // namespace frana
