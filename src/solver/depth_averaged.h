#pragma once
// The depth-averaged material point method: scheme S2 on steep, curved terrain, or the choices of Fois et al. 2024.
#include <chrono>
#include <memory>
#include <optional>

#include "solver/kick.h"
#include "solver/mass_fit.h"
#include "solver/merge.h"
#include "solver/peaks.h"
#include "solver/simulation.h"
#include "solver/split.h"
#include "solver/surface.h"
#include "solver/transfer.h"

namespace frana {

/// Wall time of the named phases of a step.
class StepClock {
public:
    template <class Body>
    auto operator()(const char* phase, Body&& body) {
        const Lap lap(*this, phase);
        return body();
    }
    std::vector<PhaseTime> times() const { return times_; }

private:
    struct Lap {
        StepClock& clock;
        const char* phase;
        std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
        Lap(StepClock& c, const char* p) : clock(c), phase(p) {}
        ~Lap() { clock.add(phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()); }
    };
    void add(const char* phase, double seconds);
    std::vector<PhaseTime> times_;
};

class DepthAveraged final : public Simulation {
public:
    explicit DepthAveraged(const Scene& scene);

    void advance(double until) override;
    const Status& status() const override { return status_; }
    bool at_rest() const override;
    Frame frame() override;
    std::vector<PhaseTime> timings() const override { return timed_.times(); }
    Sample at(const Vec2& point) const override;
    std::vector<std::string> remarks() const override;

    const Flow& flow() const { return flow_; }
    /// What the fit of initial masses did; nothing when there was none.
    const std::optional<MassFit>& mass_fit() const { return fit_; }

private:
    void place(const Seeds& seeds);
    void level_points(double level);
    void arrive(const PointSums& points);
    void adapt_points(bool points_left);
    double longest_step() const;
    double step_length(double until) const;
    void book_kick(const KickSums& sums, double kick);
    void book_points(const PointSums& sums);
    void require_sound(const PointSums& sums) const;

    void particle_fields(Frame& frame);
    void node_fields(Frame& frame);
    void stress_fields(Frame& frame);
    Field& add_field(std::vector<Field>& fields, const char* name, const char* unit, int components, Index count);

    Flow flow_;
    std::unique_ptr<TransferKernel> transfer_;
    std::unique_ptr<KickKernel> kick_;
    Splitter splitter_;
    std::optional<Merger> merger_;  ///< nothing when the scheme does not merge
    TileSorter sorter_;
    Peaks peaks_;
    StepClock timed_;
    Status status_;
    std::optional<MassFit> fit_;

    Rheology rheology_;
    bool steep_, curved_;
    double footprint_depth_, rest_fraction_;
    std::array<double, 2> start_momentum_{};  ///< [kg m/s]
    double signal_ = 0.0;       ///< largest |v| + sqrt(g_c h) seen in the last step [m/s]
    double drift_ = 0.0;        ///< largest distance since the last sort [cells]
    double peak_mean_speed_ = 0.0;
    double stress_power_ = 0.0; ///< of the present deposit [W]
    Vec2 centre_{0, 0};         ///< of the release [cells]

    TransferKernel::Probe probe_;
    std::vector<std::vector<double>> frame_storage_;  ///< what the last frame's fields point to
};

}  // namespace frana
