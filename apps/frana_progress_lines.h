#pragma once
// What other programs read on standard output with --progress json: a JSON object a line (apps/README.md has the table).
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "run/folder/run_record.h"

namespace frana {

/// The first and the last line of a command, and what comes between them.
class ProgressLines {
public:
    /// `style`: "json", or empty for no lines at all.
    ProgressLines(const std::string& style, const std::string& command);

    bool wanted() const { return wanted_; }
    void line(const nlohmann::ordered_json& object) const;
    /// Before the first step of a run.
    void scene(const RunRecord& record) const;
    /// Once a run and its files are over; a failure of the run is told by the last line.
    void result(const RunRecord& record);
    /// The folder and the reason, for the last line.
    void into(const std::filesystem::path& folder) { folder_ = std::filesystem::absolute(folder); }
    void reason(const std::string& word) { reason_ = word; }

    /// Calls `command`, which returns an exit code or throws. The last line comes either way, and what was thrown after
    /// it.
    int around(const std::function<int()>& command);

private:
    void last(int code, const std::string& usual_reason, const std::string& error) const;

    bool wanted_;
    std::string folder_, reason_;
};

}  // namespace frana
