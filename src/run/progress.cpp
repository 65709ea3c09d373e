#include "run/progress.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace frana {
namespace {

constexpr double redraw_interval = 0.2;  // [s] of wall time

std::size_t terminal_width() {
    winsize window{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 20) return window.ws_col;
    return 100;
}

std::string state_text(const Status& now, double density) {
    return fmt::format("dt {:.2g} s  {} particles  {:.4g} m3  max {:.3g} m/s", now.dt, now.particles,
                       now.mass / density, now.max_speed);
}

}  // namespace

std::string clock_text(double seconds) {
    if (!std::isfinite(seconds)) return "-:--";
    const auto total = static_cast<long>(std::llround(std::max(seconds, 0.0)));
    const long hours = total / 3600, minutes = total / 60 % 60, rest = total % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest) : fmt::format("{}:{:02}", minutes, rest);
}

Progress::Style Progress::fitting(bool quiet) {
    if (quiet) return Style::silent;
    return isatty(STDOUT_FILENO) ? Style::bar : Style::lines;
}

void Progress::begin(const Status& first, double end) {
    began_ = std::chrono::steady_clock::now();
    start_time_ = first.time;
    end_time_ = end;
    last_drawn_ = -1.0;
}

void Progress::resumed(const Status& now) {
    if (style_ == Style::silent) return;
    stream_ << fmt::format("goes on from t = {:.6g} s, step {}\n", now.time, now.step) << std::flush;
}

void Progress::step(const Status& now) {
    if (style_ != Style::bar) return;
    const double wall = wall_seconds();
    if (last_drawn_ >= 0.0 && wall - last_drawn_ < redraw_interval) return;
    last_drawn_ = wall;
    std::string line = bar(now, wall);
    if (line.size() >= terminal_width()) line.resize(terminal_width() - 1);
    stream_ << '\r' << line << "\033[K" << std::flush;
}

void Progress::output(Index number, const Status& now) {
    if (style_ != Style::lines) return;
    const double wall = wall_seconds();
    stream_ << fmt::format("frame {:4}  t {:.6g} of {:.6g} s  step {}  {}  wall {}  left {}\n", number, now.time,
                           end_time_, now.step, state_text(now, density_), clock_text(wall),
                           clock_text(remaining(now, wall)))
            << std::flush;
}

void Progress::end(const Status& last, const std::string& reason) {
    if (style_ == Style::silent) return;
    if (style_ == Style::bar) {
        last_drawn_ = -1.0;
        step(last);
        stream_ << '\n';
    }
    if (reason != "end") stream_ << fmt::format("stopped at t = {:.6g} s: {}\n", last.time, reason);
    stream_ << std::flush;
}

std::string Progress::bar(const Status& now, double wall) const {
    constexpr std::size_t cells = 20;
    const double span = end_time_ - start_time_;
    const double done = span > 0.0 ? std::clamp((now.time - start_time_) / span, 0.0, 1.0) : 1.0;
    const auto full = static_cast<std::size_t>(std::floor(done * static_cast<double>(cells)));
    return fmt::format("[{}{}] {:3.0f} %  t {:.4g}/{:.4g} s  ETA {}  {}", std::string(full, '#'),
                       std::string(cells - full, '.'), std::floor(100.0 * done), now.time, end_time_,
                       clock_text(remaining(now, wall)), state_text(now, density_));
}

double Progress::remaining(const Status& now, double wall) const {
    const double done = now.time - start_time_;
    return done > 0.0 ? wall * (end_time_ - now.time) / done : std::numeric_limits<double>::infinity();
}

double Progress::wall_seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

}  // namespace frana
