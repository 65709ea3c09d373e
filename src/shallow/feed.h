#pragma once
// Particles that come in through lines, row by row, and over areas, layer by layer: THEORY (64).
#include <limits>
#include <vector>

#include "run/simulation.h"
#include "scene/scene.h"

namespace frana {

/// What an inflow brings while it goes on by a row's spacing. Rows follow from the table alone, not from the steps.
struct InflowRow {
    double complete = 0.0;   ///< when all of it is through the line [s]
    double mean_time = 0.0;  ///< of its volume through the line [s]
    double volume = 0.0;     ///< [m3]
    double speed = 0.0;      ///< mean of its volume: momentum is exact; over an area, at which the layer grows [m/s]
    double length = 0.0;     ///< way that it went on meanwhile; over an area, the layer [m]
    double begin = 0.0;      ///< when the first of it is at the line [s]
    double before = 0.0;     ///< way that the flow had gone on until then [m]
};

/// The rows of a whole table that bring something, in the order of their times. The last one brings what is left.
std::vector<InflowRow> rows_of(const Inflow& inflow);

class Feed {
public:
    explicit Feed(const std::vector<Inflow>& inflows);

    /// Whether a row is complete at a time [s].
    bool due(double time) const { return next() <= time; }
    /// When the next row is complete [s]; infinite: never.
    double next() const;
    bool over() const { return next() == std::numeric_limits<double>::infinity(); }
    /// The fastest signal of the rows to come next, |v| + sqrt(g h) [m/s].
    double signal(double gravity) const;

    /// Particles to come in, and where on their lines they came through, on the map.
    struct Particles {
        Seeds seeds;
        std::vector<Vec2> from;
        void clear();
    };
    /// Those of all rows complete by `time`, as they stand at that time.
    const Particles& take(double time);

    /// Those that follow, as they would stand up to `reach` [m] behind the lines, in a flow that stays the same.
    /// None of an inflow that has not begun.
    const Seeds& behind(double time, double reach);

    /// Volume that should have come in so far: of the tables, up to the last row of each [m3].
    double expected() const;
    /// By the whole tables [m3].
    double whole() const;
    /// The largest volume of a particle [m3].
    double largest_particle() const;
    /// Particles that a half-cell square of the inflow holds.
    Index in_a_square(double cell) const;
    /// All that comes in before a time.
    struct Outlook {
        double particles = 0.0, particle_seconds = 0.0;  ///< how many; the sum of their times in the flow [s]
        double speed = 0.0, depth = 0.0;                 ///< largest [m/s], [m]
        std::vector<Vec2> from;                          ///< places where they come in, on the map
    };
    Outlook outlook(double end) const;
    /// A place where it comes in, on the map.
    struct Entry {
        Vec2 at;
        double volume;  ///< [m3]
    };
    /// What each inflow brings before a time.
    std::vector<std::vector<Entry>> entries(double end) const;
    /// The middle of the first line, on the map.
    Vec2 middle() const;

    void serialize(Archive& archive);
    void take_over(const Feed& from) { next_ = from.next_; }

private:
    /// A place of a line where particles come in.
    struct Station {
        Vec2 at, towards;  ///< on the map; unit vector
        double share;      ///< of the line's width [1]
    };
    struct Source {
        Inflow inflow;
        std::vector<InflowRow> rows;
        std::vector<Station> stations;
        double width;  ///< [m]
        bool rests() const { return inflow.area > 0.0; }
        double depth_of(const InflowRow& row) const;  ///< [m]
    };
    void take_layers(const Source& source, double time, Index& next);
    static void add_row(const Source& source, const InflowRow& row, double way, Particles& particles);

    std::vector<Source> sources_;
    std::vector<Index> next_;       ///< row of each source
    Particles particles_, behind_;  ///< scratch
};

/// The largest volume of a particle that a scene has at its start, or that comes in later [m3].
double largest_particle(const Scene& scene);

}  // namespace frana
