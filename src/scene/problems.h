#pragma once
// Everything that is wrong with a case, gathered before anything is thrown. So one run of `frana check` shows all of
// it.
#include <string>
#include <vector>

#include "base/error.h"

namespace frana {

class Problems {
public:
    /// "place: found; expected; way out". `line` only orders the list; problems without one come last.
    void add(int line, const std::string& place, const std::string& found, const std::string& expected,
             const std::string& way_out);
    void add(const std::string& place, const std::string& found, const std::string& expected,
             const std::string& way_out) {
        add(no_line, place, found, expected, way_out);
    }
    /// Each problem of an error made elsewhere, with its place in the case put before.
    void add(const std::string& place, const UserError& error);

    /// Runs `work`; a UserError of it is noted under `place` and the work counts as not done (false). The one
    /// spot besides main() that catches: without it a case would show its first problem only.
    template <class Work>
    bool attempt(const std::string& place, Work&& work) {
        try {
            work();
            return true;
        } catch (const UserError& error) {
            add(place, error);
            return false;
        }
    }

    bool empty() const { return problems_.empty(); }
    std::size_t count() const { return problems_.size(); }
    /// Throws a UserError of all of them, in the order of their lines, if there are any.
    void throw_if_any() const;

    static constexpr int no_line = 1 << 30;

private:
    struct Problem {
        int line;
        std::string text;
    };
    std::vector<Problem> problems_;
};

}  // namespace frana
