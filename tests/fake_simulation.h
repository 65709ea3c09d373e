#pragma once
// A "simulation" whose every number is known: a Gaussian hill of material slides over a plane at constant
// velocity.
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.h"
#include "run/simulation.h"

namespace frana {

struct FakeScript {
    double dt = 0.03;                                             ///< longest step [s]
    double rest_time = std::numeric_limits<double>::infinity();   ///< nothing moves from here on [s]
    double leave_time = std::numeric_limits<double>::infinity();  ///< no particles from here on [s]
    double fail_time = std::numeric_limits<double>::infinity();   ///< NumericsError past here [s]
    bool fail_with_nan = false;                                   ///< ... and the state is not finite
    std::function<void(Index)> on_step;                           ///< called with each new step's number
    double front_turns = std::numeric_limits<double>::max();      ///< the front draws back from here on [s]
    bool tells_step = false;                                      ///< its longest_step() is `dt`
};

class FakeSimulation : public Simulation {
public:
    static constexpr double density = 1000.0, gravity = 9.81, height = 2.0, width = 3.0, u = 1.5, v = -0.5;
    static constexpr double kSteep = 1.25;    ///< speed along the bed over that along the map
    static constexpr double threshold = 0.1;  ///< depth that counts as arrived [m]

    explicit FakeSimulation(FakeScript script = {}) : script_(std::move(script)) {
        grid_ = {41, 31, 1000.5, 2000.5, 1.0};
        const auto nodes = static_cast<std::size_t>(grid_.size());
        for (auto* field : {&elevation_, &depth_, &surface_, &speed_, &peak_depth_, &peak_speed_, &peak_pressure_})
            field->assign(nodes, 0.0);
        arrival_.assign(nodes, -1.0);  // never
        velocity_.assign(3 * nodes, 0.0);
        for (int k = 0; k < 25; ++k) start_.emplace_back(1008.0 + k % 5, 2018.0 + k / 5);
        update();
    }

    static double bed(const Vec2& p) { return 500.0 + 0.1 * (p.x() - 1000.0) - 0.05 * (p.y() - 2000.0); }
    static Vec2 centre(double t) { return Vec2(1010.0 + u * t, 2020.0 + v * t); }
    static double depth(const Vec2& p, double t) {
        return height * std::exp(-(p - centre(t)).squaredNorm() / (2.0 * width * width));
    }

    void advance(double until) override {
        if (status_.time >= script_.fail_time) {
            if (script_.fail_with_nan) status_.kinetic = std::numeric_limits<double>::quiet_NaN();
            throw NumericsError("step 7: the depth of particle 3 is not finite");
        }
        status_.dt = std::min(script_.dt, until - status_.time);
        status_.time = until - status_.time <= script_.dt ? until : status_.time + script_.dt;
        ++status_.step;
        update();
        if (script_.on_step) script_.on_step(status_.step);
    }
    const Status& status() const override { return status_; }
    double longest_step() const override { return script_.tells_step ? script_.dt : 0.0; }
    MovingMass motion(const MotionQuery& query) const override {
        const bool moving = status_.max_speed > query.faster_than;
        return {status_.mass, moving ? status_.mass : 0.0, status_.max_speed, 0};
    }
    std::vector<PhaseTime> timings() const override { return {{"deposit", 0.25}, {"grid update", 0.5}}; }
    void serialize(Archive& archive) override {
        frana::serialize(archive, "status", status_);
        for (const auto& [name, peak] : {std::pair{"depth", &peak_depth_},
                                         {"speed", &peak_speed_},
                                         {"pressure", &peak_pressure_},
                                         {"arrival", &arrival_}})
            archive.array(name, *peak);
        if (archive.loading()) update();
    }
    Sample at(const Vec2& p) const override {
        return {bed(p), depth(p, status_.time), Vec2(u, v), kSteep * std::hypot(u, v)};
    }

    std::shared_ptr<const void> give_frame_away() override { return {}; }
    Status frame_status() override { return status_; }
    int frames_made() const { return frames_made_; }
    Frame frame() override {
        ++frames_made_;
        Frame frame;
        frame.status = status_;
        frame.grid = grid_;
        const auto count = static_cast<Index>(position_.size() / 3);
        frame.particles = {{"position", "m", 3, position_.data(), count},
                           {"depth", "m", 1, particle_depth_.data(), count},
                           {"velocity", "m/s", 3, particle_velocity_.data(), count},
                           {"mass", "kg", 1, particle_mass_.data(), count}};
        frame.nodes = {node("elevation", "m", elevation_),
                       node("depth", "m", depth_),
                       node("surface", "m", surface_),
                       node("thickness", "m", depth_),
                       node("speed", "m/s", speed_),
                       {"velocity", "m/s", 3, velocity_.data(), grid_.size()},
                       node("peak_depth", "m", peak_depth_),
                       node("peak_speed", "m/s", peak_speed_),
                       node("peak_pressure", "Pa", peak_pressure_),
                       node("arrival_time", "s", arrival_)};
        return frame;
    }
    const GridGeometry& grid() const { return grid_; }

private:
    static Field node(const char* name, const char* unit, const std::vector<double>& values) {
        return {name, unit, 1, values.data(), static_cast<Index>(values.size())};
    }

    void update() {
        const double t = status_.time;
        update_nodes(t);
        update_particles(t);
        status_.particles = t >= script_.leave_time ? 0 : 25;
        status_.mass_left = 1.0 * t;
        status_.mass = 25.0e3 - 1.0 * t + 0.5e-3 * t;  // an error of 2e-8 per second, for the budget to find
        if (status_.particles == 0) status_.mass = 0.0;
        status_.momentum = {25.0e3 * u, 25.0e3 * v};
        status_.momentum_left = {3.0 * t, 0.0};
        status_.impulse = {2.0 * t, -1.0 * t};
        status_.kinetic = 0.5 * 25.0e3 * (u * u + v * v);
        status_.potential = 1.0e6 - 40.0 * t;
        status_.dissipated = 30.0 * t;
        status_.energy_left = 6.0 * t;
        status_.max_depth = height;
        status_.max_speed = status_.max_speed_on_map = t >= script_.rest_time ? 0.0 : std::hypot(u, v) + 0.1 * t;
        status_.mean_speed = std::hypot(u, v);
        status_.covered_area = 100.0 + t;
        // never 2 * front_turns of a script that does not turn: that overflows, and the checks trap it
        status_.front = 7.0 + u * (t <= script_.front_turns ? t : 2.0 * script_.front_turns - t);
        status_.p2g_mass_error = 1e-16;
        status_.p2g_momentum_error = 2e-16;
    }

    void update_nodes(double t) {
        for (Index j = 0; j < grid_.ny; ++j)
            for (Index i = 0; i < grid_.nx; ++i) {
                const auto k = static_cast<std::size_t>(j * grid_.nx + i);
                const Vec2 p(grid_.x(i), grid_.y(j));
                elevation_[k] = bed(p);
                depth_[k] = depth(p, t) > 1e-6 ? depth(p, t) : 0.0;
                surface_[k] = elevation_[k] + depth_[k];
                const bool wet = depth_[k] > 0.0;
                velocity_[3 * k] = wet ? u : 0.0;
                velocity_[3 * k + 1] = wet ? v : 0.0;
                speed_[k] = wet ? std::hypot(u, v) : 0.0;
                peak_depth_[k] = std::max(peak_depth_[k], depth_[k]);
                peak_speed_[k] = std::max(peak_speed_[k], speed_[k]);
                peak_pressure_[k] = std::max(peak_pressure_[k], density * speed_[k] * speed_[k]);
                if (arrival_[k] < 0.0 && depth_[k] > threshold) arrival_[k] = t;
            }
    }

    void update_particles(double t) {
        position_.clear(), particle_depth_.clear(), particle_velocity_.clear();
        particle_mass_.assign(start_.size(), 1000.0);
        for (const Vec2& start : start_) {
            const Vec2 p = start + Vec2(u, v) * t;
            const double h = depth(p, t);
            position_.insert(position_.end(), {p.x(), p.y(), bed(p) + h});
            particle_depth_.push_back(h);
            particle_velocity_.insert(particle_velocity_.end(), {u, v, 0.1 * u - 0.05 * v});
        }
    }

    FakeScript script_;
    int frames_made_ = 0;
    GridGeometry grid_;
    Status status_;
    std::vector<Vec2> start_;
    std::vector<double> elevation_, depth_, surface_, speed_, peak_depth_, peak_speed_, peak_pressure_, arrival_;
    std::vector<double> velocity_, position_, particle_depth_, particle_velocity_, particle_mass_;
};

}  // namespace frana
