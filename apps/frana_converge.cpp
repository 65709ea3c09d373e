// `frana converge CASE --cells N,N,...`: the same case on several cells, each in a run folder of its own.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <iostream>
#include <sstream>

#include "base/error.h"
#include "frana_commands.h"
#include "run/converge/study_run.h"
#include "run/interrupt.h"

namespace frana {
namespace {

/// A list on the command line: two or more different numbers above 0, from large to small.
struct NumberList {
    const char *option, *meaning, *example;
    std::vector<double> read(const std::string& text) const;
};

std::vector<double> NumberList::read(const std::string& text) const {
    const auto complain = [&](const std::string& what) {
        return UserError(fmt::format("{}: {}; expected two or more different {}, each above 0; write them like {}",
                                     option, what, meaning, example));
    };
    std::vector<double> numbers;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
        word.erase(std::remove(word.begin(), word.end(), ' '), word.end());
        double value = 0.0;
        const char* end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, value);
        if (read.ec != std::errc() || read.ptr != end || !(value > 0.0 && value < 1e300))
            throw complain(fmt::format("found \"{}\"", word));
        numbers.push_back(value);
    }
    std::sort(numbers.begin(), numbers.end(), std::greater<>());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    if (numbers.size() < 2) throw complain(fmt::format("found \"{}\"", text));
    return numbers;
}

/// What is varied on the finest cell.
std::vector<VariedKey> read_varied(const ConvergeOptions& options) {
    std::vector<VariedKey> all;
    const auto take = [&](const std::string& text, const char* key, const char* folder, const NumberList& list) {
        if (text.empty()) return;
        all.push_back({key, folder, list.read(text)});
        std::reverse(all.back().values.begin(), all.back().values.end());
    };
    take(options.per_cell, "particles.per_cell", "per_cell", {"--per-cell", "numbers of particles a cell", "4,9,16"});
    take(options.cfl, "scheme.cfl", "cfl", {"--cfl", "parts of a cell", "0.5,0.25,0.12"});
    return all;
}

StudyWishes wishes_of(const ConvergeOptions& options) {
    StudyWishes wishes{options.case_file, options.out, options.sets, {}, {}, options.resume, options.overwrite};
    wishes.cells = NumberList{"--cells", "cells in metres", "10,5,2.5"}.read(options.cells);
    wishes.varied = read_varied(options);
    return wishes;
}

RunOptions options_of(const PlannedRun& run, const ConvergeOptions& study, const Interrupt& interrupt) {
    RunOptions options;
    options.case_file = study.case_file;
    options.out = run.wishes.out, options.sets = run.wishes.sets;
    options.resume = run.wishes.resume, options.overwrite = run.wishes.overwrite;
    options.threads = study.threads, options.quiet = study.quiet;
    options.interrupt = &interrupt;
    return options;
}

/// 0 when all runs are finished, 130 when one was interrupted.
int carry_out(const std::vector<PlannedRun>& runs, const ConvergeOptions& options) {
    const Interrupt interrupt(Interrupt::Listen::signals);
    for (const PlannedRun& run : runs) {
        if (run.finished) {
            if (!options.quiet) std::cout << fmt::format("{}: finished, in {}\n", run.name, run.wishes.out.string());
            continue;
        }
        const int code = interrupt.requested() ? 130 : run_command(options_of(run, options, interrupt));
        if (code != 0 || interrupt.requested()) {
            if (!options.quiet) std::cout << "interrupted; --resume goes on where the study stopped\n";
            return code != 0 ? code : 130;
        }
    }
    return 0;
}

}  // namespace

int converge_command(const ConvergeOptions& options) {
    const StudyWishes wishes = wishes_of(options);
    if (options.threads > 0) omp_set_num_threads(options.threads);
    const StudyRun run(wishes);
    if (const int code = carry_out(run.runs(), options)) return code;
    const ConvergenceStudy study = run.judge();
    std::cout << '\n' << study_section(study);
    for (const std::string& name : study.files) std::cout << (run.folder() / name).string() << '\n';
    return 0;
}

}  // namespace frana
