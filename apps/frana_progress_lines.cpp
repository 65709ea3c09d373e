#include "frana_progress_lines.h"

#include <exception>
#include <filesystem>
#include <iostream>

#include "base/version.h"
#include "frana_failure.h"

namespace frana {

ProgressLines::ProgressLines(const std::string& style, const std::string& command) : wanted_(style == "json") {
    line({{"event", "start"}, {"program", "frana"}, {"version", FRANA_VERSION}, {"command", command}});
}

void ProgressLines::line(const nlohmann::ordered_json& object) const {
    if (!wanted_) return;
    // A folder's name need not be UTF-8.
    std::cout << object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
}

void ProgressLines::scene(const RunRecord& record) const {
    line({{"event", "scene"},
          {"title", record.title},
          {"folder", folder_},
          {"end", record.end},
          {"cell", record.grid.cell},
          {"nodes", {record.grid.nx, record.grid.ny}},
          {"particles", record.particles},
          {"release_volume", record.release_volume},
          {"threads", record.threads},
          {"remarks", record.warnings}});
}

void ProgressLines::result(const RunRecord& record) {
    const RunSummary& summary = record.summary;
    reason_ = summary.reason;
    line({{"event", "result"},
          {"time", summary.last.time},
          {"steps", summary.steps},
          {"frames", summary.frames},
          {"particles", summary.last.particles},
          {"peak_depth", record.peak_depth},
          {"peak_speed", record.peak_speed},
          {"footprint_area", record.footprint_area},
          {"wall", summary.wall_seconds},
          {"pictures_cut_off", record.pictures_cut_off},
          {"remarks", record.warnings}});
}

int ProgressLines::around(const std::function<int()>& command) {
    try {
        const int code = command();
        last(code, code == 0 ? "end" : code == 130 ? "interrupted" : "failed", "");
        return code;
    } catch (...) {
        const Failure failure = failure_of(std::current_exception());
        last(failure.code, failure.reason, failure.text);
        throw;
    }
}

void ProgressLines::last(int code, const std::string& usual_reason, const std::string& error) const {
    nlohmann::ordered_json end = {{"event", "end"},
                                  {"exit_code", code},
                                  {"exit_reason", reason_.empty() ? usual_reason : reason_},
                                  {"folder", folder_}};
    if (!error.empty()) end["error"] = error;
    line(end);
}

}  // namespace frana
