#include "ensemble/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/number_text.h"
#include "base/text_file.h"
#include "ensemble/hazard_reader.h"
#include "ensemble/sample_table.h"
#include "ensemble/sensitivity.h"
#include "ensemble/toml_file.h"
#include "ensemble/vary_reader.h"
#include "ensemble/wanted_maps.h"
#include "scene/problems.h"

namespace frana {
namespace {

class Reader {
public:
    Reader(EnsemblePlan& plan, Problems& problems) : plan_(plan), problems_(problems) {}

    void read(const toml::table& root) {
        for (const auto& [key, value] : root)
            if (key.str() != "ensemble")
                problems_.add(line_in(value), fmt::format("{}:{}: {}", plan_.file.string(), line_in(value), key.str()),
                              "found this table", "expected [ensemble] alone",
                              "keys of the case stand in the case's own file");
        const toml::table* table = root["ensemble"].as_table();
        if (!table) {
            problems_.add(plan_.file.string(), "found no [ensemble]", "expected that table",
                          "see apps/README.md for an example");
            return;
        }
        read_ensemble_table(*table);
    }

    void read_maps(const toml::table& of, const std::string& name) {
        CheckedTable table(of, name, plan_.file, problems_);
        read_case(table);
        read_wishes(table);
        table.refuse_others("here");
    }

private:
    void read_ensemble_table(const toml::table& of) {
        CheckedTable table(of, "ensemble", plan_.file, problems_);
        read_case(table);
        read_method(table);
        read_wishes(table);
        const toml::array* all = of["vary"].as_array();
        if (plan_.method == Method::table) {
            read_hazard_table(table);
            table.refuse_others("with method \"table\"");
            return;
        }
        if (!table.given("vary") || !all || all->empty()) {
            table.wrong("vary", "found no [[ensemble.vary]]", "expected one or more", "name a key that varies");
        } else {
            plan_.vary = read_varied_keys(*all, "ensemble.vary",
                                          {plan_.file, plan_.method, plan_.method_name, word_of_case("case", "kind"),
                                           word_of_case("material", "bed", "law")},
                                          problems_);
        }
        read_hazard_table(table);
        table.refuse_others("here");
    }

    /// A text of the case, or "". What is wrong with the case its first run says.
    template <class... Keys>
    std::string word_of_case(const char* table, Keys... keys) const {
        try {
            const toml::table root = toml::parse_file(plan_.case_file.string());
            toml::node_view<const toml::node> node = root[table];
            ((node = node[keys]), ...);
            return node.value_or(std::string());
        } catch (const toml::parse_error&) {
            return "";
        }
    }

    void read_hazard_table(CheckedTable& table) {
        const auto scenarios = std::count_if(plan_.vary.begin(), plan_.vary.end(),
                                             [](const Vary& vary) { return !vary.return_periods.empty(); });
        const bool of_table = std::any_of(plan_.points.begin(), plan_.points.end(),
                                          [](const SamplePoint& point) { return point.return_period > 0.0; });
        if (scenarios > 1)
            table.wrong("vary", fmt::format("found return periods of {} keys", scenarios),
                        "expected those of one at most",
                        "give each scenario all that belongs to it by method \"table\"");
        const toml::node* node = table.node("hazard");
        if (!node) return;
        if (const toml::table* hazard = node->as_table())
            plan_.hazard = read_hazard(*hazard, plan_.file, plan_.fields, scenarios > 0 || of_table, problems_);
        else
            table.wrong("hazard", "found no table", "expected [ensemble.hazard]", "see apps/README.md for an example");
    }

    void read_case(CheckedTable& table) {
        const std::string name = table.text("case");
        if (name.empty()) return table.wrong("case", "found none", "expected the case file's name", "give it");
        plan_.case_file = plan_.file.parent_path() / name;
        if (!std::filesystem::is_regular_file(plan_.case_file))
            table.wrong("case", fmt::format("found no file {}", plan_.case_file.string()), "expected a case file",
                        "correct the name; it is taken from the folder of this file");
    }

    void read_method(CheckedTable& table) {
        plan_.method_name = table.text("method", "lhs");
        const std::vector<std::string> names = {"lhs", "sobol", "random", "grid", "saltelli", "morris", "table"};
        const auto found = std::find(names.begin(), names.end(), plan_.method_name);
        if (found == names.end())
            table.wrong("method", fmt::format("found \"{}\"", plan_.method_name), "expected " + listed(names),
                        "choose one");
        else
            plan_.method = static_cast<Method>(found - names.begin());
        if (plan_.method == Method::grid) return;
        if (plan_.method == Method::table) {
            const std::string name = table.text("table");
            if (name.empty()) return table.wrong("table", "found none", "expected a table's name", "give it");
            return read_sample_table(plan_.file.parent_path() / name, plan_, problems_);
        }
        if (!table.given("samples")) table.wrong("samples", "found none", "expected how many runs", "give a number");
        plan_.samples = table.whole("samples", 1, 1, kMostSamples);
        plan_.seed = static_cast<std::uint64_t>(table.whole("seed", 1, 0, Index{1} << 53));
    }

    void read_wishes(CheckedTable& table) {
        plan_.fields = {"peak_depth"};
        std::vector<std::string> known;
        for (const PeakField& field : peak_fields()) known.emplace_back(field.name);
        if (table.given("fields")) {
            for (std::string name : table.values("fields")) {
                name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c == '"' || c == '\''; }),
                           name.end());
                if (std::find(known.begin(), known.end(), name) == known.end())
                    table.wrong("fields", fmt::format("found \"{}\"", name), "expected " + listed(known),
                                "choose of these");
                else if (std::find(plan_.fields.begin(), plan_.fields.end(), name) == plan_.fields.end())
                    plan_.fields.push_back(name);
            }
        } else {
            plan_.fields = {"peak_depth", "peak_speed", "peak_dynamic_pressure"};
        }
        read_exceed(table);
        plan_.quantiles = table.numbers("quantiles");
        if (!table.given("quantiles")) plan_.quantiles = {0.05, 0.5, 0.95};
        for (const double q : plan_.quantiles)
            if (!(q > 0.0 && q < 1.0))
                table.wrong("quantiles", fmt::format("found {:g}", q), "expected numbers above 0 and below 1",
                            "give such");
    }

    void read_exceed(CheckedTable& table) {
        const toml::node* node = table.node("exceed");
        if (!node) return;
        const toml::table* all = node->as_table();
        if (!all) return table.wrong("exceed", "found no table", "expected { peak_depth = [0.5, 2.0] }", "write it so");
        CheckedTable fields(*all, table.name() + ".exceed", plan_.file, problems_);
        for (const std::string& field : plan_.fields)
            for (const double threshold : fields.numbers(field)) {
                if (field == "arrival_time")
                    fields.wrong(field, "found a threshold of a time", "expected fields that have peaks",
                                 "ensemble.quantiles are times by which a share of the runs has come");
                else if (threshold >= 0.0)
                    plan_.exceed[field].push_back(threshold);
                else
                    fields.wrong(field, fmt::format("found {:g}", threshold), "expected thresholds from 0 on",
                                 "give such");
            }
        fields.refuse_others("unless " + table.name() + ".fields names it");
    }

    EnsemblePlan& plan_;
    Problems& problems_;
};

void place_samples(EnsemblePlan& plan) {
    std::vector<Index> levels;
    double count = 1.0;
    for (const Vary& vary : plan.vary) levels.push_back(vary.levels), count *= static_cast<double>(vary.levels);
    const bool grid = plan.method == Method::grid;
    if (grid && count > static_cast<double>(kMostSamples))
        throw UserError(
            fmt::format("{}: ensemble.vary: found {:.3g} combinations; expected at most {}; give fewer levels",
                        plan.file.string(), count, kMostSamples));
    const auto keys = static_cast<Index>(plan.vary.size());
    const double runs = static_cast<double>(plan.samples) * static_cast<double>(runs_each(plan.method, keys));
    if (runs > static_cast<double>(kMostSamples))
        throw UserError(fmt::format("{}: ensemble.samples: found {:.3g} runs; expected at most {}; give fewer samples",
                                    plan.file.string(), runs, kMostSamples));
    Design& design = plan.design;
    if (grid)
        design = make_grid(levels);
    else if (plan.method == Method::saltelli || plan.method == Method::morris)
        design = make_sensitivity_design(plan.method, plan.samples, keys, plan.seed);
    else
        design = make_design(plan.method, plan.samples, keys, plan.seed);
    plan.samples = static_cast<Index>(design.points.size());
    for (const auto& u : design.points) {
        SamplePoint& point = plan.points.emplace_back();
        for (std::size_t k = 0; k < plan.vary.size(); ++k) {
            const Distribution& of = plan.vary[k].distribution;
            const std::vector<double>& years = plan.vary[k].return_periods;
            if (!grid || of.kind != Distribution::Kind::discrete) {
                point.values.push_back(of.text(u[k]));
                if (!years.empty()) point.return_period = years[of.choice(u[k])];
                continue;
            }
            const auto place = static_cast<std::size_t>(u[k] * static_cast<double>(of.values.size()));
            point.values.push_back(of.values[place]);
            if (!years.empty()) point.return_period = years[place];
            point.weight *= of.weights[place] * static_cast<double>(of.values.size());
        }
    }
}

}  // namespace

const std::vector<PeakField>& peak_fields() {
    static const std::vector<PeakField> fields = {{"peak_depth", "m", "peak depth"},
                                                  {"peak_speed", "m/s", "peak speed"},
                                                  {"peak_pressure", "Pa", "peak pressure on the bed"},
                                                  {"peak_dynamic_pressure", "Pa", "peak dynamic pressure"},
                                                  {"arrival_time", "s", "time of arrival", true},
                                                  {"eroded_depth", "m", "depth taken of the bed", false, true},
                                                  {"deposited_depth", "m", "depth left behind as bed", false, true},
                                                  {"bed_change", "m", "change of the bed, up", false, true}};
    return fields;
}

const PeakField& peak_field(const std::string& name) {
    for (const PeakField& field : peak_fields())
        if (name == field.name) return field;
    throw InternalError("internal error: a field without a meaning");
}

std::string shown_value(const std::string& value) {
    if (value.empty() || (value.front() != '"' && value.front() != '\'')) return value;
    try {
        return toml::parse("v = " + value)["v"].value_or(value);
    } catch (const toml::parse_error&) {  // a text that only begins so
        return value;
    }
}

std::vector<std::string> EnsemblePlan::sets_of(Index sample) const {
    std::vector<std::string> sets;
    for (std::size_t k = 0; k < vary.size(); ++k)
        sets.push_back(vary[k].key + "=" + points[static_cast<std::size_t>(sample)].values[k]);
    return sets;
}

EnsemblePlan read_ensemble(const std::filesystem::path& file) {
    EnsemblePlan plan;
    plan.file = file;
    Problems problems;
    read_toml(text_of_file(file), file, problems, [&](const toml::table& root) { Reader(plan, problems).read(root); });
    problems.throw_if_any();
    if (plan.method != Method::table) place_samples(plan);
    return plan;
}

void read_wanted_maps(const toml::table& of, const std::string& name, EnsemblePlan& plan, Problems& problems) {
    Reader(plan, problems).read_maps(of, name);
}

std::string ensemble_of_table(const EnsemblePlan& plan, const std::filesystem::path& table) {
    std::string text =
        fmt::format("[ensemble]\ncase = {}\nmethod = \"table\"\ntable = {}\n",
                    json_text(std::filesystem::absolute(plan.case_file).string()), json_text(table.string()));
    std::string fields, exceed;
    for (const std::string& field : plan.fields) fields += (fields.empty() ? "" : ", ") + json_text(field);
    for (const auto& [field, thresholds] : plan.exceed)
        exceed += fmt::format("{}{} = [{}]", exceed.empty() ? "" : ", ", field, fmt::join(thresholds, ", "));
    return text + fmt::format("fields = [{}]\nexceed = {{ {} }}\nquantiles = [{}]\n", fields, exceed,
                              fmt::join(plan.quantiles, ", "));
}

void add_exceedance(EnsemblePlan& plan, const std::string& argument) {
    const auto equals = argument.find('=');
    const std::string field = argument.substr(0, equals);
    const auto value = number_in(equals == std::string::npos ? "" : argument.substr(equals + 1));
    std::vector<std::string> fields = plan.fields;
    fields.erase(std::remove(fields.begin(), fields.end(), "arrival_time"), fields.end());
    if (field == "arrival_time" && fields.size() < plan.fields.size())
        throw UserError(fmt::format(
            "--exceed: found \"{}\"; expected FIELD=VALUE of {}, since a late arrival is no greater hazard; how likely "
            "the "
            "flow arrives at all is in rasters/probability_reached.tif, and when in the quantiles of arrival_time",
            argument, listed(fields)));
    const bool known = std::find(fields.begin(), fields.end(), field) != fields.end();
    if (!known || !value || !(*value >= 0.0 && std::isfinite(*value)))
        throw UserError(
            fmt::format("--exceed: found \"{}\"; expected FIELD=VALUE with a number from 0 on and {}; "
                        "write it like peak_depth=1.3",
                        argument, listed(fields)));
    plan.exceed[field].push_back(*value);
}

}  // namespace frana
