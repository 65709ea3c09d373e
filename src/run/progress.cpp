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
constexpr double json_interval = 1.0;    // likewise

std::size_t terminal_width() {
    winsize window{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 20) return window.ws_col;
    return 100;
}

/// Of the mass by its `density`, and of free water by its own [m3].
double volume_of(const Status& now, double density) { return (now.mass - now.water) / density + now.water_volume; }

std::string state_text(const Status& now, double density) {
    const std::string particles =
        now.particles == 0 && now.water > 0.0 ? "" : fmt::format("{} particles  ", now.particles);
    return fmt::format("dt {:.2g} s  {}{:.4g} m3  max {:.3g} m/s", now.dt, particles, volume_of(now, density),
                       now.max_speed);
}

/// JSON has no infinity and no NaN.
std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

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
    if (style_ == Style::silent || style_ == Style::json) return;
    stream_ << fmt::format("goes on from t = {:.6g} s, step {}\n", now.time, now.step) << std::flush;
}

void Progress::step(const Status& now) {
    if (style_ != Style::bar && style_ != Style::json) return;
    const double wall = wall_seconds();
    const double interval = style_ == Style::bar ? redraw_interval : json_interval;
    if (last_drawn_ >= 0.0 && wall - last_drawn_ < interval) return;
    last_drawn_ = wall;
    redraw(now, wall);
}

void Progress::redraw(const Status& now, double wall) {
    if (style_ == Style::json) {
        stream_ << json(now, wall) << std::endl;
        return;
    }
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
    if (style_ != Style::lines) redraw(last, wall_seconds());
    if (style_ == Style::json) return;
    if (style_ == Style::bar) stream_ << '\n';
    if (reason != "end" && reason != "until")
        stream_ << fmt::format("stopped at t = {:.6g} s: {}\n", last.time, reason);
    stream_ << std::flush;
}

void Progress::pictures(std::size_t done, std::size_t all) {
    const char* plural = all == 1 ? "" : "s";
    if (style_ == Style::json)
        stream_ << fmt::format("{{\"event\": \"pictures\", \"done\": {}, \"all\": {}}}", done, all) << std::endl;
    if (style_ == Style::lines && done == 0)
        stream_ << fmt::format("drawing {} picture{}\n", all, plural) << std::flush;
    if (style_ == Style::bar)
        stream_ << fmt::format("\rpictures: {} of {} done\033[K{}", done, all, done == all ? "\n" : "") << std::flush;
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

/// The share is that of the whole run, also when it goes on from a saved state.
std::string Progress::json(const Status& now, double wall) const {
    const double share = end_time_ > 0.0 ? std::clamp(now.time / end_time_, 0.0, 1.0) : 1.0;
    return fmt::format(
        "{{\"event\": \"progress\", \"time\": {}, \"end\": {}, \"share\": {}, \"step\": {}, \"dt\": {}, \"particles\": "
        "{}, "
        "\"volume\": {}, \"max_speed\": {}, \"wall\": {}, \"eta\": {}}}",
        json_number(now.time), json_number(end_time_), json_number(share), now.step, json_number(now.dt), now.particles,
        json_number(volume_of(now, density_)), json_number(now.max_speed), json_number(wall),
        json_number(remaining(now, wall)));
}

double Progress::remaining(const Status& now, double wall) const {
    const double done = now.time - start_time_;
    if (!(done > 0.0)) return std::numeric_limits<double>::infinity();
    return wall * (end_time_ - now.time) / done + after_the_end_;
}

double Progress::wall_seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

}  // namespace frana
