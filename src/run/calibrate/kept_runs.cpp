#include "run/calibrate/kept_runs.h"

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/version.h"
#include "ensemble/sample_table.h"
#include "run/ensemble/kept_rows.h"
#include "run/ensemble/shard_store.h"
#include "run/folder/input_sums.h"
#include "scene/case_file.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Runs are written so often at most; a kill loses what came since.
constexpr std::chrono::milliseconds kPatience{250};
constexpr std::size_t kFieldsOfRun = 6;  ///< before its misfits
constexpr std::size_t kFieldsOfMisfit = 3;

fs::path file_of(const fs::path& dir) { return dir / "kept" / "runs.csv"; }

/// All that a run of an event and its scores depend on, but the values of the keys that vary.
std::string decides(const SurveyedEvent& event) {
    std::string all = mark_of_inputs(CaseFile::read(event.runs.case_file));
    all += fmt::format(" {}", event.errors.correlation);
    for (const Evidence evidence : event.objective) all += fmt::format(" {}", kind_of(evidence).word);
    for (const SeenAtGauge& seen : event.gauges)
        all += fmt::format(" {} {} {}", seen.name, text_of_known(seen.depth), text_of_known(seen.speed));
    return all;
}

RowsOf rows_of(const CalibrationPlan& plan) {
    RowsOf rows{"calibration", fmt::format("# frana {},keys", FRANA_VERSION), "event"};
    for (const Vary& vary : plan.vary) {
        rows.mark += " " + vary.key;
        rows.columns += "," + vary.key;
    }
    for (const SurveyedEvent& event : plan.events)
        rows.mark += fmt::format(",event {} {:016x}", plain_field(event.name), sum_of(decides(event)));
    rows.columns += ",reason,seconds,still_moves,left_share,iou,boundary_m";
    for (const Evidence evidence : all_evidence()) {
        const char* word = kind_of(evidence).word;
        rows.columns += fmt::format(",{0}_rms,{0}_number,{0}_unsurveyed_m3", word);
    }
    rows.columns += ",remarks,message";
    return rows;
}

std::string question(std::size_t event, const std::vector<std::string>& values) {
    return fmt::format("{},{}", event, fmt::join(values, ","));
}

std::string row_of(const EventRun& run) {
    std::string row = fmt::format("{},{:.3f},{:d},{},{},{}", run.reason, run.seconds, run.still_moves, run.left_share,
                                  text_of_known(run.scores.iou), text_of_known(run.scores.boundary));
    for (const auto& misfit : run.scores.misfits)
        row += misfit ? fmt::format(",{},{},{}", misfit->rms, misfit->number, misfit->unsurveyed) : ",,,";
    return row + "," + remarks_field(run.remarks) + "," + plain_field(run.message) + "\n";
}

/// What the fields from `at` on say.
EventRun run_of(const std::vector<std::string>& fields, std::size_t at) {
    const auto known = [&](std::size_t k) {
        return fields[k].empty() ? std::optional<double>() : std::optional<double>(kept_number(fields[k]));
    };
    EventRun run;
    run.reason = fields[at], run.seconds = kept_number(fields[at + 1]);
    run.still_moves = kept_number(fields[at + 2]) != 0.0;
    run.left_share = kept_number(fields[at + 3]);
    run.scores.iou = known(at + 4), run.scores.boundary = known(at + 5);
    for (std::size_t k = 0; k < kEvidence; ++k)
        if (const std::size_t from = at + kFieldsOfRun + kFieldsOfMisfit * k; const auto rms = known(from))
            run.scores.misfits[k] = Misfit{*rms, known(from + 1).value_or(0.0), known(from + 2).value_or(0.0)};
    run.remarks = remarks_of_field(fields[fields.size() - 2]);
    run.message = fields.back();
    return run;
}

}  // namespace

KeptRuns::KeptRuns(const fs::path& dir, const CalibrationPlan& plan) : file_(file_of(dir)) {
    const RowsOf of = rows_of(plan);
    fs::create_directories(file_.parent_path());
    remove_leftovers(file_.parent_path());
    rows_ = of.head();
    if (!fs::exists(file_)) return;
    const std::size_t keys = plan.vary.size(),
                      fields_of_a_row =
                          1 + keys + kFieldsOfRun + kFieldsOfMisfit * kEvidence + 2;  // and remarks, message
    for_each_row(file_, of, [&](const std::string& line) {
        const std::vector<std::string> fields = comma_fields(line);
        if (fields.size() != fields_of_a_row) throw broken_row(file_, line);
        try {
            EventRun run = run_of(fields, 1 + keys);
            if (run.reason == "refused") return;  // is tried again
            const std::vector<std::string> values(fields.begin() + 1, fields.begin() + 1 + static_cast<Index>(keys));
            rows_ += line + "\n";
            runs_[question(std::stoul(fields[0]), values)] = std::move(run);
        } catch (const std::logic_error&) {  // what the conversions say of text that is no number
            throw broken_row(file_, line);
        }
    });
}

const EventRun* KeptRuns::find(std::size_t event, const std::vector<std::string>& values) const {
    const auto found = runs_.find(question(event, values));
    return found == runs_.end() ? nullptr : &found->second;
}

void KeptRuns::add(std::size_t event, const std::vector<std::string>& values, const EventRun& run) {
    const std::lock_guard<std::mutex> alone(mutex_);
    if (broken_) return;
    const std::string asked = question(event, values);
    runs_[asked] = run;
    rows_ += asked + "," + row_of(run);
    waiting_ = true;
    if (std::chrono::steady_clock::now() - written_ > kPatience) write();
}

void KeptRuns::flush() {
    const std::lock_guard<std::mutex> alone(mutex_);
    if (waiting_ && !broken_) write();
}

void KeptRuns::write() {
    broken_ = true;  // until all is written: what one thread could not write, another must not try
    write_text(file_, rows_);
    broken_ = waiting_ = false;
    written_ = std::chrono::steady_clock::now();
}

bool KeptRuns::are_in(const fs::path& dir) { return fs::exists(file_of(dir)); }

void KeptRuns::remove(const fs::path& dir) {
    std::error_code ignored;
    fs::remove(file_of(dir), ignored);
}

std::string mark_of(const CalibrationPlan& plan) {
    return fmt::format("{:016x}", sum_of(rows_of(plan).mark + text_in(plan.file)));
}

}  // namespace frana
