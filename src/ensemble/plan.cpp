#include "ensemble/plan.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>

#include "base/error.h"
#include "ensemble/sensitivity.h"
#include "scene/parameters.h"
#include "scene/problems.h"

namespace frana {
namespace {

using Kind = Distribution::Kind;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr Index kMostSamples = 10'000'000;

struct Word {
    const char* name;
    Kind kind;
};
constexpr Word kKinds[] = {{"uniform", Kind::uniform},     {"loguniform", Kind::loguniform}, {"normal", Kind::normal},
                           {"lognormal", Kind::lognormal}, {"triangular", Kind::triangular}, {"beta", Kind::beta},
                           {"discrete", Kind::discrete}};

int line_in(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t k = 0; k < words.size(); ++k)
        text += (k == 0 ? "" : k + 1 < words.size() ? ", " : " or ") + words[k];
    return text;
}

/// Reads one table; every key that is not asked for is a problem.
class Table {
public:
    Table(const toml::table& table, std::string name, const std::filesystem::path& file, Problems& problems)
        : table_(table), name_(std::move(name)), file_(file), problems_(problems) {}

    void wrong(const std::string& key, const std::string& found, const std::string& expected,
               const std::string& way_out) const {
        const toml::node* node = table_.get(key);
        const int line = node ? line_in(*node) : line_in(table_);
        problems_.add(line, fmt::format("{}:{}: {}.{}", file_.string(), line, name_, key), found, expected, way_out);
    }
    bool given(const std::string& key) {
        asked_.insert(key);
        return table_.contains(key);
    }
    std::string text(const std::string& key, const std::string& otherwise = "") {
        if (!given(key)) return otherwise;
        if (const auto value = table_[key].value<std::string>()) return *value;
        wrong(key, "found no text", "expected a text", "write it between quotes");
        return otherwise;
    }
    double number(const std::string& key, double otherwise) {
        if (!given(key)) return otherwise;
        const auto value = table_[key].value<double>();
        if (value && std::isfinite(*value)) return *value;
        wrong(key, "found no number", "expected a finite number", "give one");
        return otherwise;
    }
    Index whole(const std::string& key, Index otherwise, Index least, Index most) {
        const double value = number(key, static_cast<double>(otherwise));
        if (value == std::floor(value) && value >= static_cast<double>(least) && value <= static_cast<double>(most))
            return static_cast<Index>(value);
        wrong(key, fmt::format("found {:g}", value), fmt::format("expected a whole number from {} to {}", least, most),
              "give one");
        return otherwise;
    }
    std::vector<double> numbers(const std::string& key) {
        std::vector<double> list;
        if (!given(key)) return list;
        if (const auto* array = table_[key].as_array())
            for (const toml::node& node : *array)
                if (const auto value = node.value<double>()) list.push_back(*value);
        const auto* array = table_[key].as_array();
        const bool good = array && list.size() == array->size() &&
                          std::all_of(list.begin(), list.end(), [](double x) { return std::isfinite(x); });
        if (!good) wrong(key, "found no list of numbers", "expected one like [0.1, 0.3]", "write it so");
        return good ? list : std::vector<double>{};
    }
    /// As a case file has them: texts keep their quotes.
    std::vector<std::string> values(const std::string& key) {
        std::vector<std::string> list;
        if (!given(key)) return list;
        if (const auto* array = table_[key].as_array())
            for (const toml::node& node : *array) {
                std::ostringstream text;
                if (const auto number = node.value_exact<double>())
                    text << fmt::format("{}", *number);
                else
                    node.visit([&](const auto& value) { text << value; });
                list.push_back(text.str());
            }
        if (list.empty())
            wrong(key, "found no list", "expected one like [\"a.geojson\", \"b.geojson\"]", "write it so");
        return list;
    }
    const toml::node* node(const std::string& key) { return given(key) ? table_.get(key) : nullptr; }
    void refuse_others(const std::string& when) const {
        const std::vector<std::string> known(asked_.begin(), asked_.end());
        for (const auto& [key, value] : table_) {
            const std::string name(key.str());
            if (asked_.count(name)) continue;
            const std::string near = closest(name, known);
            wrong(name, "found a key that is not used " + when, "expected one of " + listed(known),
                  near.empty() ? "remove it" : fmt::format("is {} meant?", near));
        }
    }

private:
    const toml::table& table_;
    std::string name_;
    const std::filesystem::path& file_;
    Problems& problems_;
    std::set<std::string> asked_;
};

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

private:
    void read_ensemble_table(const toml::table& of) {
        Table table(of, "ensemble", plan_.file, problems_);
        read_case(table);
        read_method(table);
        read_wishes(table);
        const toml::array* all = of["vary"].as_array();
        if (!table.given("vary") || !all || all->empty()) {
            table.wrong("vary", "found no [[ensemble.vary]]", "expected one or more", "name a key that varies");
        } else {
            for (std::size_t k = 0; k < all->size(); ++k)
                if (const toml::table* one = (*all)[k].as_table()) read_vary(*one, fmt::format("ensemble.vary.{}", k));
        }
        table.refuse_others("here");
    }

    void read_case(Table& table) {
        const std::string name = table.text("case");
        if (name.empty()) return table.wrong("case", "found none", "expected the case file's name", "give it");
        plan_.case_file = plan_.file.parent_path() / name;
        if (!std::filesystem::is_regular_file(plan_.case_file))
            table.wrong("case", fmt::format("found no file {}", plan_.case_file.string()), "expected a case file",
                        "correct the name; it is taken from the folder of this file");
    }

    void read_method(Table& table) {
        plan_.method_name = table.text("method", "lhs");
        const std::vector<std::string> names = {"lhs", "sobol", "random", "grid", "saltelli", "morris"};
        const auto found = std::find(names.begin(), names.end(), plan_.method_name);
        if (found == names.end())
            table.wrong("method", fmt::format("found \"{}\"", plan_.method_name), "expected " + listed(names),
                        "choose one");
        else
            plan_.method = static_cast<Method>(found - names.begin());
        if (plan_.method == Method::grid) return;
        if (!table.given("samples")) table.wrong("samples", "found none", "expected how many runs", "give a number");
        plan_.samples = table.whole("samples", 1, 1, kMostSamples);
        plan_.seed = static_cast<std::uint64_t>(table.whole("seed", 1, 0, Index{1} << 53));
    }

    void read_wishes(Table& table) {
        plan_.fields = {"peak_depth"};
        std::vector<std::string> known;
        for (const PeakField& field : peak_fields()) known.emplace_back(field.name);
        if (const toml::node* list = table.node("fields")) {
            for (std::string name : table.values("fields")) {
                name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c == '"' || c == '\''; }),
                           name.end());
                if (std::find(known.begin(), known.end(), name) == known.end())
                    table.wrong("fields", fmt::format("found \"{}\"", name), "expected " + listed(known),
                                "choose of these");
                else if (std::find(plan_.fields.begin(), plan_.fields.end(), name) == plan_.fields.end())
                    plan_.fields.push_back(name);
            }
            static_cast<void>(list);
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

    void read_exceed(Table& table) {
        const toml::node* node = table.node("exceed");
        if (!node) return;
        const toml::table* all = node->as_table();
        if (!all) return table.wrong("exceed", "found no table", "expected { peak_depth = [0.5, 2.0] }", "write it so");
        Table fields(*all, "ensemble.exceed", plan_.file, problems_);
        for (const std::string& field : plan_.fields)
            for (const double threshold : fields.numbers(field)) {
                if (threshold >= 0.0)
                    plan_.exceed[field].push_back(threshold);
                else
                    fields.wrong(field, fmt::format("found {:g}", threshold), "expected thresholds from 0 on",
                                 "give such");
            }
        fields.refuse_others("unless ensemble.fields names it");
    }

    void read_vary(const toml::table& of, const std::string& name) {
        Table table(of, name, plan_.file, problems_);
        Vary vary;
        vary.key = table.text("key");
        check_key(table, vary.key);
        const std::string kind = table.text("distribution", "uniform");
        const auto* found =
            std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Word& w) { return w.name == kind; });
        if (found == std::end(kKinds)) {
            std::vector<std::string> names;
            for (const Word& word : kKinds) names.emplace_back(word.name);
            return table.wrong("distribution", fmt::format("found \"{}\"", kind), "expected " + listed(names),
                               "choose one");
        }
        vary.distribution.kind = found->kind;
        if (found->kind == Kind::discrete)
            read_discrete(table, vary);
        else
            read_numbers(table, vary);
        if (plan_.method == Method::grid && found->kind != Kind::discrete)
            vary.levels = table.given("levels") ? table.whole("levels", 1, 1, kMostSamples) : 0;
        if (plan_.method == Method::grid && vary.levels == 0)
            table.wrong("levels", "found none", "expected how many values method \"grid\" takes of it",
                        "give a number");
        table.refuse_others(fmt::format("with distribution \"{}\" and method \"{}\"", kind, plan_.method_name));
        plan_.vary.push_back(std::move(vary));
    }

    void check_key(Table& table, const std::string& key) {
        const Parameter* parameter = find_parameter(key);
        if (!parameter) {
            std::vector<std::string> known;
            for (const Parameter& one : parameters()) known.push_back(one.key);
            const std::string near = closest(without_numbers(key), known);
            return table.wrong("key", fmt::format("found \"{}\"", key), "expected a key of a case file",
                               near.empty() ? "see `frana describe`" : fmt::format("is {} meant?", near));
        }
        for (const Vary& other : plan_.vary)
            if (other.key == key)
                table.wrong("key", fmt::format("found \"{}\" a second time", key), "expected each key once",
                            "remove one");
        for (const char* fixed : {"grid.", "terrain.", "output.", "survey.", "case."})
            if (key.rfind(fixed, 0) == 0)
                table.wrong("key", fmt::format("found \"{}\"", key), "expected a key of what flows",
                            "maps need one terrain and one grid for all runs");
    }

    void read_discrete(Table& table, Vary& vary) {
        Distribution& of = vary.distribution;
        of.values = table.values("values");
        of.weights = table.given("weights")
                         ? table.numbers("weights")
                         : std::vector<double>(of.values.size(), 1.0 / static_cast<double>(of.values.size()));
        vary.levels = static_cast<Index>(of.values.size());
        const double sum = std::accumulate(of.weights.begin(), of.weights.end(), 0.0);
        const bool good = std::all_of(of.weights.begin(), of.weights.end(), [](double w) { return w >= 0.0; });
        constexpr double round_off = 1e-9;
        if (of.weights.size() != of.values.size() || !good || !(std::abs(sum - 1.0) <= round_off))
            table.wrong("weights", fmt::format("found {} weights with the sum {:g}", of.weights.size(), sum),
                        fmt::format("expected {} of them from 0 on with the sum 1", of.values.size()), "give such");
    }

    void read_numbers(Table& table, Vary& vary) {
        Distribution& of = vary.distribution;
        const std::vector<double> range = table.numbers("range");
        const bool triangular = of.kind == Kind::triangular,
                   free = of.kind == Kind::normal || of.kind == Kind::lognormal;
        if (of.kind == Kind::normal) of.middle = table.number("mean", 0.0), of.spread = table.number("sd", 1.0);
        if (of.kind == Kind::lognormal)
            of.middle = table.number("median", 1.0), of.spread = table.number("factor", 2.0);
        if (of.kind == Kind::beta) of.alpha = table.number("alpha", 1.0), of.beta = table.number("beta", 1.0);
        of.low = free ? -kInfinite : 0.0, of.high = free ? kInfinite : 1.0;
        if (of.kind == Kind::lognormal) of.low = 0.0;
        if (!range.empty()) of.low = range.front(), of.high = range.back();
        if (triangular && range.size() == 3) of.middle = range[1];
        require_shape(table, of, range.size());
        if (problems_.empty()) require_in_range(table, vary);
    }

    void require_shape(Table& table, const Distribution& of, std::size_t given) {
        const bool triangular = of.kind == Kind::triangular,
                   free = of.kind == Kind::normal || of.kind == Kind::lognormal;
        const std::size_t wanted = triangular ? 3 : 2;
        if ((given != wanted && !(free && given == 0)) || !(of.low < of.high) ||
            (triangular && !(of.middle >= of.low && of.middle <= of.high)))
            table.wrong("range", "found no range, or one that does not grow",
                        triangular ? "expected [lowest, most likely, highest]" : "expected [lowest, highest]",
                        "write it so");
        const bool logarithmic = of.kind == Kind::loguniform || of.kind == Kind::lognormal;
        if (logarithmic && (!(of.low >= 0.0) || (of.kind == Kind::loguniform && of.low == 0.0)))
            table.wrong("range", fmt::format("found {:g}", of.low), "expected numbers above 0", "give such");
        if (of.kind == Kind::normal && !(of.spread > 0.0))
            table.wrong("sd", fmt::format("found {:g}", of.spread), "expected a number above 0", "give one");
        if (of.kind == Kind::lognormal && !(of.spread > 1.0 && of.middle > 0.0))
            table.wrong("factor", fmt::format("found median {:g} and factor {:g}", of.middle, of.spread),
                        "expected a median above 0 and a factor above 1", "give such");
        if (!(of.alpha > 0.0 && of.beta > 0.0))
            table.wrong("alpha", fmt::format("found alpha {:g} and beta {:g}", of.alpha, of.beta),
                        "expected numbers above 0", "give such");
    }

    /// What a case would refuse in some runs only is said before the first.
    void require_in_range(Table& table, const Vary& vary) {
        const Parameter* parameter = find_parameter(vary.key);
        if (!parameter || parameter->range.is_all()) return;
        const Distribution& of = vary.distribution;
        const Range& range = parameter->range;
        const bool inside = of.low >= range.low && of.high <= range.high;
        if (!inside)
            table.wrong("range", fmt::format("found values from {:g} to {:g}", of.low, of.high),
                        fmt::format("expected {} for {}", range.text(), vary.key),
                        "give a range within; it also cuts normal and lognormal");
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
            if (!grid || of.kind != Kind::discrete) {
                point.values.push_back(of.text(u[k]));
                continue;
            }
            const auto place = static_cast<std::size_t>(u[k] * static_cast<double>(of.values.size()));
            point.values.push_back(of.values[place]);
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
                                                  {"arrival_time", "s", "time of arrival"}};
    return fields;
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
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file))
        throw UserError(fmt::format(
            "{}: found no file that can be read; expected an ensemble in TOML; correct the name", file.string()));
    plan.text.assign(std::istreambuf_iterator<char>(stream), {});
    Problems problems;
    try {
        Reader(plan, problems).read(toml::parse(plan.text));
    } catch (const toml::parse_error& error) {  // the parser's way of saying it
        problems.add(fmt::format("{}:{}: TOML", file.string(), error.source().begin.line),
                     "found " + std::string(error.description()), "expected key = value", "correct this line");
    }
    problems.throw_if_any();
    place_samples(plan);
    return plan;
}

void add_exceedance(EnsemblePlan& plan, const std::string& argument) {
    const auto equals = argument.find('=');
    const std::string field = argument.substr(0, equals);
    char* end = nullptr;
    const std::string number = equals == std::string::npos ? "" : argument.substr(equals + 1);
    const double value = std::strtod(number.c_str(), &end);
    const bool known = std::find(plan.fields.begin(), plan.fields.end(), field) != plan.fields.end();
    if (!known || number.empty() || *end != '\0' || !(value >= 0.0 && std::isfinite(value)))
        throw UserError(
            fmt::format("--exceed: found \"{}\"; expected FIELD=VALUE with a number from 0 on and {}; "
                        "write it like peak_depth=1.3",
                        argument, listed(plan.fields)));
    plan.exceed[field].push_back(value);
}

}  // namespace frana
