#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "observe/observer.h"
#include "observe/table.h"

namespace frana {

/// A barrier's name, and the times over which its force is averaged [s].
struct NamedBarrier {
    std::string name;
    std::vector<double> windows;
};

/// The largest horizontal force on a barrier as a mean over a time. Before the start there is no force. Nodes press
/// for what is a cell away. What they did before the first contact is counted in full, and dated to that.
struct MeanForce {
    double window = 0.0;   ///< [s]
    double largest = 0.0;  ///< [N]
    double time = 0.0;     ///< end of the time that it is the mean of, or the first contact if that is later [s]
    Vec3 force{0, 0, 0};   ///< then [N]
    Vec3 moment{0, 0, 0};  ///< then, about BarrierSummary::about [N m]
};

/// What a run did to a barrier.
struct BarrierSummary {
    std::string name;
    double first_contact =
        -1.0;  ///< [s]; -1: never. When points are at a face or, with particles alone, by the depth there
    double peak_force = 0.0;       ///< largest horizontal force, mean over `blur` [N]
    double peak_force_time = 0.0;  ///< end of that interval, or the first contact if that is later [s]
    double raw_peak_force = 0.0;   ///< largest of a single step: as hard as the artificial sound is fast [N]
    double blur = 0.0;             ///< [s]
    Vec3 impulse{0, 0, 0};         ///< since the start [kg m/s]
    Vec3 about{0, 0, 0};           ///< place that moments are about [m]
    double run_up = std::numeric_limits<double>::quiet_NaN();  ///< as in BarrierLoad [m]
    double overtopped = 0.0;                                   ///< material that was over it at any time [m3]
    std::vector<MeanForce> means;                              ///< for each window of the barrier
};

/// When forces end, at what, and what would make that later.
struct ForcesEnd {
    double time = 0.0;  ///< [s]
    std::string at, later;
};

/// A remark on each barrier whose largest mean over its longest window ends within that window of the end of forces: it
/// may have been rising still. And on each that was reached when forces had ended.
std::vector<std::string> remarks_on_rising(const std::vector<BarrierSummary>& barriers, const ForcesEnd& end);

/// More barriers than these have no table of their own: opening hundreds at every output costs more than steps do.
inline constexpr std::size_t kMostBarrierTables = 24;

/// barriers/<name>.csv: forces and moments on each barrier after every step, means over the step; appended at
/// every output. Columns: t [s], fx, fy, fz [N], mx, my, mz [N m], mean_force [N] (horizontal, mean over
/// `blur` up to now), run_up [m] and overtopped [m3]. Then come f0x, f0y, f0z [N], m0x, m0y, m0z [N m] of face 0, and
/// so on. Where no forces are known (particles alone) t, run_up and overtopped. More than kMostBarrierTables barriers,
/// which particles alone can have, leave their summaries only.
class Barriers final : public Observer {
public:
    Barriers(std::filesystem::path run_dir, const std::vector<NamedBarrier>& barriers,
             std::vector<BarrierSummary>& summaries);
    std::string name() const override { return "barriers"; }
    void step(const Status& now, const Probe& probe) override;
    void observe(const Frame& frame) override;
    bool looks_at_fields() const override { return false; }
    void serialize(Archive& archive) override;

private:
    /// What a barrier has got up to a time, for means.
    struct Received {
        double time = 0.0;
        Vec3 impulse{0, 0, 0}, moment{0, 0, 0};  ///< [N s], [N m s]
    };
    struct Watched {
        std::vector<FaceLoad> before;
        std::vector<Received> lately;  ///< from `first` on as old as the longest mean needs, and one before
        std::size_t first = 0;
    };
    void begin(const BarrierLoads& loads);
    bool has_tables() const { return names_.size() <= kMostBarrierTables; }
    void step_without_forces(const BarrierLoads& loads);
    void step_without_force(std::size_t n, double time, const BarrierLoad& load);
    void take(std::size_t n, const BarrierLoad& load);
    static void note_contact(BarrierSummary& summary, double time);
    void serialize_without_tables(Archive& archive);
    static double note_means(Watched& watched, const Received& now, double blur, std::vector<MeanForce>& means);
    static MeanForce mean_over(const Watched& watched, double window);
    static void serialize_lately(Archive& archive, Watched& watched);

    std::filesystem::path run_dir_;
    std::vector<std::string> names_;
    std::vector<BarrierSummary>& summaries_;
    std::vector<TableWriter> tables_;
    std::vector<Watched> watched_;
    double time_ = 0.0;
};

}  // namespace frana
