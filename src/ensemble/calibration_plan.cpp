#include "ensemble/calibration_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "ensemble/toml_file.h"
#include "ensemble/vary_reader.h"

namespace frana {
namespace {

constexpr Index kMostPoints = 5000;  ///< each point's weight asks all others, in each round

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
        for (auto [key, number] : {std::pair{"sigma", &plan_.sigma}, std::pair{"correlation", &plan_.correlation}}) {
            *number = table.number(key, *number);
            if (!(*number > 0.0))
                table.wrong(key, fmt::format("found {:g} m", *number), "expected a length above 0", "give one");
        }
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

    void read_event(const toml::table& of, const std::string& name) {
        CheckedTable table(of, name, plan_.file, problems_);
        SurveyedEvent event;
        const std::string file = table.text("case");
        event.runs.file = plan_.file;
        event.runs.case_file = plan_.file.parent_path() / file;
        event.name = table.text("name", event.runs.case_file.stem().string());
        event.weight = table.number("weight", 1.0);
        if (file.empty() || !std::filesystem::is_regular_file(event.runs.case_file))
            table.wrong("case", fmt::format("found no file \"{}\"", event.runs.case_file.string()),
                        "expected a case file with a [survey]",
                        "correct the name; it is taken from the folder of this file");
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

double log_likelihood(double rms, double perimeter, const CalibrationPlan& plan) {
    const double apart = rms / plan.sigma;
    return -0.5 * (perimeter / plan.correlation) * apart * apart;
}

}  // namespace frana
