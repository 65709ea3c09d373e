// `frana stress`: random hostile scenes under watch; what fails is shrunk and saved as a case.
#include <fmt/core.h>

#include <fstream>
#include <set>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "checks/fuzz/campaign.h"
#include "checks/fuzz/draw.h"
#include "frana_commands.h"
#include "frana_fuzz_figure.h"
#include "frana_fuzz_save.h"
#include "io/gdal_reader.h"
#include "run/interrupt.h"
#include "scene/build_scene.h"

namespace frana {
namespace {

std::string text_of(const fuzz::Violation& broken) {
    return fmt::format("{} at step {}, t = {:.6g} s: {}", broken.invariant, broken.step, broken.time, broken.text);
}

/// A case file under watch. 1 when it breaks an invariant.
int watch_case(const FuzzOptions& options) {
    fuzz::Claims claims;
    claims.rests = options.rests;
    claims.threads = options.same_threads;
    claims.resumes = options.same_resumed;
    claims.mirror = fuzz::mirror_of(options.mirror);
    const Scene scene = build_scene(CaseFile::read(options.case_file), GdalReader());
    const fuzz::Verdict verdict = examine(scene, claims, options.steps);
    fmt::print("{}: {} steps, {:.6g} s, up to {} particles\n", options.case_file.string(), verdict.steps, verdict.time,
               verdict.particles);
    for (const auto& [invariant, worst] : verdict.worst)
        fmt::print("{:<10} {:>12.3g} of what is allowed\n", invariant, worst);
    if (verdict.broken) fmt::print(stderr, "{}\n", text_of(*verdict.broken));
    return verdict.broken ? 1 : 0;
}

int map_cfl(const FuzzOptions& options) {
    std::vector<fuzz::CflRow> rows;
    for (const fuzz::Method& method : fuzz::cfl_methods()) {
        rows.push_back(cfl_row(method));
        fmt::print(stderr, "{}, {} points: {} ({})\n", method.name(), method.per_side * method.per_side,
                   rows.back().largest, rows.back().first_broken);
    }
    fmt::print("{}", cfl_table(rows));
    if (!options.figure.empty()) draw_cfl_map(rows, options.figure);
    return 0;
}

/// Saves what was shrunk, and says what became of it.
void report(const fuzz::Failure& failure, const FuzzOptions& options) {
    fmt::print(stderr, "{} scene {}: {}\n", word_of(failure.model), failure.n, text_of(failure.found));
    const fuzz::Shrunk& shrunk = failure.shrunk;
    if (shrunk.trials == 0 || !shrunk.verdict.broken) return;
    const std::filesystem::path folder =
        options.out / fmt::format("stress-{}-{}-{}", word_of(failure.model), options.seed, failure.n);
    save_draft(folder, shrunk.draft, *shrunk.verdict.broken);
    fmt::print(stderr, "  shrunk in {} trials to {} particles, {} steps: frana stress --case {}/case.toml {}\n",
               shrunk.trials, shrunk.verdict.particles, shrunk.draft.steps, folder.string(),
               replay_options(shrunk.draft));
}

/// Failures by seed, model, scene and invariant, a line each; # begins a comment.
std::set<std::string> known_failures(const std::filesystem::path& file) {
    std::set<std::string> known;
    if (file.empty()) return known;
    std::ifstream in(file);
    if (!in)
        throw UserError(fmt::format(
            "{}: cannot be read; expected lines of SEED MODEL SCENE INVARIANT; give another --known", file.string()));
    for (std::string line; std::getline(in, line);)
        if (!line.empty() && line[0] != '#') known.insert(line);
    return known;
}

/// Failures that the list of known ones does not hold; says of known ones when they are mended.
Index new_failures(const fuzz::Campaign& campaign, std::set<std::string> known, const FuzzOptions& options) {
    Index found = 0;
    for (const fuzz::Failure& failure : campaign.failures)
        if (known.erase(fmt::format("{} {} {} {}", options.seed, word_of(failure.model), failure.n,
                                    failure.found.invariant)) == 0)
            ++found;
    for (const std::string& mended : known) {
        unsigned long long seed = 0, n = 0;
        std::string model;
        std::istringstream(mended) >> seed >> model >> n;
        const bool ran = seed == campaign.plan.seed && n >= campaign.plan.first &&
                         n < campaign.plan.first + static_cast<unsigned long long>(campaign.scenes) &&
                         model == word_of(model_of(campaign.plan.models, seed, n));
        if (ran)
            fmt::print(stderr, "{}: {} does not fail any more; take the line out\n", options.known.string(), mended);
    }
    return found;
}

}  // namespace

int fuzz_command(const FuzzOptions& options) {
    if (!options.case_file.empty()) return watch_case(options);
    if (options.cfl_map) return map_cfl(options);
    fuzz::Plan plan;
    plan.models = fuzz::models_of(options.models);
    plan.seed = static_cast<std::uint64_t>(options.seed);
    plan.first = static_cast<std::uint64_t>(options.first);
    plan.scenes = options.scenes;
    plan.seconds = options.seconds;
    plan.most_shrunk = options.shrunk;
    const std::set<std::string> known = known_failures(options.known);  // before the work: it may be no file
    const Interrupt interrupt(Interrupt::Listen::signals);
    const fuzz::Campaign campaign = run(
        plan, [&](const fuzz::Failure& failure) { report(failure, options); }, [&] { return interrupt.requested(); });
    fmt::print("{}", table_of(campaign));
    if (!options.json.empty()) write_text(options.json, json_of(campaign));
    if (interrupt.requested()) throw Interrupted("interrupted; the scenes so far are above");
    return new_failures(campaign, known, options) == 0 && campaign.refused == 0 ? 0 : 1;
}

}  // namespace frana
