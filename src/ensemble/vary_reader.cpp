#include "ensemble/vary_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/number_text.h"
#include "scene/parameter_priors.h"
#include "scene/parameters.h"

namespace frana {
namespace {

using Kind = Distribution::Kind;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Word {
    const char* name;
    Kind kind;
};
constexpr Word kKinds[] = {{"uniform", Kind::uniform},     {"loguniform", Kind::loguniform}, {"normal", Kind::normal},
                           {"lognormal", Kind::lognormal}, {"triangular", Kind::triangular}, {"beta", Kind::beta},
                           {"discrete", Kind::discrete}};

class VaryReader {
public:
    VaryReader(const VaryContext& context, std::vector<Vary>& vary, Problems& problems)
        : file_(context.file),
          method_(context.method),
          method_name_(context.method_name),
          kind_(context.kind),
          bed_law_(context.bed_law),
          vary_(vary),
          problems_(problems) {}

    void read_vary(const toml::table& of, const std::string& name) {
        CheckedTable table(of, name, file_, problems_);
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
        else if (!table.given("distribution") && !table.given("range") && take_prior(vary))
            require_in_range(table, vary);
        else
            read_numbers(table, vary);
        if (method_ == Method::grid && found->kind != Kind::discrete)
            vary.levels = table.given("levels") ? table.whole("levels", 1, 1, kMostSamples) : 0;
        if (method_ == Method::grid && vary.levels == 0)
            table.wrong("levels", "found none", "expected how many values method \"grid\" takes of it",
                        "give a number");
        table.refuse_others(fmt::format("with distribution \"{}\" and method \"{}\"", kind, method_name_));
        vary_.push_back(std::move(vary));
    }

private:
    void check_key(CheckedTable& table, const std::string& key) {
        const KeyProblem problem = problem_of_key(key, vary_);
        if (!problem.found.empty()) table.wrong("key", problem.found, problem.expected, problem.way_out);
    }

    /// What is likely of the kind of mass; false: nothing is known.
    bool take_prior(Vary& vary) const {
        const std::optional<ParameterPrior> prior = kind_.empty() ? std::nullopt : prior_of(kind_, vary.key, bed_law_);
        if (!prior) return false;
        using Shape = ParameterPrior::Shape;
        Distribution& of = vary.distribution;
        of.low = prior->a, of.high = prior->b;
        if (prior->shape == Shape::triangular)
            of.kind = Kind::triangular, of.middle = prior->b, of.high = prior->c;
        else if (prior->shape == Shape::lognormal)
            of.kind = Kind::lognormal, of.middle = prior->a, of.spread = prior->b, of.low = 0.0, of.high = kInfinite;
        vary.prior =
            fmt::format("{}: without a range it has the prior of case.kind = \"{}\": {}; see cases/PARAMETERS.md",
                        vary.key, kind_, words_of(*prior, after_number(find_parameter(vary.key)->unit)));
        return true;
    }

    void read_discrete(CheckedTable& table, Vary& vary) {
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
        vary.return_periods = table.numbers("return_periods");
        const bool positive = std::all_of(vary.return_periods.begin(), vary.return_periods.end(),
                                          [](double years) { return years > 0.0; });
        if (table.given("return_periods") && (vary.return_periods.size() != of.values.size() || !positive))
            table.wrong("return_periods", fmt::format("found {} of them", vary.return_periods.size()),
                        fmt::format("expected {} numbers of years above 0", of.values.size()), "give such");
    }

    void read_numbers(CheckedTable& table, Vary& vary) {
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

    void require_shape(CheckedTable& table, const Distribution& of, std::size_t given) {
        const bool triangular = of.kind == Kind::triangular,
                   free = of.kind == Kind::normal || of.kind == Kind::lognormal;
        const std::size_t wanted = triangular ? 3 : 2;
        if ((given != wanted && !(free && given == 0)) || !(of.low < of.high) ||
            (triangular && !(of.middle >= of.low && of.middle <= of.high)))
            table.wrong("range", "found no range, or one that does not grow",
                        triangular ? "expected [lowest, most likely, highest]" : "expected [lowest, highest]",
                        kind_.empty() ? "write it so"
                                      : fmt::format("write it so; case.kind = \"{}\" has no prior of it", kind_));
        const bool logarithmic = of.kind == Kind::loguniform || of.kind == Kind::lognormal;
        if (logarithmic && (!(of.low >= 0.0) || (of.kind == Kind::loguniform && of.low == 0.0)))
            table.wrong("range", fmt::format("found {:g}", of.low), "expected numbers above 0", "give such");
        if (of.kind == Kind::normal && !(of.spread > 0.0))
            table.wrong("sd", fmt::format("found {:g}", of.spread), "expected a number above 0", "give one");
        if (of.kind == Kind::lognormal && !(of.spread > 1.0 && of.middle > 0.0))
            table.wrong("factor", fmt::format("found median {:g} and factor {:g}", of.middle, of.spread),
                        "expected a median above 0 and a factor above 1", "give such");
        constexpr double nothing = 1e-9;  // of the distribution
        const bool has_shape =
            of.kind == Kind::lognormal ? of.spread > 1.0 && of.middle > 0.0 : free && of.spread > 0.0;
        if (has_shape && of.low < of.high && !(of.share_between() > nothing))
            table.wrong("range", fmt::format("found {:g} to {:g}, far out in the distribution", of.low, of.high),
                        "expected a range that it is likely to lie in", "give another range, or another middle");
        if (!(of.alpha > 0.0 && of.beta > 0.0))
            table.wrong("alpha", fmt::format("found alpha {:g} and beta {:g}", of.alpha, of.beta),
                        "expected numbers above 0", "give such");
    }

    /// What a case would refuse in some runs only is said before the first.
    void require_in_range(CheckedTable& table, const Vary& vary) {
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

    const std::filesystem::path& file_;
    const Method method_;
    const std::string method_name_, kind_, bed_law_;
    std::vector<Vary>& vary_;
    Problems& problems_;
};

}  // namespace

KeyProblem problem_of_key(const std::string& key, const std::vector<Vary>& before) {
    if (!find_parameter(key)) {
        std::vector<std::string> known;
        for (const Parameter& one : parameters()) known.push_back(one.key);
        const std::string near = closest(without_numbers(key), known);
        return {fmt::format("found \"{}\"", key), "expected a key of a case file",
                near.empty() ? "see `frana describe`" : fmt::format("is {} meant?", near)};
    }
    for (const Vary& other : before)
        if (other.key == key)
            return {fmt::format("found \"{}\" a second time", key), "expected each key once", "remove one"};
    for (const char* fixed : {"grid.", "terrain.", "output.", "survey.", "case."})
        if (key.rfind(fixed, 0) == 0)
            return {fmt::format("found \"{}\"", key), "expected a key of what flows",
                    "maps need one terrain and one grid for all runs"};
    return {};
}

std::vector<Vary> read_varied_keys(const toml::array& array, const std::string& name, const VaryContext& context,
                                   Problems& problems) {
    std::vector<Vary> all;
    for (std::size_t k = 0; k < array.size(); ++k) {
        const std::string place = fmt::format("{}.{}", name, k);
        if (const toml::table* one = array[k].as_table())
            VaryReader(context, all, problems).read_vary(*one, place);
        else
            problems.add(context.file.string(), fmt::format("found {} that is no table", place),
                         fmt::format("expected [[{}]] tables", name), "see apps/README.md for an example");
    }
    return all;
}

}  // namespace frana
