#pragma once
// One case on several cells, as its run folders tell: figures, table, page and picture.
#include <filesystem>
#include <string>
#include <vector>

#include "compare/refinement.h"
#include "terrain/raster.h"

namespace frana {

/// A run of the study.
struct StudiedRun {
    double cell = 0.0;             ///< [m]
    std::filesystem::path folder;  ///< of the run
};

/// A key of the case varied on the finest cell.
struct Variation {
    std::string key;
    std::vector<double> values;
    std::vector<std::filesystem::path> folders;  ///< of the runs
    std::vector<CellFigures> figures;
    std::string sentence;  ///< how far they lie apart
};

struct ConvergenceStudy {
    std::filesystem::path folder;  ///< of the tables
    std::string title, case_file, overrides;
    std::vector<StudiedRun> runs;  ///< coarse to fine
    std::vector<CellFigures> figures;
    std::vector<std::string> ends;  ///< why each run ended
    std::vector<double> left;       ///< of each run, share that left the terrain where it is worth a remark, or 0 [1]
    std::vector<Variation> variations;
    bool along_path = true;        ///< runouts are; else they are straight reaches, and a remark says why
    double footprint_depth = 0.1;  ///< [m]
    ConvergenceRule rule;
    Verdict verdict;
    std::vector<std::string> remarks;
    std::vector<std::string> files;  ///< that write_study() made, in the folder
};

/// Fills in what the run folders tell, and judges it. `bed`: of the finest run, for the path along which all runouts
/// are measured. Throws UserError when a folder lacks a raster or its run.json.
void measure_runs(ConvergenceStudy& study, const Raster& bed);

/// Names of the files that a study may leave in its folder besides those of its runs.
const std::vector<std::string>& study_files();

/// Writes them: converge.png (a remark where it cannot be drawn), converge.md, converge.json. Throws UserError.
void write_study(ConvergenceStudy& study);

/// The table with the verdict, for people.
std::string study_section(const ConvergenceStudy& study);

}  // namespace frana
