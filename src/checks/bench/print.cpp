#include "checks/bench/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace frana::bench {
namespace {

/// Share of the triad's speed that a phase reaches, by the modelled traffic.
double stream_share(const Report& report, const Cost& cost, const PhaseCost& phase) {
    const double ns = cost.ns(phase);
    return ns > 0.0 ? phase.bytes / ns / report.calibration.triad_GBps.at(cost.threads) : 0.0;
}

/// MODEL/PHASE/PRECISION
std::string name_of(const Timed& timed, const PhaseCost& phase) {
    std::string words = phase.name;
    std::replace(words.begin(), words.end(), ' ', '_');
    return timed.model + "/" + words + "/" + timed.precision;
}

std::string calibration_lines(const Calibration& c) {
    std::string text;
    for (const auto& [threads, speed] : c.triad_GBps)
        text +=
            fmt::format("triad, {} thread{}: {:.1f} GB/s by CPU time, {:.1f} by wall time (arrays of {} MB)\n", threads,
                        threads == 1 ? "" : "s", speed, c.triad_wall_GBps.at(threads), c.array_bytes / 1000000);
    return text + fmt::format("node-touch: {:.1f} ns by CPU time, {:.1f} by wall time\n", c.node_touch_ns,
                              c.node_touch_wall_ns);
}

std::string phase_lines(const Report& report) {
    std::string text = fmt::format("{:45} {:>9} {:>7} {:>8} {:>9} {:>8} {:>9}\n", "per particle and step", "particles",
                                   "threads", "cpu [ns]", "wall [ns]", "B moved", "of triad");
    for (const Timed& timed : report.timed)
        for (const PhaseCost& phase : timed.cost.phases)
            text += fmt::format("{:45} {:>9} {:>7} {:>8.2f} {:>9.2f} {:>8.0f} {:>8.0f}%\n", name_of(timed, phase),
                                timed.cost.particles, timed.cost.threads, phase.cpu_ns, phase.wall_ns, phase.bytes,
                                100.0 * stream_share(report, timed.cost, phase));
    return text;
}

/// Wall time of the phase with that name, 0 when it was not timed [ns].
double wall_of(const Timed* timed, const std::string& name) {
    if (timed == nullptr) return 0.0;
    for (const PhaseCost& phase : timed->cost.phases)
        if (phase.name == name) return phase.wall_ns;
    return 0.0;
}

/// The time of one thread over that of many, by the wall, of what was timed with both.
std::string speed_up_lines(const Report& report) {
    std::string head = fmt::format("{:45} {:>9}", "speed-up over one thread, by wall time", "particles"), text;
    for (const int threads : report.options.threads)
        if (threads > 1) head += fmt::format(" {:>7}", fmt::format("x{}", threads));
    for (const Timed& one : report.timed) {
        if (one.cost.threads != 1) continue;
        for (const PhaseCost& phase : one.cost.phases) {
            std::string ratios;
            for (const int threads : report.options.threads) {
                if (threads == 1) continue;
                const double many =
                    wall_of(find(report, one.model, one.cost.particles, threads, one.precision), phase.name);
                if (many > 0.0) ratios += fmt::format(" {:>7.2f}", phase.wall_ns / many);
            }
            if (!ratios.empty())
                text += fmt::format("{:45} {:>9}{}\n", name_of(one, phase), one.cost.particles, ratios);
        }
    }
    return text.empty() ? "" : head + "\n" + text + "\n";
}

std::string frame_lines(const Report& report) {
    if (report.frames.empty()) return "";
    std::string text =
        fmt::format("{:44} {:>9} {:>9} {:>9}\n", "one frame, one thread", "fields", "wall [ms]", "steps");
    for (const FrameCost& cost : report.frames)
        text += fmt::format("{:44} {:>9} {:>9.2f} {:>9.2f}\n", cost.name, cost.fields, 1e3 * cost.seconds, cost.steps);
    return text + "\n";
}

std::string gate_lines(const Report& report) {
    std::string text = fmt::format("{:52} {:>9} {:>9} {:>9}\n", "gate", "measured", "gate", "aim");
    for (const Gate& gate : gates(report)) {
        const bool known = !std::isnan(gate.measured);
        text += fmt::format("{:52} {:>9} {} {:>6} {:>9}  {}\n", gate.what,
                            known ? fmt::format("{:.2f}", gate.measured) : "-",
                            gate.at_least ? ">=" : "<=", fmt::format("{:g}", gate.gate), fmt::format("{:g}", gate.aim),
                            !known       ? "not measured"
                            : gate.met() ? "met"
                                         : "MISSED");
    }
    return text;
}

std::string hash_lines(const Report& report) {
    std::string text;
    for (const auto& [threads, hash] : report.hashes) text += fmt::format("{:016x} with {} threads\n", hash, threads);
    const char* verdict = same_bits(report) ? "same bits for any number of threads" : "DIFFERENT BITS: our mistake";
    return fmt::format("{}{}\n", text, verdict);
}

/// Work of other programs shows as wall time beyond CPU time. With one thread there is nothing else to wait for.
std::string warning(const Report& report) {
    for (const Timed& timed : report.timed) {
        const PhaseCost& full = timed.cost.full();
        if (timed.cost.threads == 1 && full.wall_ns > 1.1 * full.cpu_ns)
            return "the machine has other work: wall times, and two threads over one, are not its own\n";
    }
    return "";
}

std::string json_kernel(const Report& report, const Timed& timed, const PhaseCost& phase) {
    const Cost& cost = timed.cost;
    std::string text = fmt::format(
        R"({{"name": "{}", "particles": {}, "threads": {}, "ns_per_particle_step": {:.6g}, )"
        R"("bytes_per_particle_step": {:.6g}, "fraction_of_stream": {:.6g}, "cpu_ns": {:.6g}, "wall_ns": {:.6g})",
        name_of(timed, phase), cost.particles, cost.threads, cost.ns(phase), phase.bytes,
        stream_share(report, cost, phase), phase.cpu_ns, phase.wall_ns);
    if (&phase == &cost.full())
        text +=
            fmt::format(R"(, "particles_end": {}, "steps": {}, "bytes_per_particle": {:.6g}, )"
                        R"("nodes_per_particle": {:.6g}, "hash": "{:016x}")",
                        cost.particles_end, cost.steps, cost.bytes_per_particle, cost.nodes_per_particle, cost.hash);
    return text + "}";
}

std::string json_speeds(const std::map<int, double>& speeds) {
    std::string text;
    for (const auto& [threads, speed] : speeds)
        text += fmt::format("{}\"{}\": {:.6g}", text.empty() ? "" : ", ", threads, speed);
    return "{" + text + "}";
}

std::string json_frame(const FrameCost& cost) {
    return fmt::format(R"({{"writer": "{}", "fields": {}, "wall_ms": {:.6g}, "steps": {:.6g}}})", cost.name,
                       cost.fields, 1e3 * cost.seconds, cost.steps);
}

std::string json_gate(const Gate& gate) {
    return fmt::format(R"({{"what": "{}", "measured": {}, "gate": {:g}, "aim": {:g}, "at_least": {}}})", gate.what,
                       std::isnan(gate.measured) ? "null" : fmt::format("{:.6g}", gate.measured), gate.gate, gate.aim,
                       gate.at_least);
}

}  // namespace

std::string table_of(const Report& report) {
    return calibration_lines(report.calibration) + "\n" + phase_lines(report) + "\n" + speed_up_lines(report) +
           frame_lines(report) + gate_lines(report) + "\n" + hash_lines(report) + warning(report);
}

std::string json_of(const Report& report) {
    std::string kernels, frames, held;
    for (const Timed& timed : report.timed)
        for (const PhaseCost& phase : timed.cost.phases) {
            if (phase.bytes == 0.0) continue;  // "other": nothing is known of its traffic
            kernels += (kernels.empty() ? "\n  " : ",\n  ") + json_kernel(report, timed, phase);
        }
    for (const FrameCost& cost : report.frames) frames += (frames.empty() ? "\n  " : ",\n  ") + json_frame(cost);
    for (const Gate& gate : gates(report)) held += (held.empty() ? "\n  " : ",\n  ") + json_gate(gate);
    const Calibration& c = report.calibration;
    return fmt::format(
        "{{\"stream_triad_GBps\": {},\n\"stream_triad_wall_GBps\": {},\n\"node_touch_ns\": {:.6g},\n"
        "\"same_bits\": {},\n\"kernels\": [{}],\n\"frames\": [{}],\n\"gates\": [{}]}}\n",
        json_speeds(c.triad_GBps), json_speeds(c.triad_wall_GBps), c.node_touch_ns, same_bits(report), kernels, frames,
        held);
}

}  // namespace frana::bench
