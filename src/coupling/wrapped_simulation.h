#pragma once
#include "run/simulation.h"

namespace frana {

/// A simulation that leaves its work to another one: what a derived class does not change goes through.
class WrappedSimulation : public Simulation {
public:
    void advance(double until) override { inner().advance(until); }
    const Status& status() const override { return inner().status(); }
    double longest_step() const override { return inner().longest_step(); }
    MovingMass motion(const MotionQuery& query) const override { return inner().motion(query); }
    Frame frame() override { return inner().frame(); }
    std::shared_ptr<const void> give_frame_away() override { return inner().give_frame_away(); }
    Sample at(const Vec2& point) const override { return inner().at(point); }
    const BarrierLoads* loads() const override { return inner().loads(); }
    std::vector<double> passed() const override { return inner().passed(); }
    bool may_rest() const override { return inner().may_rest(); }
    bool more_comes() const override { return inner().more_comes(); }
    std::string why_not_add(const Seeds& particles) const override { return inner().why_not_add(particles); }
    void add(const Seeds& particles) override { inner().add(particles); }
    const Raster* ground() const override { return inner().ground(); }
    const Friction* friction() const override { return inner().friction(); }
    std::vector<std::string> remarks() const override { return inner().remarks(); }
    Extras extras() const override { return inner().extras(); }
    std::vector<PhaseTime> timings() const override { return inner().timings(); }
    void serialize(Archive& archive) override { inner().serialize(archive); }

protected:
    /// The one that does the work; it may be another one after each step.
    virtual Simulation& inner() const = 0;
};

}  // namespace frana
