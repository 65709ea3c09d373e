#include "scene/build_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/error.h"
#include "base/free_memory.h"
#include "particles/generate.h"
#include "scene/barrier_box.h"
#include "scene/ground_fields.h"
#include "scene/memory_need.h"
#include "scene/problems.h"
#include "scene/remarks.h"
#include "scene/scene_parts.h"
#include "scene/terrain_part.h"
#include "terrain/holes.h"
#include "terrain/places.h"

namespace frana {
namespace {

constexpr Index nodata_reach = 3;  ///< cells; the stencils of the first steps read no further

class Builder {
public:
    Builder(const CaseFile& file, const GisReader& reader, const MeshReader& meshes)
        : case_(file), reader_(reader), meshes_(meshes), scene_(built_.scene) {}

    BuiltScene build() {
        scene_.name = case_.name();
        scene_.title = case_.given("case.title") ? case_.word("case.title") : scene_.name;
        scene_.case_file = case_.file();
        scene_.log = case_.log();
        set_physics(case_, scene_);
        remark_on_material(case_, scene_);
        read_terrain();
        problems_.throw_if_any();  // nothing below can be judged without terrain
        read_releases();
        read_survey(case_, reader_, scene_, problems_);
        read_friction(case_, reader_, friction_by_table(case_) ? released() : 0.0, scene_, problems_);
        remark_on_friction_rasters(case_, scene_);
        read_profiles_and_gauges();
        scene_.sections = read_sections(case_, reader_, scene_, problems_);
        read_inflows(case_, reader_, scene_, problems_);
        remark_on_sections_at_inflows(scene_);
        if (friction_by_table(case_)) remark_on_size(case_, released(), scene_);
        scene_.solid = read_solid_stage(case_, scene_, problems_);
        read_barriers(case_, reader_, meshes_, scene_, problems_);
        scene_.structure = read_structure(case_, scene_, problems_);
        scene_.erodible = read_erodible(case_, reader_, scene_, problems_);
        scene_.deposition = read_deposition(case_, scene_);
        scene_.forest = read_forest(case_, reader_, scene_, problems_);
        scene_.water = read_water(case_, reader_, scene_, problems_);
        scene_.insitu = read_insitu(case_, scene_, problems_);
        if (problems_.empty() && !releases_.empty() && require_room_for_particles()) make_particles();
        wall_holes(case_, scene_, problems_);
        problems_.throw_if_any();
        require_room_for_all();
        problems_.throw_if_any();
        remark_on_releases(case_, built_.releases, scene_);
        remark_on_overlaps(case_, releases_, built_.releases, scene_);
        remark_on_footprint_depth(case_, built_.releases, scene_);
        remark_on_releases_in_boxes(scene_);
        remark_on_fields(case_, scene_);
        cut_releases();
        join_remarks_on_coordinates(scene_.log);
        return std::move(built_);
    }

private:
    void read_terrain() {
        DemRequest request;
        if (case_.given("terrain.window")) {
            const auto& w = case_.numbers("terrain.window");
            request.window = {w[0], w[1], w[2], w[3]};
        }
        if (case_.given("grid.cell")) request.cell = case_.number("grid.cell");
        const std::string place = case_.place("terrain.dem");
        const auto later = reader_.read_dem_later(case_.path("terrain.dem"), request);
        WiderTerrain wider;
        request.choose = [&](const Raster& whole) {
            wider = {whole.geometry, NodeBox::all(whole.geometry), later, {}};
            if (later)
                if (const auto part = part_to_begin_with(case_, scene_, reader_, whole))
                    wider.held = part->box, wider.shown = part->shown;
            require_room(wider.held.of(whole.geometry), wider.held == NodeBox::all(whole.geometry));
            return wider.held;
        };
        const bool read = problems_.attempt(
            place, [&] { scene_.bed = reader_.read_dem(case_.path("terrain.dem"), request, scene_.log); });
        if (!read) return;
        if (later && !(wider.held == NodeBox::all(wider.grid)) && !problems_.attempt(place, [&] { hold_part(wider); }))
            return;
        const GridGeometry& grid = scene_.bed.geometry;
        if (grid.nx < 4 || grid.ny < 4)
            problems_.add(place, fmt::format("found {} x {} nodes", grid.nx, grid.ny), "expected at least 4 x 4",
                          "choose a smaller grid.cell or a larger terrain.window");
        note_nodata();
        remark_on_terrain(case_, scene_);
    }

    /// The bed is a part of the terrain. Where elevations are missing it has to be all of it. Only the whole shows what
    /// is outside of the terrain, and what is a hole in it.
    void hold_part(WiderTerrain& wider) {
        if (!has_nodata(scene_.bed)) {
            wider.fields = fields_later(case_, reader_, wider.grid);
            scene_.wider = std::make_shared<WiderTerrain>(std::move(wider));
            return;
        }
        const NodeBox all = NodeBox::all(wider.grid);
        require_room(all.of(wider.grid), true);
        scene_.bed = wider.read(all);
    }

    /// Before the elevations are read.
    void require_room(const GridGeometry& grid, bool whole) const {
        const double nodes = double(grid.size());
        const double needed = whole ? memory_need(nodes, 0.0, scene_.output.vtk).total() : memory_of_part(nodes);
        require_memory(
            needed, free_memory(),
            {"terrain.window", fmt::format("found {} x {} nodes of {:.6g} m, which", grid.nx, grid.ny, grid.cell),
             "give a window around the flow, or a larger grid.cell"});
    }

    /// Before the particles are made.
    bool require_room_for_particles() {
        return problems_.attempt(case_.file().string(), [&] {
            const bool counted = case_.given("particles.count");
            double count = 0.0;
            if (counted)
                count = double(case_.integer("particles.count"));
            else
                for (const double nodes : nodes_of_releases_) count += nodes * case_.number("particles.per_cell");
            require_memory(memory_need(0.0, count, scene_.output.vtk).total(), free_memory(),
                           {counted ? "particles.count" : "particles.per_cell",
                            fmt::format("found {:.3g} particles, which", count), "give fewer of them"});
        });
    }

    /// Of all that the scene now holds. How much of the release is ever in the window of a stage at once is not known.
    /// What would not fit with a tenth of it is refused. What would not fit with all of it is a remark.
    void require_room_for_all() {
        const MemoryNeed need = memory_need(scene_);
        const double free = free_memory(), without = need.total() - need.space;
        const bool space = need.space > 0.5 * need.total();
        const MemoryUse use =
            space ? MemoryUse{"stage.spacing",
                              fmt::format("found {:.3g} 3D points once all of the release is in the window, which",
                                          most_points(scene_)),
                              "give a larger spacing or a smaller window"}
                  : MemoryUse{"memory",
                              fmt::format("found {} nodes and {} particles, which", scene_.bed.geometry.size(),
                                          particle_count()),
                              "use fewer particles, a larger grid.cell or a smaller terrain.window"};
        problems_.attempt(case_.file().string(), [&] {
            if (without + 0.1 * need.space > free) require_memory(need.total(), free, use);
        });
        if (need.total() > free && problems_.empty()) scene_.log.push_back(memory_sentence(need.total(), free, use));
    }

    Index particle_count() const {
        Index count = 0;
        for (const Seeds* seeds : scene_.all_particles()) count += seeds->count();
        return count;
    }

    void note_nodata() {
        const auto& values = scene_.bed.values;
        const auto missing = std::count_if(values.begin(), values.end(), [](double z) { return std::isnan(z); });
        find_holes(case_, scene_);
        const Index outside = missing - static_cast<Index>(scene_.holes.nodes.size());
        if (outside > 0)
            scene_.log.push_back(
                fmt::format("{} of {} nodes lie outside of the terrain, without elevation: an exit, mass that "
                            "enters is counted as left",
                            outside, values.size()));
    }

    void read_releases() {
        for (Index i = 0; i < case_.count("release"); ++i) {
            for (Release& release : read_release(case_, i, scene_, reader_, problems_))
                problems_.attempt(release.name, [&] {
                    const NodeMarks marks = nodes_under(release, scene_.bed.geometry);
                    if (std::count(marks.begin(), marks.end(), 1) == 0) throw UserError(no_material(release));
                    refuse_nodata(marks, scene_.bed, nodata_reach);
                    remark_on_speed(case_, i, release, scene_);
                    releases_.push_back(std::move(release));
                    nodes_of_releases_.push_back(double(std::count(marks.begin(), marks.end(), 1)));
                    summarise(i, marks);
                });
        }
    }

    /// Of all releases, later ones too: the size of the avalanche that they make [m3]. What is wrong with a release is said
    /// when it gets its particles.
    double released() const {
        try {
            return volume_of(releases_, scene_.bed.geometry);
        } catch (const UserError&) {
            return 0.0;
        }
    }

    static std::string no_material(const Release& release) {
        const char* both = release.outline ? "where the outline and the depth overlap" : "in its depth";
        return fmt::format(
            "found no material {}; expected a volume above 0; check depth or surface, and the CRS and "
            "place of the files",
            both);
    }

    void summarise(Index i, const NodeMarks& marks) {
        ReleaseSummary summary;
        summary.name = fmt::format("release.{}", i);
        summary.table = i;
        summary.at = case_.number(fmt::format("release.{}.at", i));
        summary.when_hit = case_.flag(fmt::format("release.{}.when_hit", i));
        summary.included_in_dem = case_.flag(fmt::format("release.{}.included_in_dem", i));
        for (const char* name : {"outline", "mask", "depth", "surface"}) {
            const std::string key = fmt::format("release.{}.{}", i, name);
            if (case_.given(key) && case_.is_text(key)) summary.name += fmt::format(" ({})", case_.word(key));
        }
        const GridGeometry& grid = scene_.bed.geometry;
        double steepest = 0.0;
        double flattest = INFINITY;
        double sum = 0.0;
        Index count = 0;
        for (Index k = 0; k < grid.size(); ++k) {
            if (!marks[static_cast<std::size_t>(k)]) continue;
            const double slope =
                std::atan(node_gradient(scene_.bed, k % grid.nx, k / grid.nx).norm()) * constants::kRadian;
            steepest = std::max(steepest, slope);
            flattest = std::min(flattest, slope);
            sum += slope;
            ++count;
        }
        summary.slope_max_deg = steepest;
        summary.slope_min_deg = flattest;
        summary.slope_mean_deg = sum / double(count);
        built_.releases.push_back(summary);
    }

    void make_particles() {
        ParticleOptions options;
        if (case_.given("particles.count"))
            options.count = case_.integer("particles.count");
        else
            options.per_cell = case_.number("particles.per_cell");
        const std::string& placement = case_.word("particles.placement");
        if (placement == "r2") options.placement = Placement::r2;
        if (placement == "slope") options.placement = Placement::slope;
        if (scene_.water && !scene_.structure) options.reach = Reach::pixels;  // water alone fills cells
        std::vector<ReleaseReport> reports;
        const bool made = problems_.attempt(case_.file().string(), [&] {
            scene_.particles = make_seeds(releases_, scene_.bed, options, reports, scene_.log);
        });
        if (!made) return;
        expect(reports.size() == releases_.size(), "make_seeds reports on every release");
        note_lake();
        Index p = 0;  // particles come release after release
        for (std::size_t i = 0; i < reports.size(); ++i) {
            built_.releases[i].report = reports[i];
            double& deepest = built_.releases[i].max_depth;
            for (Index end = p + reports[i].count; p < end; ++p)
                deepest = std::max(deepest, scene_.particles.depth[static_cast<std::size_t>(p)]);
            check_volume(i, reports[i]);
        }
        take_out_late();
    }

    static bool is_late(const ReleaseSummary& release) { return release.at > 0.0 || release.when_hit; }

    /// Those that enter later are no particles of the start.
    void take_out_late() {
        if (std::none_of(built_.releases.begin(), built_.releases.end(), is_late)) return;
        Seeds at_start;
        Index p = 0, table = -1;
        for (const ReleaseSummary& release : built_.releases) {
            const Index end = p + release.report.count;
            if (is_late(release) && release.table != table)
                scene_.late.push_back({release.name, release.at, {}, 0}), table = release.table;
            if (release.when_hit) scene_.late.back().at.reset();
            (is_late(release) ? scene_.late.back().seeds : at_start).append(scene_.particles, p, end);
            p = end;
        }
        scene_.particles = std::move(at_start);
        Index id = scene_.particles.count();
        for (LateRelease& late : scene_.late) late.first_id = id, id += late.seeds.count();
    }

    /// One release up to one level, at rest, over the whole window or within an outline that holds its shore. It is a
    /// lake, which the solver starts at exact rest.
    void note_lake() {
        const auto given = [&](const char* key) { return case_.given(std::string("release.0.") + key); };
        if (case_.count("release") != 1 || !given("surface") || case_.is_text("release.0.surface")) return;
        const double level = case_.number("release.0.surface");
        if (given("mask") || given("velocity")) return;
        if (built_.releases[0].at > 0.0 || built_.releases[0].when_hit) return;
        if (given("outline") && !holds_shore(releases_[0], scene_.bed, level)) return;
        scene_.still_surface = level;
    }

    void check_volume(std::size_t i, const ReleaseReport& report) {
        if (report.volume > 0.0 && report.particle_volume > 0.0) return;
        problems_.add(releases_[i].name, fmt::format("found a volume of {} m3", report.volume),
                      "expected a volume above 0", "check depth or surface, and the place of the files");
    }

    void cut_releases() {
        NodeMarks scars(static_cast<std::size_t>(scene_.bed.geometry.size()), 0);
        for (std::size_t i = 0; i < releases_.size(); ++i) {
            const Index table = built_.releases[i].table;
            if (!case_.flag(fmt::format("release.{}.included_in_dem", table))) continue;
            const NodeMarks marks = nodes_under(releases_[i], scene_.bed.geometry);
            for (std::size_t k = 0; k < marks.size(); ++k) scars[k] |= marks[k];
            const bool later = is_late(built_.releases[i]);
            const double volume =
                later ? cut_later(releases_[i], late_of(table)) : cut_release(releases_[i], scene_.bed);
            scene_.log.push_back(fmt::format("release.{}: its {:.6g} m3 are cut out of the bed{} (included_in_dem)",
                                             table, volume, later ? " when it enters" : ""));
        }
        remark_on_loose_scar(scars);
    }

    /// That of a table: all features' depths are one.
    LateRelease& late_of(Index table) {
        std::size_t n = 0;
        Index last = -1;
        for (const ReleaseSummary& release : built_.releases) {
            if (release.table > table) break;
            if (is_late(release) && release.table != last) last = release.table, ++n;
        }
        expect(last == table, "a table that enters later is a late release");
        return scene_.late.at(n - 1);
    }

    /// Notes what falls when the release enters. Returns its volume [m3].
    double cut_later(const Release& release, LateRelease& late) const {
        const GridGeometry& grid = scene_.bed.geometry;
        Raster fallen = Raster::filled(grid, 0.0);
        const double volume = cut_release(release, fallen);
        for (Index j = 0; j < grid.ny; ++j)
            for (Index i = 0; i < grid.nx; ++i)
                if (fallen.at(i, j) != 0.0) late.scar.push_back({Vec2(grid.x(i), grid.y(j)), -fallen.at(i, j)});
        return volume;
    }

    /// Of the part of a terrain that is held what lies farther on is not known.
    void remark_on_loose_scar(const NodeMarks& scars) {
        if (!scene_.erodible || scene_.wider) return;
        const std::vector<double>& loose = scene_.erodible->depth.values;
        double within = 0.0, all = 0.0;
        for (std::size_t k = 0; k < scars.size(); ++k) all += loose[k], within += scars[k] ? loose[k] : 0.0;
        if (!(all > 0.0) || within < all) return;
        scene_.log.push_back(
            fmt::format("{}: found loose material under releases with included_in_dem only; expected some on the way "
                        "of the flow; it lies below the ground that is left when they are cut out, so give it "
                        "elsewhere if that is not meant",
                        case_.place("erodible.depth")));
    }

    const GridGeometry& terrain() const { return scene_.wider ? scene_.wider->grid : scene_.bed.geometry; }

    bool inside(const Vec2& point) const {
        const auto extent = terrain().pixel_extent();
        return point.x() >= extent[0] && point.x() <= extent[2] && point.y() >= extent[1] && point.y() <= extent[3];
    }

    /// Within the part that is held, where the elevation model has no data.
    bool is_hole(const Vec2& point) const {
        const NodeAt node = nearest_node(scene_.bed.geometry, point);
        return has_node(scene_.bed.geometry, node) && std::isnan(scene_.bed.at(node.i, node.j));
    }

    std::string extent_text() const {
        const auto e = terrain().pixel_extent();
        return fmt::format("expected it within x {:.10g} to {:.10g}, y {:.10g} to {:.10g}", e[0], e[2], e[1], e[3]);
    }

    void read_profiles_and_gauges() {
        const std::string way_out = "correct the coordinates, or widen terrain.window";
        for (Index i = 0; i < case_.count("profile"); ++i) {
            const std::string prefix = fmt::format("profile.{}.", i);
            const Polyline& line = case_.points(prefix + "line");
            if (!comes_onto(line, terrain().pixel_extent()))
                problems_.add(case_.place(prefix + "line"), "found no point of it on the terrain", extent_text(),
                              way_out);
            else if (!std::all_of(line.begin(), line.end(), [&](const Vec2& corner) { return inside(corner); }))
                scene_.log.push_back(fmt::format(
                    "profile {}: found corners of its line beyond the terrain; expected all of it there; it "
                    "has no values beyond",
                    case_.word(prefix + "name")));
            scene_.profiles.push_back({case_.word(prefix + "name"), line});
        }
        for (Index i = 0; i < case_.count("gauge"); ++i) {
            const std::string prefix = fmt::format("gauge.{}.", i);
            const auto& xy = case_.numbers(prefix + "point");
            const Vec2 point(xy[0], xy[1]);
            if (!inside(point))
                problems_.add(case_.place(prefix + "point"), fmt::format("found {}, {} off the terrain", xy[0], xy[1]),
                              extent_text(), way_out);
            else if (is_hole(point))
                problems_.add(case_.place(prefix + "point"),
                              fmt::format("found {}, {} where the terrain has no elevation", xy[0], xy[1]),
                              "expected ground there", "move the gauge, or fill the hole (gdal_fillnodata.py)");
            scene_.gauges.push_back({case_.word(prefix + "name"), point});
        }
    }

    const CaseFile& case_;
    const GisReader& reader_;
    const MeshReader& meshes_;
    BuiltScene built_;
    Scene& scene_;
    Problems problems_;
    std::vector<Release> releases_;
    std::vector<double> nodes_of_releases_;
};

}  // namespace

BuiltScene build_scene_in_detail(const CaseFile& file, const GisReader& reader, const MeshReader& meshes) {
    return Builder(file, reader, meshes).build();
}

Scene build_scene(const CaseFile& file, const GisReader& reader, const MeshReader& meshes) {
    return build_scene_in_detail(file, reader, meshes).scene;
}

}  // namespace frana
