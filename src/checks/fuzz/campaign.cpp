#include "checks/fuzz/campaign.h"

#include <fmt/core.h>

#include <chrono>
#include <cmath>

#include "checks/fuzz/draw.h"

namespace frana::fuzz {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void note(const Verdict& verdict, Model model, std::uint64_t n, Campaign& campaign) {
    Part& part = campaign.mix[model];
    part.scenes += 1, part.refused += verdict.refused, part.failed += verdict.broken.has_value();
    part.steps += verdict.steps;
    campaign.scenes += 1, campaign.refused += verdict.refused, campaign.parted += verdict.parted;
    if (verdict.refused) campaign.refusals[verdict.text] += 1;
    campaign.steps += verdict.steps;
    campaign.particle_steps += static_cast<double>(verdict.steps) * static_cast<double>(verdict.particles);
    if (verdict.broken) {
        campaign.broken[verdict.broken->invariant] += 1;
        return;
    }
    for (const auto& [invariant, value] : verdict.worst) {
        const auto [worst, is_new] = campaign.worst.try_emplace(invariant, Worst{value, model, n});
        if (!is_new && value > worst->second.value) worst->second = {value, model, n};
    }
}

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : "null"; }

std::string json_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return quoted + "\"";
}

std::string json_of(const Failure& failure) {
    const Violation& v = failure.found;
    std::string text = fmt::format(
        "{{\"model\": \"{}\", \"scene\": {}, \"invariant\": {}, \"value\": {}, \"step\": {}, "
        "\"time\": {}, \"text\": {}",
        word_of(failure.model), failure.n, json_text(v.invariant), json_number(v.value), v.step, json_number(v.time),
        json_text(v.text));
    if (failure.shrunk.trials > 0)
        text += fmt::format(", \"shrunk_trials\": {}, \"shrunk_steps\": {}, \"shrunk_particles\": {}",
                            failure.shrunk.trials, failure.shrunk.draft.steps, failure.shrunk.verdict.particles);
    return text + "}";
}

}  // namespace

Campaign run(const Plan& plan, const std::function<void(const Failure&)>& report, const std::function<bool()>& stop) {
    Campaign campaign;
    campaign.plan = plan;
    const auto judge = [](const Draft& draft) { return examine(draft); };
    for (std::uint64_t n = plan.first; campaign.seconds < plan.seconds; ++n) {
        if ((plan.scenes > 0 && campaign.scenes >= plan.scenes) || (stop && stop())) break;
        const auto start = std::chrono::steady_clock::now();
        const Model model = model_of(plan.models, plan.seed, n);
        const Draft draft = draw(model, plan.seed, n);
        const Verdict verdict = examine(draft);
        const double seconds = seconds_since(start);
        note(verdict, model, n, campaign);
        campaign.seconds += seconds, campaign.mix[model].seconds += seconds;
        if (!verdict.broken) continue;
        Failure failure{model, n, *verdict.broken, {draft, verdict, 0}};
        if (static_cast<Index>(campaign.failures.size()) < plan.most_shrunk)
            failure.shrunk = shrink(draft, judge, plan.shrink_trials);
        report(failure);
        failure.shrunk.draft.rasters.clear();  // saved by now
        campaign.failures.push_back(std::move(failure));
    }
    return campaign;
}

std::string table_of(const Campaign& c) {
    const std::uint64_t end = c.plan.first + static_cast<std::uint64_t>(c.scenes);
    std::string text = fmt::format(
        "seed {}, scenes {} to {}: {} run, {} refused, {} failed; {} steps, {:.3g} "
        "particle-steps, {:.1f} s\n",
        c.plan.seed, c.plan.first, end, c.scenes, c.refused, c.failures.size(), c.steps, c.particle_steps, c.seconds);
    if (c.parted > 0)
        text += fmt::format("{} whose mirror images parted by round-off that the flow made grow\n", c.parted);
    text += fmt::format("{:<14} {:>8} {:>8} {:>8} {:>8} {:>10}\n", "model", "scenes", "refused", "failed", "steps",
                        "ms a scene");
    for (const auto& [model, part] : c.mix)
        text += fmt::format("{:<14} {:>8} {:>8} {:>8} {:>8} {:>10.1f}\n", word_of(model), part.scenes, part.refused,
                            part.failed, part.steps, 1e3 * part.seconds / static_cast<double>(part.scenes));
    for (const auto& [what, count] : c.refusals) text += fmt::format("{} refused: {}\n", count, what);
    text +=
        fmt::format("{:<10} {:>8} {:>16} {:<14} {:>8}\n", "invariant", "failed", "worst / allowed", "  of", "scene");
    for (const std::string& name : invariant_names()) {
        const auto worst = c.worst.find(name);
        const auto broken = c.broken.find(name);
        if (worst == c.worst.end() && broken == c.broken.end()) continue;
        text += fmt::format("{:<10} {:>8} ", name, broken == c.broken.end() ? 0 : broken->second);
        text += worst == c.worst.end() ? std::string(16, ' ') + "\n"
                                       : fmt::format("{:>16.3g}   {:<14} {:>6}\n", worst->second.value,
                                                     word_of(worst->second.model), worst->second.n);
    }
    return text;
}

std::string json_of(const Campaign& c) {
    std::string worst, failures, mix;
    for (const auto& [name, value] : c.worst)
        worst += fmt::format("{}{{\"invariant\": {}, \"value\": {}, \"model\": \"{}\", \"scene\": {}}}",
                             worst.empty() ? "\n  " : ",\n  ", json_text(name), json_number(value.value),
                             word_of(value.model), value.n);
    for (const auto& [model, part] : c.mix)
        mix += fmt::format(
            "{}{{\"model\": \"{}\", \"scenes\": {}, \"refused\": {}, \"failed\": {}, \"steps\": {}, "
            "\"seconds\": {}}}",
            mix.empty() ? "\n  " : ",\n  ", word_of(model), part.scenes, part.refused, part.failed, part.steps,
            json_number(part.seconds));
    for (const Failure& failure : c.failures) failures += (failures.empty() ? "\n  " : ",\n  ") + json_of(failure);
    return fmt::format(
        "{{\"seed\": {}, \"first\": {}, \"scenes\": {}, \"refused\": {}, \"parted\": {}, \"steps\": {}, "
        "\"particle_steps\": {}, \"seconds\": {},\n\"mix\": [{}],\n\"worst\": [{}],\n\"failures\": [{}]}}\n",
        c.plan.seed, c.plan.first, c.scenes, c.refused, c.parted, c.steps, json_number(c.particle_steps),
        json_number(c.seconds), mix, worst, failures);
}

}  // namespace frana::fuzz
