#pragma once
// RUN_DIR/checkpoint.h5: when it is written, where it is from, and whether a run may go on from it.
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/checkpoint_file.h"
#include "run/state_keeper.h"
#include "scene/case_file.h"
#include "scene/scene.h"

namespace frana {

/// What a state must agree with to be resumed: version, precision, the case with all its keys, and checksums. The
/// checksums are of the files that the case names, of bed and particles. The build need not agree.
CheckpointLabels checkpoint_labels(const Scene& scene, const CaseFile& file);

/// Opens the state in a run folder and holds it against `labels`. Throws UserError with the reason when there is none,
/// when it is damaged, or of another version, precision or case. The reason names the first key that differs, or the
/// file.
std::unique_ptr<CheckpointFile> open_checkpoint(const std::filesystem::path& run_dir, const CheckpointLabels& labels);

/// Saves a run's states in its folder: every `interval` of wall time and at its end.
class CheckpointKeeper final : public StateKeeper {
public:
    /// `from`: the state to go on from, or nullptr. An interval of zero: only at the end.
    CheckpointKeeper(const std::filesystem::path& run_dir, CheckpointLabels labels,
                     std::chrono::duration<double> interval, std::unique_ptr<CheckpointFile> from);
    bool due() const override;
    /// Before the state the files that it builds on are written to the disk.
    void save(double time, const State& state) override;
    /// Once the state is taken up, what the earlier run left at its end is removed.
    bool load(const State& state) override;

    /// How often, over all runs that led here.
    struct Progress {
        double time = 0.0;  ///< of the state [s]
        Index written = 0, failed = 0;
        std::string first_failure;
        std::vector<double> resumed_at;  ///< [s]
        void serialize(Archive& archive);
    };
    const Progress& progress() const { return progress_; }
    /// States that could not be saved, and a build that changed, a sentence each.
    std::vector<std::string> warnings() const;

private:
    void flush_new_files();

    std::filesystem::path run_dir_;
    CheckpointLabels labels_;
    std::chrono::duration<double> interval_;
    std::unique_ptr<CheckpointFile> from_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    std::filesystem::file_time_type flushed_ = std::filesystem::file_time_type::min();
    Progress progress_;
    std::string other_build_;
};

}  // namespace frana
