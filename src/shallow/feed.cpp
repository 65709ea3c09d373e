#include "shallow/feed.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/discharge.h"

namespace frana {
namespace {

/// Time in which something of speed v that grows by dv in each second goes so far; infinite: never.
double time_for(double way, double v, double dv) {
    const double square = v * v + 2.0 * dv * way, sum = v + std::sqrt(std::max(square, 0.0));
    return square >= 0.0 && sum > 0.0 ? 2.0 * way / sum : std::numeric_limits<double>::infinity();
}

/// Over an area the depth that has come goes on as the flow does through a line. A row is complete with its layer.
Inflow as_way(const Inflow& area) {
    Inflow of = area;
    of.area = 0.0, of.spacing = area.layer, of.speed.clear();
    for (const double discharge : area.discharge) of.speed.push_back(discharge / area.area);
    return of;
}

}  // namespace

std::vector<InflowRow> rows_of(const Inflow& of) {
    if (of.area > 0.0) return rows_of(as_way(of));
    std::vector<InflowRow> rows;
    Through now, begun;
    now.time = begun.time = of.time.front();
    const auto close = [&] {
        const double volume = now.volume - begun.volume;
        if (volume > 0.0)
            rows.push_back({now.time, (now.moment - begun.moment) / volume, volume,
                            (now.momentum - begun.momentum) / volume, now.way - begun.way, begun.time, begun.way});
        begun = now;
    };
    for (std::size_t n = 0; n + 1 < of.time.size(); ++n) {
        const double length = of.time[n + 1] - of.time[n], dv = (of.speed[n + 1] - of.speed[n]) / length;
        double since = 0.0;
        for (;;) {
            const double left = begun.way + of.spacing - now.way;
            const double s = time_for(left, of.speed[n] + dv * since, dv);
            if (!(since + s < length)) break;
            now.go(of, n, since, s);
            since += s;
            close();
        }
        now.go(of, n, since, length - since);
        now.time = of.time[n + 1];
    }
    close();
    return rows;
}

Feed::Feed(const std::vector<Inflow>& inflows) : next_(inflows.size(), 0) {
    for (const Inflow& inflow : inflows) {
        Source source{inflow, rows_of(inflow), {}, inflow.width()};
        for (const Inflow::Patch& patch : inflow.patches)
            source.stations.push_back({patch.at, Vec2(0, 0), patch.share});
        for (std::size_t k = 0; k + 1 < inflow.line.size(); ++k) {
            const Vec2 piece = inflow.line[k + 1] - inflow.line[k];
            const double length = piece.norm();
            const Vec2 right = Vec2(piece.y(), -piece.x()) / length;
            const Index parts = std::max<Index>(1, std::lround(length / inflow.spacing));
            for (Index part = 0; part < parts; ++part) {
                const double at = (static_cast<double>(part) + 0.5) / static_cast<double>(parts);
                source.stations.push_back({inflow.line[k] + at * piece, inflow.to_right ? right : Vec2(-right),
                                           length / source.width / static_cast<double>(parts)});
            }
        }
        sources_.push_back(std::move(source));
    }
}

double Feed::next() const {
    double first = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < sources_.size(); ++n)
        if (next_[n] < static_cast<Index>(sources_[n].rows.size()))
            first = std::min(first, sources_[n].rows[static_cast<std::size_t>(next_[n])].complete);
    return first;
}

double Feed::signal(double gravity) const {
    double fastest = 0.0;
    for (std::size_t n = 0; n < sources_.size(); ++n) {
        if (next_[n] >= static_cast<Index>(sources_[n].rows.size())) continue;
        const InflowRow& row = sources_[n].rows[static_cast<std::size_t>(next_[n])];
        const double speed = sources_[n].rests() ? 0.0 : row.speed;
        fastest = std::max(fastest, speed + std::sqrt(gravity * sources_[n].depth_of(row)));
    }
    return fastest;
}

double Feed::Source::depth_of(const InflowRow& row) const {
    return row.volume / (rests() ? inflow.area : width * row.length);
}

void Feed::add_row(const Source& source, const InflowRow& row, double way, Particles& particles) {
    Seeds& seeds = particles.seeds;
    for (const Station& station : source.stations) {
        const Vec2 place = station.at + way * station.towards, velocity = row.speed * station.towards;
        seeds.x.push_back(place.x()), seeds.y.push_back(place.y());
        seeds.vx.push_back(velocity.x()), seeds.vy.push_back(velocity.y());
        seeds.volume.push_back(station.share * row.volume);
        seeds.depth.push_back(source.depth_of(row));
        seeds.size.push_back(source.inflow.spacing);
        particles.from.push_back(station.at);
    }
}

void Feed::Particles::clear() {
    for (auto* array : {&seeds.x, &seeds.y, &seeds.vx, &seeds.vy, &seeds.volume, &seeds.depth, &seeds.size})
        array->clear();
    from.clear();
}

const Seeds& Feed::behind(double time, double reach) {
    behind_.clear();
    for (std::size_t n = 0; n < sources_.size(); ++n) {
        const std::vector<InflowRow>& rows = sources_[n].rows;
        auto k = static_cast<std::size_t>(next_[n]);
        if (sources_[n].rests()) continue;
        if (k >= rows.size() || time < rows[k].begin) continue;
        const InflowRow& row = rows[k];
        const double at = row.before + row.length * (time - row.begin) / (row.complete - row.begin);
        for (; k < rows.size() && rows[k].before - at < reach; ++k)
            add_row(sources_[n], rows[k], at - rows[k].before - 0.5 * rows[k].length, behind_);
    }
    return behind_.seeds;
}

/// Layers that came since the last time are one: of each, particles would lie at the same places.
void Feed::take_layers(const Source& source, double time, Index& next) {
    InflowRow all;
    for (; next < static_cast<Index>(source.rows.size()); ++next) {
        const InflowRow& row = source.rows[static_cast<std::size_t>(next)];
        if (row.complete > time) break;
        all.volume += row.volume;
    }
    if (all.volume > 0.0) add_row(source, all, 0.0, particles_);
}

const Feed::Particles& Feed::take(double time) {
    particles_.clear();
    for (std::size_t n = 0; n < sources_.size(); ++n) {
        const std::vector<InflowRow>& rows = sources_[n].rows;
        Index& next = next_[n];
        if (sources_[n].rests()) {
            take_layers(sources_[n], time, next);
            continue;
        }
        for (; next < static_cast<Index>(rows.size()); ++next) {
            const InflowRow& row = rows[static_cast<std::size_t>(next)];
            if (row.complete > time) break;
            add_row(sources_[n], row, row.speed * (time - row.mean_time), particles_);
        }
    }
    return particles_;
}

double Feed::expected() const {
    double sum = 0.0;
    for (std::size_t n = 0; n < sources_.size(); ++n)
        if (next_[n] > 0)
            sum += volume_until(sources_[n].inflow, sources_[n].rows[static_cast<std::size_t>(next_[n] - 1)].complete);
    return sum;
}

double Feed::whole() const {
    double sum = 0.0;
    for (const Source& source : sources_) sum += volume_until(source.inflow, source.inflow.time.back());
    return sum;
}

double Feed::largest_particle() const {
    double largest = 0.0;
    for (const Source& source : sources_)
        for (const Station& station : source.stations)
            for (const InflowRow& row : source.rows) largest = std::max(largest, station.share * row.volume);
    return largest;
}

Index Feed::in_a_square(double cell) const {
    double most = 0.0;
    for (const Source& source : sources_) most = std::max(most, 0.5 * cell / source.inflow.spacing);
    return std::lround(most * most);
}

Feed::Outlook Feed::outlook(double end) const {
    Outlook all;
    for (const Source& source : sources_) {
        const double wide = static_cast<double>(source.stations.size());
        for (const InflowRow& row : source.rows) {
            if (row.complete > end) break;
            all.particles += wide, all.particle_seconds += wide * (end - row.complete);
            all.depth = std::max(all.depth, source.depth_of(row));
            if (!source.rests()) all.speed = std::max(all.speed, row.speed);
        }
        for (const Station& station : source.stations) all.from.push_back(station.at);
    }
    return all;
}

std::vector<std::vector<Feed::Entry>> Feed::entries(double end) const {
    std::vector<std::vector<Entry>> all;
    for (const Source& source : sources_) {
        double volume = 0.0;
        for (const InflowRow& row : source.rows)
            if (row.complete <= end) volume += row.volume;
        std::vector<Entry> entries;
        for (const Station& station : source.stations) entries.push_back({station.at, station.share * volume});
        all.push_back(std::move(entries));
    }
    return all;
}

Vec2 Feed::middle() const {
    Vec2 sum(0, 0);
    for (const Station& station : sources_.front().stations) sum += station.share * station.at;
    return sum;
}

void Feed::serialize(Archive& archive) {
    const Archive::Part part(archive, "feed");
    archive.array("next", next_);
}

double largest_particle(const Scene& scene) {
    double largest = 0.0;
    for (const Seeds* seeds : scene.all_particles())
        for (const double volume : seeds->volume) largest = std::max(largest, volume);
    return scene.inflows.empty() ? largest : std::max(largest, Feed(scene.inflows).largest_particle());
}

}  // namespace frana
