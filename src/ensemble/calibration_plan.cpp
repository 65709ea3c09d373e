#include "ensemble/calibration_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "ensemble/toml_file.h"
#include "ensemble/vary_reader.h"
#include "ensemble/wanted_maps.h"

namespace frana {
namespace {

constexpr Index kMostPoints = 5000;  ///< each point's weight needs all others, in each round

class CalibrationReader {
public:
    CalibrationReader(CalibrationPlan& plan, Problems& problems) : plan_(plan), problems_(problems) {}

    void read(const toml::table& root) {
        CheckedTable file(root, "file", plan_.file, problems_);
        const toml::table* table = file.given("calibrate") ? root["calibrate"].as_table() : nullptr;
        const toml::array* events = file.given("event") ? root["event"].as_array() : nullptr;
        if (!table || !events || events->empty())
            problems_.add(plan_.file.string(), "found no [calibrate], or no [[event]]", "expected both",
                          "see apps/README.md for an example");
        if (table) read_calibrate(*table);
        if (events) {
            for (std::size_t k = 0; k < events->size(); ++k)
                if (const toml::table* one = (*events)[k].as_table())
                    read_event(*one, fmt::format("event.{}", k));
                else
                    problems_.add(plan_.file.string(), fmt::format("found event.{} that is no table", k),
                                  "expected [[event]] tables", "see apps/README.md for an example");
        }
        if (file.given("predict")) read_predict(*root.get("predict"));
        file.refuse_others("here");
    }

private:
    void read_calibrate(const toml::table& of) {
        CheckedTable table(of, "calibrate", plan_.file, problems_);
        plan_.samples = table.whole("samples", plan_.samples, 2, kMostPoints);
        plan_.rounds = table.whole("rounds", plan_.rounds, 1, 100);
        if (plan_.samples * plan_.rounds > kMostPoints)
            table.wrong("rounds", fmt::format("found {} runs of each event", plan_.samples * plan_.rounds),
                        fmt::format("expected at most {}", kMostPoints), "give fewer samples or rounds");
        plan_.seed = static_cast<std::uint64_t>(table.whole("seed", 1, 0, Index{1} << 53));
        plan_.draws = table.whole("draws", plan_.draws, 1, kMostPoints);
        const std::string search = table.text("search", "bobyqa");
        plan_.search = search != "none";
        if (search != "bobyqa" && search != "none")
            table.wrong("search", fmt::format("found \"{}\"", search), "expected bobyqa or none", "choose one");
        read_errors(table, plan_.errors);
        read_objective(table, plan_.objective);
        const toml::array* vary = table.given("vary") ? of["vary"].as_array() : nullptr;
        if (!vary || vary->empty())
            table.wrong("vary", "found no [[calibrate.vary]]", "expected one or more", "name a key that varies");
        else
            plan_.vary = read_varied_keys(*vary, "calibrate.vary", {plan_.file}, problems_);
        for (const Vary& one : plan_.vary)
            if (one.distribution.kind == Distribution::Kind::discrete)
                table.wrong("vary", fmt::format("found scenarios for {}", one.key), "expected a number that varies",
                            "calibrate each scenario in a file of its own");
        table.refuse_others("here");
    }

    void read_predict(const toml::node& node) {
        EnsemblePlan& maps = plan_.predict.emplace();
        maps.file = plan_.file;
        if (const toml::table* table = node.as_table())
            read_wanted_maps(*table, "predict", maps, problems_);
        else
            problems_.add(plan_.file.string() + ": predict", "found no table", "expected [predict]", "write it so");
    }

    /// Standard deviations; those that are not given stay as they are.
    static void read_errors(CheckedTable& table, SurveyErrors& errors) {
        struct Key {
            const char *name, *what, *unit;
            double* number;
        };
        for (const Key& key :
             {Key{"sigma", "a length", " m", &errors.outline},
              Key{"correlation", "a length", " m", &errors.correlation},
              Key{"sigma_runout", "a length", " m", &errors.runout},
              Key{"sigma_height", "a height", " m", &errors.height}, Key{"sigma_log", "a number", "", &errors.log}}) {
            *key.number = table.number(key.name, *key.number);
            if (!(*key.number > 0.0))
                table.wrong(key.name, fmt::format("found {:g}{}", *key.number, key.unit),
                            fmt::format("expected {} above 0", key.what), "give one");
        }
    }

    /// What counts; as it is where nothing is given.
    static void read_objective(CheckedTable& table, std::vector<Evidence>& objective) {
        const toml::node* node = table.node("objective");
        if (!node) return;
        const auto complain = [&](const std::string& found) {
            std::vector<std::string> words;
            for (const Evidence evidence : all_evidence()) words.emplace_back(kind_of(evidence).word);
            table.wrong("objective", found, "expected a list of " + listed(words) + ", each once",
                        "write [\"outline\"]");
        };
        objective.clear();
        const toml::array* array = node->as_array();
        for (std::size_t k = 0; array && k < array->size(); ++k) {
            const std::string word = (*array)[k].value_or(std::string("what is no text"));
            const auto& all = all_evidence();
            const auto found =
                std::find_if(all.begin(), all.end(), [&](Evidence e) { return word == kind_of(e).word; });
            if (found == all.end())
                complain(fmt::format("found \"{}\"", word));
            else if (std::count(objective.begin(), objective.end(), *found) > 0)
                complain(fmt::format("found \"{}\" twice", word));
            else
                objective.push_back(*found);
        }
        if (!array || array->empty()) complain("found no words");
    }

    void read_gauge(const toml::table& of, const std::string& name, std::vector<SeenAtGauge>& gauges) {
        CheckedTable table(of, name, plan_.file, problems_);
        SeenAtGauge gauge;
        gauge.name = table.text("name");
        for (auto [key, seen] : {std::pair{"depth", &gauge.depth}, std::pair{"speed", &gauge.speed}}) {
            if (!table.given(key)) continue;
            *seen = table.number(key, 1.0);
            if (!(**seen > 0.0))
                table.wrong(key, fmt::format("found {:g}", **seen), "expected a number above 0",
                            "leave it out if the flow did not come there");
        }
        if (gauge.name.empty() || (!gauge.depth && !gauge.speed))
            table.wrong("name", "found no name, or neither depth nor speed",
                        "expected a gauge of the case, and what was seen",
                        "give the largest depth [m], speed [m/s] or both");
        table.refuse_others("here");
        gauges.push_back(std::move(gauge));
    }

    void read_gauges(CheckedTable& table, const std::string& name, SurveyedEvent& event) {
        const toml::node* node = table.node("gauge");
        const toml::array* array = node ? node->as_array() : nullptr;
        for (std::size_t k = 0; array && k < array->size(); ++k)
            if (const toml::table* one = (*array)[k].as_table())
                read_gauge(*one, fmt::format("{}.gauge.{}", name, k), event.gauges);
        if (node && event.gauges.empty())
            table.wrong("gauge", "found no [[event.gauge]] tables", "expected a table for each gauge", "write them so");
        const bool counts = std::count(event.objective.begin(), event.objective.end(), Evidence::gauges) > 0;
        if (counts == event.gauges.empty())
            table.wrong(
                "objective",
                counts ? "found \"gauges\", and no [[event.gauge]]" : "found [[event.gauge]], and no \"gauges\"",
                "expected both or none", "give what was seen, or change the objective");
    }

    void read_event(const toml::table& of, const std::string& name) {
        CheckedTable table(of, name, plan_.file, problems_);
        SurveyedEvent event;
        const std::string file = table.text("case");
        event.runs.file = plan_.file;
        event.runs.case_file = plan_.file.parent_path() / file;
        event.name = table.text("name", event.runs.case_file.stem().string());
        event.weight = table.number("weight", 1.0);
        event.errors = plan_.errors, event.objective = plan_.objective;
        read_errors(table, event.errors);
        read_objective(table, event.objective);
        read_gauges(table, name, event);
        if (file.empty() || !std::filesystem::is_regular_file(event.runs.case_file))
            table.wrong("case", fmt::format("found no file \"{}\"", event.runs.case_file.string()),
                        "expected a case file with a [survey]",
                        "correct the name; it is taken from the folder of this file");
        const auto same = [&](const SurveyedEvent& other) { return other.name == event.name; };
        if (std::any_of(plan_.events.begin(), plan_.events.end(), same))
            table.wrong("name", fmt::format("found \"{}\" a second time", event.name),
                        "expected another name for each event, since one that is taken twice counts twice",
                        "give name = ..., or take one of them out");
        std::error_code none_there;
        for (const SurveyedEvent& other : plan_.events)
            if (std::filesystem::equivalent(other.runs.case_file, event.runs.case_file, none_there))
                table.wrong("case", fmt::format("found the case of \"{}\" a second time", other.name),
                            "expected another case for each event, since one that is taken twice counts twice",
                            "take one of them out, or give its weight");
        if (!(event.weight > 0.0))
            table.wrong("weight", fmt::format("found {:g}", event.weight), "expected a number above 0", "give one");
        table.refuse_others("here");
        plan_.events.push_back(std::move(event));
    }

    CalibrationPlan& plan_;
    Problems& problems_;
};

}  // namespace

CalibrationPlan read_calibration(const std::filesystem::path& file) {
    CalibrationPlan plan;
    plan.file = file;
    Problems problems;
    read_toml(text_of_file(file), file, problems,
              [&](const toml::table& root) { CalibrationReader(plan, problems).read(root); });
    problems.throw_if_any();
    for (SurveyedEvent& event : plan.events) event.runs.vary = plan.vary, event.runs.fields = {"peak_depth"};
    return plan;
}

}  // namespace frana
