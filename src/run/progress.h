#pragma once
// What the user sees of a case while it runs. It is a bar on a terminal, a line per frame in a log, lines of JSON, or nothing.
#include <chrono>
#include <ostream>
#include <string>

#include "observe/frame.h"

namespace frana {

class Progress {
public:
    enum class Style { bar, lines, json, silent };  ///< json: a line a second for other programs (apps/README.md)
    /// `density` [kg/m^3] turns masses into volumes.
    Progress(std::ostream& stream, Style style, double density) : stream_(stream), style_(style), density_(density) {}

    /// So long pictures are expected to take after the end: what is left of a run counts them, too [s].
    void expect_after_the_end(double seconds) { after_the_end_ = seconds; }
    void begin(const Status& first, double end);
    /// After begin(), when the run goes on from a saved state.
    void resumed(const Status& now);
    /// After every step. The bar is redrawn at most five times a second, and a line of JSON comes at most once.
    void step(const Status& now);
    /// After every frame that was written.
    void output(Index number, const Status& now);
    void end(const Status& last, const std::string& reason);
    /// After the end, while figures are drawn: so many of them are done. Once with none.
    void pictures(std::size_t done, std::size_t all);

    /// Bar when standard output is a terminal, lines when it is not.
    static Style fitting(bool quiet);

private:
    void redraw(const Status& now, double wall);
    std::string bar(const Status& now, double wall) const;
    std::string json(const Status& now, double wall) const;
    double remaining(const Status& now, double wall) const;
    double wall_seconds() const;

    std::ostream& stream_;
    Style style_;
    double density_;
    double start_time_ = 0.0;
    double end_time_ = 0.0;
    double after_the_end_ = 0.0;  ///< [s] of wall time
    double last_drawn_ = -1.0;    ///< [s] of wall time since begin()
    std::chrono::steady_clock::time_point began_;
};

/// Wall time for people: "0:07", "12:40", "3:05:00"; "-:--" when not yet known (not finite).
std::string clock_text(double seconds);

}  // namespace frana
