#include "run/end_remarks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>

#include "observe/energy_made.h"
#include "run/simulation.h"

namespace frana {
namespace {

/// Energy that nothing gave: somewhere what moves is too fast.
void remark_on_energy(const RunSummary& summary, std::vector<EndRemark>& remarks) {
    constexpr double kMuch = 0.05;  // sound runs have 2 % at most
    const double made = budget(summary.first, summary.last).energy_residual,
                 share = share_made(summary.first, summary.last);
    if (!(share >= kMuch)) return;
    constexpr double kMost = 1e9;  // of a run that came apart; a row of it must have a number
    remarks.push_back(
        {fmt::format(
             "energy: found {:.3g} J that nothing gave, {:.3g} % of what friction took and motion had; expected "
             "none: something is too fast, as in pits and bends of one cell; look at the largest speeds, and "
             "give a smaller grid.cell",
             made, 100.0 * share),
         std::min(share, kMost)});
}

/// Virtual mass that grows while there is slip stores energy that nothing gave (src/water/THEORY.md, section 6).
void remark_on_virtual_mass(const std::optional<WaterBudget>& water, const RunSummary& summary,
                            std::vector<EndRemark>& remarks) {
    constexpr double kMuch = 0.01;
    const double stake = energy_at_stake(summary.first, summary.last), gained = water ? -water->drag : 0.0;
    if (!(stake > 0.0 && gained > kMuch * stake)) return;
    remarks.push_back(
        {fmt::format(
             "water.virtual_mass: motion got {:.3g} J by it beyond what drag took, {:.3g} % of what friction took "
             "and motion had; expected none: it grows where solids enter water; compare with \"none\"",
             gained, 100.0 * gained / stake),
         gained / stake});
}

/// Fixed ground does no work on 3D points, and what pushes them into the window next to none.
void remark_on_work_of_walls(const RunSummary& summary, std::vector<EndRemark>& remarks) {
    constexpr double kMuch = 0.05;  // sound runs have 3 % at most, such as of ground that is curved within few cells
    const double stake = energy_at_stake(summary.first, summary.last), gained = -summary.last.in_3d.walls;
    if (!(stake > 0.0 && gained > kMuch * stake)) return;
    remarks.push_back(
        {fmt::format(
             "3D points: got {:.3g} J from the ground, barriers and the particles around the window, {:.3g} % of what "
             "friction took and motion had; expected next to nothing: they are too fast, and forces on barriers may be "
             "too large; move an edge of stage.window that lies at a break of slope by some cells, or give a smaller "
             "stage.cell",
             gained, 100.0 * gained / stake),
         gained / stake});
}

/// A limit that nothing ever exceeded: footprint, arrival and runout are then of nothing.
void remark_on_footprint(const RunSummary& summary, std::vector<EndRemark>& remarks) {
    const Extremes& most = summary.extremes;
    if (!has_answer(summary.reason) || most.max_covered_area > 0.0 || !(most.max_depth > 0.0)) return;
    remarks.push_back({fmt::format(
        "output.footprint_depth: found a flow of {:.4g} m at most, nowhere deeper than that depth; expected "
        "some that is; the footprint is empty, so give a smaller output.footprint_depth",
        most.max_depth)});
}

bool is_digit(char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; }
bool is_of_word(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_'; }

/// Where a number ends that begins at `k`.
std::size_t end_of_number(const std::string& text, std::size_t k) {
    const auto digits = [&](std::size_t at) {
        while (at < text.size() && is_digit(text[at])) ++at;
        return at;
    };
    k = digits(k);
    if (k + 1 < text.size() && text[k] == '.' && is_digit(text[k + 1])) k = digits(k + 1);
    if (k + 1 < text.size() && text[k] == 'e') {
        const std::size_t sign = text[k + 1] == '+' || text[k + 1] == '-' ? 1 : 0;
        if (k + 1 + sign < text.size() && is_digit(text[k + 1 + sign])) k = digits(k + 1 + sign);
    }
    return k;
}

/// A remark without its numbers. What it is about stays: it may be a name with a number.
std::string without_numbers(const std::string& text) {
    const std::size_t colon = text.find(": ");
    std::size_t k = colon == std::string::npos ? 0 : colon;
    std::string kind = text.substr(0, k);
    while (k < text.size()) {
        if (!is_digit(text[k]) || (k > 0 && is_of_word(text[k - 1]))) {
            kind += text[k++];
            continue;
        }
        if (!kind.empty() && kind.back() == '-') kind.pop_back();
        kind += '#';
        k = end_of_number(text, k);
    }
    return kind;
}

}  // namespace

std::vector<EndRemark> remarks_at_end(const Simulation& simulation, const RunSummary& summary) {
    std::vector<EndRemark> remarks;
    for (std::string& text : simulation.remarks()) remarks.push_back({std::move(text)});
    remark_on_energy(summary, remarks);
    remark_on_virtual_mass(simulation.extras().water, summary, remarks);
    remark_on_work_of_walls(summary, remarks);
    remark_on_footprint(summary, remarks);
    return remarks;
}

std::string SharedRemark::sentence(Index of) const {
    const char* const which = runs == 1 ? "" : differs ? "worst in " : "such as ";
    return fmt::format("in {} of {} runs, {}sample {}: {}", runs, of, which, worst, text);
}

void RemarkTally::add(Index run, const std::vector<EndRemark>& remarks) {
    std::set<std::size_t> of_this_run;
    for (const EndRemark& remark : remarks) {
        const auto [found, is_new] = number_.emplace(without_numbers(remark.text), kinds_.size());
        if (is_new) kinds_.push_back({remark.text, 1, run}), worst_.push_back(remark.worse);
        const bool again = !of_this_run.insert(found->second).second;
        if (is_new) continue;
        SharedRemark& kind = kinds_[found->second];
        double& worst = worst_[found->second];
        if (!again) ++kind.runs;
        kind.differs = kind.differs || remark.worse != worst;
        if (remark.worse > worst) worst = remark.worse, kind.worst = run, kind.text = remark.text;
    }
}

std::vector<SharedRemark> RemarkTally::all() const {
    std::vector<SharedRemark> sorted = kinds_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.runs > b.runs; });
    return sorted;
}

std::vector<std::string> RemarkTally::sentences(Index of) const {
    constexpr std::size_t kShown = 20;
    const std::vector<SharedRemark> known = all();
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < std::min(kShown, known.size()); ++k) lines.push_back(known[k].sentence(of));
    if (known.size() > kShown)
        lines.push_back(fmt::format("{} more remarks, none on more runs than these", known.size() - kShown));
    return lines;
}

}  // namespace frana
