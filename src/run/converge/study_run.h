#pragma once
// A study of one case on several cells, from its plan to its verdict: all of `frana converge` but its command line.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/converge/study.h"
#include "run/folder/run_case.h"
#include "run/folder/run_lock.h"
#include "scene/scene.h"

namespace frana {

/// A key of the case that is varied on the finest cell.
struct VariedKey {
    std::string key;
    std::string folder;  ///< its runs lie in `folder`_VALUE
    std::vector<double> values;
};

struct StudyWishes {
    std::filesystem::path case_file;
    std::filesystem::path out;      ///< empty: out/<case name>_converge
    std::vector<std::string> sets;  ///< "key=value" overrides of all runs
    std::vector<double> cells;      ///< two or more, coarse to fine [m]
    std::vector<VariedKey> varied;
    bool resume = false;     ///< take finished runs as they are, and go on with the others
    bool overwrite = false;  ///< replace the files of an earlier study
};

/// A run that a study needs.
struct PlannedRun {
    double cell = 0.0;  ///< [m]
    std::string name;   ///< for people
    RunWishes wishes;
    bool finished = false;  ///< it is there, and need not be carried out
};

class StudyRun {
public:
    /// Plans the runs, and builds all their scenes. What is wrong with the finest must not show after hours on the
    /// others. Finished runs must be of this very case. Then makes room in the folder, and holds it. Throws UserError.
    explicit StudyRun(StudyWishes wishes);

    const std::filesystem::path& folder() const { return wishes_.out; }
    /// The cells, coarse to fine, then what is varied on the finest.
    const std::vector<PlannedRun>& runs() const { return runs_; }

    /// Once all runs are finished: measures and judges them, and writes the tables. Throws UserError.
    ConvergenceStudy judge() const;

private:
    void check_scenes();
    Raster bed_of_finest() const;

    StudyWishes wishes_;
    std::vector<std::string> remarks_;
    std::optional<RunLock> lock_;
    std::vector<PlannedRun> runs_;
    Raster bed_;                                 ///< of the finest run's scene
    std::shared_ptr<const WiderTerrain> wider_;  ///< of which it may be a part
};

}  // namespace frana
