#include "scene/insitu.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "scene/scene_parts.h"
#include "terrain/bed_points.h"

namespace frana {
namespace {

bool starts_with(const std::string& text, const char* beginning) { return text.rfind(beginning, 0) == 0; }

class InsituReader {
public:
    InsituReader(const CaseFile& file, const Scene& scene, Problems& problems)
        : case_(file), scene_(scene), problems_(problems) {}

    std::vector<Insitu> read() {
        for (Index i = 0; i < case_.count("camera"); ++i) read_camera(fmt::format("camera.{}.", i));
        std::vector<Insitu> result;
        for (Index i = 0; i < case_.count("insitu"); ++i) result.push_back(entry(fmt::format("insitu.{}", i)));
        return result;
    }

private:
    std::string extent_text() const {
        const auto e = scene_.bed.geometry.pixel_extent();
        return fmt::format("x {:.10g} to {:.10g}, y {:.10g} to {:.10g}", e[0], e[2], e[1], e[3]);
    }

    void read_camera(const std::string& prefix) {
        Camera camera;
        camera.name = case_.word(prefix + "name");
        camera.perspective = case_.word(prefix + "projection") == "perspective";
        camera.view_angle_deg = case_.number(prefix + "view_angle_deg");
        if (case_.given(prefix + "window")) read_window(prefix + "window", camera);
        if (camera.perspective) read_eye(prefix, camera);
        cameras_.emplace(camera.name, camera);
    }

    void read_window(const std::string& key, Camera& camera) {
        const auto& w = case_.numbers(key);
        const auto e = scene_.bed.geometry.pixel_extent();
        camera.window = {w[0], w[1], w[2], w[3]};
        if (!(w[0] < w[2] && w[1] < w[3] && w[0] < e[2] && w[2] > e[0] && w[1] < e[3] && w[3] > e[1]))
            problems_.add(case_.place(key), "found " + toml_text(w),
                          "expected [xmin, ymin, xmax, ymax] that meets the terrain, " + extent_text(),
                          "correct the coordinates, or remove the window");
    }

    void read_eye(const std::string& prefix, Camera& camera) {
        const auto &p = case_.numbers(prefix + "position"), &t = case_.numbers(prefix + "target");
        camera.position = {p[0], p[1], p[2]};
        camera.target = {t[0], t[1], t[2]};
        if (camera.position == camera.target)
            problems_.add(case_.place(prefix + "target"), "found the place of the camera itself",
                          "expected a point that it looks at", "give a point on the slope");
        const double ground = bilinear(scene_.bed, {p[0], p[1]});
        if (ground > p[2])
            problems_.add(case_.place(prefix + "position"), fmt::format("found {:.6g} m, under the ground", p[2]),
                          fmt::format("expected an elevation above that of the terrain there, {:.6g} m", ground),
                          "raise the camera");
    }

    Insitu entry(const std::string& table) {
        const std::string prefix = table + ".";
        Insitu entry;
        entry.name = case_.word(prefix + "name");
        entry.kind = kind_of(case_.word(prefix + "kind"));
        entry.place = case_.table_place(table);
        if (case_.given(prefix + "every")) entry.every = case_.number(prefix + "every");
        if (case_.given(prefix + "every_steps")) entry.every_steps = case_.integer(prefix + "every_steps");
        entry.width = static_cast<int>(case_.integer(prefix + "width"));
        entry.height = static_cast<int>(case_.integer(prefix + "height"));
        if (case_.given(prefix + "script")) entry.script = case_.path(prefix + "script");
        entry.of_particles = case_.word(prefix + "of") == "particles";
        entry.picture = case_.flag(prefix + "picture");
        entry.gis = case_.flag(prefix + "gis");
        read_fields(prefix, entry);
        read_line(prefix, entry);
        read_values(prefix, entry);
        read_view(prefix, entry);
        return entry;
    }

    static Insitu::Kind kind_of(const std::string& word) {
        for (const auto kind : {Insitu::Kind::profile, Insitu::Kind::contour, Insitu::Kind::threshold,
                                Insitu::Kind::figure, Insitu::Kind::reduce, Insitu::Kind::catalyst})
            if (word == kind_word(kind)) return kind;
        throw InternalError("internal error: a kind of [[insitu]] without a meaning");
    }

    void read_fields(const std::string& prefix, Insitu& entry) {
        const bool table = entry.kind == Insitu::Kind::profile || entry.kind == Insitu::Kind::reduce;
        if (entry.kind == Insitu::Kind::catalyst) return;
        const std::string key = prefix + (table ? "fields" : "field");
        entry.fields = table ? case_.words(key) : std::vector<std::string>{case_.word(key)};
        for (const std::string& field : entry.fields) check_field(key, field, entry.of_particles);
    }

    /// Checks that the run will have this field where it is observed.
    void check_field(const std::string& key, const std::string& field, bool of_particles) {
        const bool stress = starts_with(field, "stress") || starts_with(field, "effective_stress");
        const bool water = starts_with(field, "water_");
        const bool nodes_only = starts_with(field, "peak_") || field == "arrival_time" || water;
        const bool particles_only = field == "mass" || field == "volume" || field == "id";
        const std::string found = fmt::format("found \"{}\"", field);
        const bool structured = field == "damage" || field == "cohesion";
        if (water && !scene_.water)
            problems_.add(case_.place(key), found + " in a case without free water",
                          "expected a field of this case, since water.model = \"none\"",
                          "choose another field, or set water.model = \"free\"");
        else if (structured && !scene_.structure)
            problems_.add(case_.place(key), found + " in a case without structure",
                          "expected a field of this case, since material.structure.law = \"none\"",
                          "choose another field, or give the mass a structure");
        else if (stress && !scene_.structure && std::holds_alternative<rheology::None>(scene_.rheology))
            problems_.add(case_.place(key), found + " in a case without stress",
                          "expected a field of this case, since material.rheology.law = \"none\" has no stress",
                          "choose another field, or give the mass a rheology");
        else if (of_particles ? nodes_only : particles_only)
            problems_.add(case_.place(key),
                          fmt::format("{}, which {} do not have", found, of_particles ? "particles" : "nodes"),
                          fmt::format("expected a field of the {}", of_particles ? "particles" : "grid"),
                          of_particles ? "look at the grid, or choose another field"
                                       : "choose another field; of = \"particles\" with kind = \"threshold\" has it");
    }

    void read_line(const std::string& prefix, Insitu& entry) {
        if (!case_.given(prefix + "line")) return;
        entry.line = case_.points(prefix + "line");
        const auto e = scene_.bed.geometry.pixel_extent();
        if (!comes_onto(entry.line, e))
            problems_.add(case_.place(prefix + "line"), "found no point of it on the terrain",
                          "expected it within " + extent_text(), "correct the coordinates");
    }

    void read_values(const std::string& prefix, Insitu& entry) {
        const auto read = [&](const char* name, std::optional<double>& value) {
            if (case_.given(prefix + name)) value = case_.number(prefix + name);
        };
        read("from", entry.from);
        read("to", entry.to);
        read("above", entry.above);
        if (case_.given(prefix + "levels")) entry.levels = case_.numbers(prefix + "levels");
        if (entry.kind == Insitu::Kind::threshold && !entry.from && !entry.to)
            problems_.add(entry.place, "found a threshold without from and to", "expected one of them, or both",
                          "add from = ... or to = ...");
        if (entry.from && entry.to && *entry.from > *entry.to)
            problems_.add(case_.place(prefix + "to"), fmt::format("found {:.10g}", *entry.to),
                          fmt::format("expected at least from = {:.10g}", *entry.from), "exchange the two");
    }

    void read_view(const std::string& prefix, Insitu& entry) {
        if (case_.given(prefix + "range")) {
            const auto& range = case_.numbers(prefix + "range");
            entry.range = {range[0], range[1]};
            if (!(range[0] < range[1]))
                problems_.add(case_.place(prefix + "range"), "found " + toml_text(range),
                              "expected [low, high] with low < high", "exchange the two");
        }
        if (!case_.given(prefix + "camera")) return;
        const std::string& name = case_.word(prefix + "camera");
        const auto found = cameras_.find(name);
        if (found != cameras_.end()) {
            entry.camera = found->second;
            return;
        }
        std::vector<std::string> names;
        std::string listed;
        for (const auto& [known, camera] : cameras_) {
            names.push_back(known);
            listed += (listed.empty() ? "\"" : ", \"") + known + "\"";
        }
        const std::string near = closest(name, names);
        problems_.add(case_.place(prefix + "camera"), fmt::format("found \"{}\"", name),
                      "expected the name of a [[camera]]" + (listed.empty() ? "" : ": " + listed),
                      near.empty() ? "add that [[camera]], or correct the name" : "did you mean \"" + near + "\"?");
    }

    const CaseFile& case_;
    const Scene& scene_;
    Problems& problems_;
    std::map<std::string, Camera> cameras_;
};

}  // namespace

const char* kind_word(Insitu::Kind kind) {
    switch (kind) {
        case Insitu::Kind::profile:
            return "profile";
        case Insitu::Kind::contour:
            return "contour";
        case Insitu::Kind::threshold:
            return "threshold";
        case Insitu::Kind::figure:
            return "figure";
        case Insitu::Kind::reduce:
            return "reduce";
        case Insitu::Kind::catalyst:
            return "catalyst";
    }
    throw InternalError("internal error: a kind of [[insitu]] without a word");
}

std::vector<Insitu> read_insitu(const CaseFile& file, const Scene& scene, Problems& problems) {
    return InsituReader(file, scene, problems).read();
}

}  // namespace frana
