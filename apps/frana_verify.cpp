// `frana verify`: runs problems with exact answers and prints what the scheme makes of them.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/version.h"
#include "frana_commands.h"
#include "frana_verify_figure.h"
#include "scene/parameters.h"
#include "verify/library.h"
#include "verify/table.h"

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
        const std::string near = closest(name, known);
        throw UserError(fmt::format("command line: found the unknown problem \"{}\"; expected one that `frana verify "
                                    "--list` names; {}",
                                    name, near.empty() ? "see the list" : "did you mean " + near + "?"));
    }
    if (names.empty())
        for (const Problem& problem : verify::library()) problems.push_back(&problem);
    return problems;
}

void print_list() {
    for (const Problem& problem : verify::library()) fmt::print("{:18} {}\n", problem.name, problem.title);
}

/// Equations of the exact answer that it fails to satisfy.
std::vector<std::string> wrong_references(const Problem& problem) {
    std::vector<std::string> wrong;
    if (!problem.residuals) return wrong;
    for (const verify::Residual& r : problem.residuals())
        if (!(std::abs(r.value) <= r.bound))
            wrong.push_back(fmt::format("{}: the exact answer fails its own check: {} is {:.3g}, at most {:.3g} is "
                                        "allowed",
                                        problem.name, r.what, r.value, r.bound));
    return wrong;
}

}  // namespace

int verify_command(const VerifyOptions& options) {
    if (options.list) {
        print_list();
        return 0;
    }
    if (options.threads > 0) omp_set_num_threads(options.threads);
    if (options.study) {
        print_study(options.table);
        return 0;
    }
    if (!options.figure.empty()) {
        draw_work_precision(options.names.empty() ? std::vector<const Problem*>{} : chosen(options.names), options.figure);
        return 0;
    }
    verify::Setup setup;
    setup.preset = options.preset;
    setup.per_side = static_cast<int>(std::lround(std::sqrt(options.per_cell)));
    const std::string head = verify::table_head();
    std::string table = "frana " FRANA_VERSION "\n" + head + "\n";
    std::vector<Measurement> all;
    std::vector<std::string> complaints;
    fmt::print("{}\n", head);
    for (const Problem* problem : chosen(options.names)) {
        for (std::string& text : wrong_references(*problem)) complaints.push_back(std::move(text));
        const std::vector<Index> grids(options.cells.begin(), options.cells.end());
        const auto measured = verify::measure(*problem, setup, grids.empty() ? problem->grids : grids);
        for (const Measurement& m : measured) {
            fmt::print("{}\n", verify::table_row(m, true));
            table += verify::table_row(m, false) + "\n";
        }
        std::fflush(stdout);
        for (std::string& text : verify::missed_gates(*problem, measured)) complaints.push_back(std::move(text));
        all.insert(all.end(), measured.begin(), measured.end());
    }
    if (!options.json.empty()) write_text(options.json, verify::json_of(all));
    if (!options.table.empty()) write_text(options.table, table);
    for (const std::string& text : complaints) fmt::print(stderr, "{}\n", text);
    return complaints.empty() ? 0 : 1;
}

}  // namespace frana
