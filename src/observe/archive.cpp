#include "observe/archive.h"

#include <fmt/core.h>

#include "base/error.h"
#include "observe/frame.h"
#include "observe/status_numbers.h"

namespace frana {

void Archive::wrong_length(const std::string& name, std::size_t found, std::size_t expected) {
    throw UserError(
        fmt::format("the saved state has {} values of {}, expected {}; it was left by another program, run "
                    "without --resume",
                    found, name, expected));
}

void Archive::exchange_one(const std::string& name, Kind kind, void* value) {
    const std::size_t count = loading() ? stored(prefix_ + name, kind) : 1;
    if (count != 1) wrong_length(prefix_ + name, count, 1);
    exchange(prefix_ + name, kind, value, 1);
}

void Archive::numbers(const std::string& name, const std::vector<double*>& values) {
    std::vector<double> all;
    all.reserve(values.size());
    for (const double* value : values) all.push_back(*value);
    array(name, all);
    if (!loading()) return;
    if (all.size() != values.size()) wrong_length(prefix_ + name, all.size(), values.size());
    for (std::size_t i = 0; i < all.size(); ++i) *values[i] = all[i];
}

void Archive::text(const std::string& name, std::string& value) {
    std::vector<std::uint8_t> letters(value.begin(), value.end());
    array(name, letters);
    value.assign(letters.begin(), letters.end());
}

void Archive::texts(const std::string& name, std::vector<std::string>& values) {
    std::string all;
    std::vector<Index> ends;
    for (const std::string& value : values) {
        all += value;
        ends.push_back(static_cast<Index>(all.size()));
    }
    text(name, all);
    array(name + "_ends", ends);
    if (!loading()) return;
    values.clear();
    std::size_t from = 0;
    for (const Index end : ends) {
        const auto to = static_cast<std::size_t>(end);
        if (to < from || to > all.size()) wrong_length(prefix_ + name, all.size(), to);
        values.push_back(all.substr(from, to - from));
        from = to;
    }
}

void serialize(Archive& archive, const std::string& name, Status& s) {
    const Archive::Part part(archive, name);
    archive.number("step", s.step);
    archive.number("particles", s.particles);
    archive.numbers("numbers", numbers_of(s));
}

void serialize(Archive& archive, const std::string& name, std::vector<PhaseTime>& phases) {
    const Archive::Part part(archive, name);
    std::vector<std::string> names;
    std::vector<double> seconds, cpu_seconds;
    std::vector<Index> calls;
    for (const PhaseTime& phase : phases) {
        names.push_back(phase.name);
        seconds.push_back(phase.seconds);
        cpu_seconds.push_back(phase.cpu_seconds);
        calls.push_back(phase.calls);
    }
    archive.texts("names", names);
    archive.array("seconds", seconds);
    archive.array("cpu_seconds", cpu_seconds);
    archive.array("calls", calls);
    if (!archive.loading()) return;
    for (const std::size_t length : {seconds.size(), cpu_seconds.size(), calls.size()})
        if (length != names.size()) Archive::wrong_length(name, length, names.size());
    phases.clear();
    for (std::size_t i = 0; i < names.size(); ++i) phases.push_back({names[i], seconds[i], cpu_seconds[i], calls[i]});
}

}  // namespace frana
