#include "run/folder/inflow_results.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/discharge.h"
#include "base/error.h"
#include "compare/outline.h"
#include "compare/union_area.h"
#include "io/gdal_reader.h"
#include "run/folder/barrier_plans.h"
#include "scene/case_file.h"
#include "scene/inflow_facts.h"
#include "scene/lines_of_case.h"

namespace frana {

double time_of(const Inflow& inflow, double volume) {
    constexpr int kHalvings = 60;  // to round-off
    double low = inflow.time.front(), high = inflow.time.back();
    for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (low + high);
        (volume_until(inflow, middle) < volume ? low : high) = middle;
    }
    return high;
}

std::vector<InflowPlace> inflow_places(const CaseFile& file, const std::string& crs_wkt,
                                       std::vector<std::string>& warnings) {
    std::vector<InflowPlace> places;
    std::vector<std::string> said_by_the_scene;
    for (Index i = 0; i < file.count("inflow"); ++i) {
        const std::string table = fmt::format("inflow.{}.", i);
        InflowPlace place{file.word(table + "name"), {}, {}};
        try {
            if (file.given(table + "area"))
                place.area = read_outline(file, table + "area", GdalReader(), crs_wkt, said_by_the_scene);
            else
                place.line = read_line(file, table + "line", GdalReader(), crs_wkt, said_by_the_scene);
        } catch (const UserError& error) {
            warnings.push_back(fmt::format("inflow {} is not on the maps: {}", place.name, error.what()));
        }
        places.push_back(std::move(place));
    }
    return places;
}

std::vector<NamedLine> inflow_plans(const std::vector<InflowPlace>& places) {
    std::vector<NamedLine> plans;
    for (const InflowPlace& place : places) {
        add_rings(place.name, place.area, plans);
        if (!place.line.empty()) plans.push_back({place.name, place.line});
    }
    return plans;
}

std::vector<ShapeLayer> inflow_layers(const Scene& scene, const std::vector<InflowPlace>& places) {
    ShapeLayer lines{"inflow", {}}, areas{"inflow_areas", {}};
    for (std::size_t k = 0; k < std::min(places.size(), scene.inflows.size()); ++k) {
        const InflowFacts facts = facts_of(scene.inflows[k], scene.gravity);
        AttributedShape shape{places[k].line,
                              {{"name", places[k].name},
                               {"volume_m3", facts.volume},
                               {"peak_discharge_m3_s", facts.peak},
                               {"peak_s", facts.peak_time},
                               {"start_s", scene.inflows[k].time.front()},
                               {"end_s", facts.end}}};
        if (!places[k].line.empty()) lines.shapes.push_back(shape);
        for (const Polygon& part : places[k].area.parts) {
            areas.shapes.push_back({part, shape.attributes});
            areas.shapes.back().attributes.emplace_back("area_m2", union_area(rings_of(Polygons{{part}, "", ""})));
        }
    }
    return {std::move(lines), std::move(areas)};
}

}  // namespace frana
