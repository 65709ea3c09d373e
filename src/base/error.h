#pragma once
// Errors with a person in mind. The kind says whose fault it is and fixes the exit code of `frana`. UserError has 2
// (case file, data, command line), NumericsError 3, InternalError 1, Interrupted 130. A message reads: place, what was
// found, what is expected, what to do. Only main() catches.
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace frana {

/// The case file, its data or the command line is wrong. Holds every problem found, one sentence each on a line of its
/// own. Line breaks and other control characters, which files may bring in, become spaces.
class UserError : public std::runtime_error {
public:
    explicit UserError(const std::string& problem) : UserError(std::vector<std::string>{problem}) {}
    explicit UserError(std::vector<std::string> problems) : UserError(Lines{in_lines(std::move(problems))}) {}
    const std::vector<std::string>& problems() const { return problems_; }

private:
    struct Lines {
        std::vector<std::string> all;
    };
    explicit UserError(const Lines& lines) : std::runtime_error(joined(lines.all)), problems_(lines.all) {}

    static std::vector<std::string> in_lines(std::vector<std::string> problems) {
        for (std::string& problem : problems)
            for (char& letter : problem)
                if (static_cast<unsigned char>(letter) < ' ' || letter == 127) letter = ' ';
        return problems;
    }
    static std::string joined(const std::vector<std::string>& problems) {
        std::string text;
        for (const auto& problem : problems) text += (text.empty() ? "" : "\n") + problem;
        return text;
    }
    std::vector<std::string> problems_;
};

/// The computation left the numbers it can stand for (not finite, time step collapsed, ...).
class NumericsError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A mistake of ours.
class InternalError : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

/// Ctrl-C or SIGTERM arrived; what was written so far is valid.
class Interrupted : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Checks an assumption of our own. It is always compiled in, so it does not belong in inner loops.
inline void expect(bool condition, const char* what) {
    if (!condition) throw InternalError(std::string("internal error: ") + what);
}

}  // namespace frana
