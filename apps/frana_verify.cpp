// `frana verify`: runs problems with exact answers and prints what the scheme makes of them.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <omp.h>

#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/version.h"
#include "checks/verify/library.h"
#include "checks/verify/table.h"
#include "frana_commands.h"
#include "frana_verify_figure.h"
#include "scene/parameters.h"

namespace frana {
namespace {

using verify::Measurement;
using verify::Problem;

std::vector<const Problem*> chosen(const std::vector<std::string>& names) {
    std::vector<const Problem*> problems;
    for (const std::string& name : names) {
        problems.push_back(verify::find_problem(name));
        if (problems.back()) continue;
        std::vector<std::string> known;
        for (const Problem& problem : verify::library()) known.push_back(problem.name);
        for (const verify::Alias& alias : verify::aliases()) known.push_back(alias.name);
        const std::string near = closest(name, known);
        throw UserError(
            fmt::format("command line: found the unknown problem \"{}\"; expected one that `frana verify "
                        "--list` names; {}",
                        name, near.empty() ? "see the list" : "did you mean " + near + "?"));
    }
    if (names.empty())
        for (const Problem& problem : verify::library()) problems.push_back(&problem);
    return problems;
}

/// Points a cell and direction; 0 where a problem cannot have so many points a cell.
int points_per_side(const Problem& problem, int per_cell) {
    const double root = problem.in_3d ? std::cbrt(per_cell) : std::sqrt(per_cell);
    const int per_side = static_cast<int>(std::lround(root));
    return per_cell == (problem.in_3d ? per_side * per_side * per_side : per_side * per_side) ? per_side : 0;
}

/// Named problems that cannot have the points a cell that were asked for are refused before any of them runs.
void require_points(const std::vector<const Problem*>& problems, const VerifyOptions& options) {
    if (options.names.empty() || options.per_cell == 0) return;
    for (const Problem* problem : problems)
        if (points_per_side(*problem, options.per_cell) == 0)
            throw UserError(fmt::format("--points: found {}; expected {} for {}; choose one of them", options.per_cell,
                                        problem->in_3d ? "1, 8, 27 or 64" : "1, 4, 9 or 16", problem->name));
}

void print_list() {
    for (const Problem& problem : verify::library())
        fmt::print("{:18} {}{}\n", problem.name, problem.title, problem.takes_minutes ? " (minutes; when named)" : "");
    for (const verify::Alias& alias : verify::aliases())
        fmt::print("{:18} stands for {}: {}\n", alias.name, fmt::join(alias.problems, ", "), alias.title);
}

/// Equations of the exact answer that it fails to satisfy.
std::vector<std::string> wrong_references(const Problem& problem) {
    std::vector<std::string> wrong;
    if (!problem.residuals) return wrong;
    for (const verify::Residual& r : problem.residuals())
        if (!(std::abs(r.value) <= r.bound))
            wrong.push_back(
                fmt::format("{}: the exact answer fails its own check: {} is {:.3g}, at most {:.3g} is "
                            "allowed",
                            problem.name, r.what, r.value, r.bound));
    return wrong;
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

/// Runs one problem, prints its rows and adds them to the table, gates that it misses below them.
std::vector<Measurement> run_problem(const Problem& problem, const verify::Setup& setup,
                                     const std::vector<Index>& grids, std::string& table,
                                     std::vector<std::string>& complaints) {
    for (std::string& text : wrong_references(problem)) complaints.push_back(std::move(text));
    auto measured = verify::measure(problem, setup, grids);
    for (const Measurement& m : measured) {
        fmt::print("{}\n", verify::table_row(m, true));
        table += verify::table_row(m, false) + "\n";
    }
    std::fflush(stdout);
    for (std::string& text : verify::missed_gates(problem, measured)) {
        table += "missed: " + text + "\n";
        complaints.push_back(std::move(text));
    }
    return measured;
}

/// Whether a line of a table is about a grid that is left out. Rows begin with the problem, the preset and the cells; lines
/// of gates go on "PROBLEM at CELLS cells".
bool left_out(const std::string& line) {
    std::istringstream words(line);
    std::string name, between;
    Index cells = 0;
    words >> name;
    if (name == "missed:") words >> name;
    words >> between >> cells;
    const Problem* problem = verify::find_problem(name);
    return problem && problem->finest_is_long && cells == problem->grids.back();
}

/// Lines of a table that are about these problems, problem by problem; all as they stand without any names.
std::string lines_of(std::istream& table, const std::vector<std::string>& names, bool coarse) {
    std::map<std::string, std::string> kept;
    for (std::string line; std::getline(table, line);) {
        if (coarse && left_out(line)) continue;
        std::istringstream words(line);
        std::string name;
        words >> name;
        if (name == "missed:") words >> name;
        kept[names.empty() ? "" : name] += line + "\n";
    }
    std::string all = kept[""];
    for (const std::string& name : names) all += kept[name];
    return all;
}

/// Prints how the table differs from an earlier one, in the lines of the problems and grids that ran. Returns 1 when it
/// does.
int compare(const std::string& table, const VerifyOptions& options) {
    constexpr double tolerance = 0.05;  // another compiler's round-off, grown by splitting; not another scheme
    std::ifstream file(options.against);
    std::istringstream now(table);
    const auto found = verify::differences(lines_of(now, options.names, false),
                                           lines_of(file, options.names, options.coarse), tolerance);
    for (const std::string& text : found) fmt::print(stderr, "{}\n", text);
    fmt::print("{} lines differ from {}\n", found.size(), options.against.string());
    return found.empty() ? 0 : 1;
}

}  // namespace

int verify_command(const VerifyOptions& given) {
    VerifyOptions options = given;
    options.names = verify::without_aliases(given.names);
    if (options.list) {
        print_list();
        return 0;
    }
    if (options.threads > 0) omp_set_num_threads(options.threads);
    if (options.study) {
        print_study(options.table);
        return 0;
    }
    const std::vector<const Problem*> problems = chosen(options.names);
    if (!options.figure.empty() && !options.names.empty() && draws_blocks(problems)) {
        draw_blocks(problems, options.figure);
        return 0;
    }
    if (!options.figure.empty()) {
        draw_work_precision(options.names.empty() ? std::vector<const Problem*>{} : problems, options.figure);
        return 0;
    }
    require_points(problems, options);
    verify::Setup setup;
    setup.preset = options.preset;
    const std::vector<Index> grids(options.cells.begin(), options.cells.end());
    const std::string head = verify::table_head();
    std::string table = fmt::format("# frana {} {}, {}\n{}\n", FRANA_VERSION, FRANA_COMMIT, today(), head);
    std::vector<Measurement> all;
    std::vector<std::string> complaints;
    fmt::print("{}\n", head);
    for (const Problem* problem : problems) {
        if (problem->takes_minutes && options.names.empty()) continue;
        if (options.per_cell > 0) setup.per_side = points_per_side(*problem, options.per_cell);
        if (setup.per_side == 0) continue;
        if ((problem->in_3d || !problem->has_presets) && options.names.empty() && options.preset != "default") continue;
        const auto measured = run_problem(
            *problem, setup, grids.empty() ? verify::grids_of(*problem, options.coarse) : grids, table, complaints);
        all.insert(all.end(), measured.begin(), measured.end());
    }
    if (!options.json.empty()) write_text(options.json, verify::json_of(all));
    if (!options.table.empty()) write_text(options.table, table);
    for (const std::string& text : complaints) fmt::print(stderr, "{}\n", text);
    if (!options.against.empty()) return compare(table, options);
    return complaints.empty() ? 0 : 1;
}

}  // namespace frana
