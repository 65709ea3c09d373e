#pragma once
// The fields that the frames of every model have: their names and units, and how they follow from what a model knows.
#include <cmath>

#include "mpm/node_peak.h"
#include "observe/frame_store.h"

namespace frana {

/// A particle of the flow as a frame shows it.
struct ParticleShown {
    double x, y, z;            ///< place; depth-averaged particles lie on the free surface [m]
    double bed;                ///< elevation below it [m]
    double depth, steep;       ///< of the flow there [m]; sqrt(1 + slope^2) of the bed [1]
    double vx, vy, vz, speed;  ///< [m/s]
    double pressure;           ///< [Pa]
    double mass, volume;       ///< [kg], [m3]
    Index id;
};

/// What particles of all models have. Models add fields of their own.
class ParticleFields {
public:
    /// New fields of so many particles, each to be set.
    ParticleFields(FrameStore& store, std::vector<Field>& fields, Index count) {
        const auto made = [&](const char* name, const char* unit, int components) {
            return store.raw(fields, name, unit, components, count);
        };
        position_ = made("position", "m", 3), depth_ = made("depth", "m", 1), thickness_ = made("thickness", "m", 1);
        velocity_ = made("velocity", "m/s", 3), speed_ = made("speed", "m/s", 1);
        elevation_ = made("elevation", "m", 1), surface_ = made("surface", "m", 1);
        pressure_ = made("pressure", "Pa", 1), mass_ = made("mass", "kg", 1), volume_ = made("volume", "m3", 1);
        id_ = made("id", "1", 1);
    }

    void set(Index p, const ParticleShown& of) {
        position_[3 * p] = of.x, position_[3 * p + 1] = of.y, position_[3 * p + 2] = of.z;
        depth_[p] = of.depth, thickness_[p] = of.depth / of.steep;
        velocity_[3 * p] = of.vx, velocity_[3 * p + 1] = of.vy, velocity_[3 * p + 2] = of.vz;
        speed_[p] = of.speed;
        elevation_[p] = of.bed, surface_[p] = of.bed + of.depth;
        pressure_[p] = of.pressure, mass_[p] = of.mass, volume_[p] = of.volume;
        id_[p] = static_cast<double>(of.id);
    }

private:
    double *position_, *depth_, *thickness_, *velocity_, *speed_, *elevation_, *surface_, *pressure_, *mass_, *volume_,
        *id_;
};

/// What nodes of all models have.
class NodeFields {
public:
    /// New fields of so many nodes. `stand` is to be called for each of them, `flow` where material is.
    NodeFields(FrameStore& store, std::vector<Field>& fields, Index count) {
        const auto none = [&](const char* name, const char* unit, int components) {
            return store.zeros(fields, name, unit, components, count);
        };
        const auto made = [&](const char* name, const char* unit) { return store.raw(fields, name, unit, 1, count); };
        elevation = made("elevation", "m"), depth = none("depth", "m", 1), thickness = none("thickness", "m", 1);
        surface = made("surface", "m"), velocity = none("velocity", "m/s", 3), speed = none("speed", "m/s", 1);
        pressure = none("pressure", "Pa", 1);
        peak_depth_ = made("peak_depth", "m"), peak_speed_ = made("peak_speed", "m/s");
        peak_pressure_ = made("peak_pressure", "Pa"), peak_dynamic_ = made("peak_dynamic_pressure", "Pa");
        arrival_ = made("arrival_time", "s");
    }

    /// A node's ground [m], NaN where it has no data, its peaks so far, and when material arrived [s].
    void stand(Index n, double ground, const NodePeak& peak, double arrival_time) {
        elevation[n] = surface[n] = ground;
        peak_depth_[n] = peak.depth, peak_speed_[n] = peak.speed, peak_pressure_[n] = peak.pressure;
        peak_dynamic_[n] = peak.dynamic_pressure, arrival_[n] = arrival_time;
    }

    /// What a node shows of the flow. `steep` is sqrt(1 + slope^2) of its bed [1].
    struct Flow {
        double depth, steep, vx, vy, vz, speed, pressure;
    };
    void flow(Index n, const Flow& of) {
        depth[n] = of.depth, surface[n] += of.depth, thickness[n] = of.depth / of.steep;
        velocity[3 * n] = of.vx, velocity[3 * n + 1] = of.vy, velocity[3 * n + 2] = of.vz;
        speed[n] = of.speed, pressure[n] = of.pressure;
    }

    double *elevation, *depth, *thickness, *surface, *velocity, *speed, *pressure;  ///< a model may add to them

private:
    double *peak_depth_, *peak_speed_, *peak_pressure_, *peak_dynamic_, *arrival_;
};

}  // namespace frana
