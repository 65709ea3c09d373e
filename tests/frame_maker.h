#pragma once
// Made-up frames for tests of writers: map coordinates as large as UTM's, awkward numbers, holes in the
// terrain.
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "observe/frame.h"

/// Owns the arrays of a frame. A cone-shaped hill with a flow of `count` particles on it at time `time`.
class FrameMaker {
public:
    frana::Frame frame;

    FrameMaker(frana::Index number, double time, frana::Index count, const frana::GridGeometry& grid) {
        frame.number = number;
        frame.status.time = time;
        frame.status.particles = count;
        frame.grid = grid;
        add_particles(count);
        add_nodes();
    }
    FrameMaker(const FrameMaker&) = delete;

    /// The numbers of an array, to be made awkward by a test.
    std::vector<double>& particle_numbers(const std::string& name) { return numbers(frame.particles, name); }
    std::vector<double>& node_numbers(const std::string& name) { return numbers(frame.nodes, name); }

    /// Takes the terrain away in the grid's north-east quarter: elevation and surface NaN, the rest zero.
    void cut_corner() {
        for (const frana::Field& field : frame.nodes) {
            const bool height = field.name == "elevation" || field.name == "surface";
            auto& values = node_numbers(field.name);
            for (frana::Index k = 0; k < field.count * field.components; ++k) {
                const frana::Index node = k / field.components;
                if (node % frame.grid.nx >= frame.grid.nx / 2 && node / frame.grid.nx >= frame.grid.ny / 2)
                    values[static_cast<std::size_t>(k)] = height ? std::numeric_limits<double>::quiet_NaN() : 0.0;
            }
        }
    }

    /// UTM zone 59/60 south: 7 digits before the point, 10 m cells.
    static frana::GridGeometry utm(frana::Index nx, frana::Index ny) {
        return {nx, ny, 1756969.123456789, 5917003.987654321, 10.0};
    }

private:
    std::deque<std::vector<double>> storage_;  ///< a deque keeps its elements where they are

    void add(std::vector<frana::Field>& fields, const std::string& name, const std::string& unit, int components,
             std::vector<double> values) {
        storage_.push_back(std::move(values));
        const auto count = static_cast<frana::Index>(storage_.back().size()) / components;
        fields.push_back({name, unit, components, storage_.back().data(), count});
    }

    std::vector<double>& numbers(const std::vector<frana::Field>& fields, const std::string& name) {
        for (const frana::Field& field : fields)
            for (auto& values : storage_)
                if (field.name == name && values.data() == field.data) return values;
        throw std::out_of_range(name);
    }

    double hill(double x, double y) const {
        const auto& g = frame.grid;
        const double across = std::hypot(x - 0.5 * (g.x0 + g.x_max()), y - 0.5 * (g.y0 + g.y_max()));
        return 800.0 - 0.6 * across + 5.0 * std::sin(0.05 * x) * std::cos(0.04 * y);
    }

    /// Depth of a cap that slides north-east with time [m].
    double cap(double x, double y) const {
        const auto& g = frame.grid;
        const double width = 0.2 * (g.x_max() - g.x0) + g.cell;
        const double shift = (0.5 + 0.02 * frame.status.time) * (g.x_max() - g.x0);
        const double r = std::hypot(x - g.x0 - shift, y - g.y0 - 0.5 * (g.y_max() - g.y0)) / width;
        return std::max(0.0, 4.0 * (1.0 - r * r));
    }

    void add_particles(frana::Index count) {
        std::mt19937_64 random(static_cast<std::uint64_t>(frame.number) + 1);
        const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1.0p-53; };
        std::vector<double> position, velocity, stress, depth, mass, volume, id;
        const auto& g = frame.grid;
        for (frana::Index p = 0; p < count; ++p) {
            const double x = g.x0 + uniform() * (g.x_max() - g.x0), y = g.y0 + uniform() * (g.y_max() - g.y0);
            const double h = 5.0 * uniform();
            position.insert(position.end(), {x, y, hill(x, y) + h});
            velocity.insert(velocity.end(), {10.0 * uniform() - 5.0, -7.0 * uniform(), uniform()});
            stress.insert(stress.end(), {-1e5 * uniform(), 1e3 * uniform(), uniform() - 0.5});
            depth.push_back(h);
            volume.push_back(1.0 / 3.0 + uniform());
            mass.push_back(volume.back() * 1291.0);
            id.push_back(static_cast<double>(p) + 9007199254740000.0);  // near the end of double's integers
        }
        add(frame.particles, "position", "m", 3, position);
        add(frame.particles, "velocity", "m/s", 3, velocity);
        add(frame.particles, "stress", "Pa", 3, stress);
        add(frame.particles, "depth", "m", 1, depth);
        add(frame.particles, "mass", "kg", 1, mass);
        add(frame.particles, "volume", "m3", 1, volume);
        add(frame.particles, "id", "1", 1, id);
    }

    void add_nodes() {
        std::vector<double> elevation, depth, surface, velocity, speed, stress;
        const auto& g = frame.grid;
        for (frana::Index j = 0; j < g.ny; ++j)
            for (frana::Index i = 0; i < g.nx; ++i) {
                const double x = g.x(i), y = g.y(j), h = cap(x, y);
                elevation.push_back(hill(x, y));
                depth.push_back(h);
                surface.push_back(hill(x, y) + h);
                velocity.insert(velocity.end(), {h, -0.5 * h, 0.1 * h});
                speed.push_back(std::sqrt(1.26) * h);
                stress.insert(stress.end(), {-1e4 * h, -5e3 * h, 1e3 * h});
            }
        add(frame.nodes, "elevation", "m", 1, elevation);
        add(frame.nodes, "depth", "m", 1, depth);
        add(frame.nodes, "surface", "m", 1, surface);
        add(frame.nodes, "velocity", "m/s", 3, velocity);
        add(frame.nodes, "speed", "m/s", 1, speed);
        add(frame.nodes, "stress", "Pa", 3, stress);
        add(frame.nodes, "peak_depth", "m", 1, depth);
    }
};
