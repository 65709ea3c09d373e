// The keys of what is observed while the case runs: [[insitu]] and the [[camera]]s of its pictures.
#include "scene/parameter_makers.h"

namespace frana {
namespace {

using namespace rows;

const char* const kind = "insitu.kind";

/// Every scalar that a frame may have; components of vectors and stresses by their names.
std::vector<std::string> scalar_names() {
    return {"depth",
            "thickness",
            "speed",
            "velocity_x",
            "velocity_y",
            "velocity_z",
            "pressure",
            "surface",
            "elevation",
            "peak_depth",
            "peak_speed",
            "peak_pressure",
            "arrival_time",
            "peak_dynamic_pressure",
            "stress_xx",
            "stress_yy",
            "stress_xy",
            "effective_stress_xx",
            "mass",
            "effective_stress_yy",
            "volume",
            "effective_stress_xy",
            "damage",
            "cohesion",
            "water_depth",
            "water_speed",
            "water_velocity_x",
            "water_velocity_y",
            "water_velocity_z",
            "id"};
}

Parameter list(const char* key, std::size_t length, const char* unit, const char* meaning) {
    Parameter parameter = make(key, Kind::numbers, unit, meaning);
    parameter.length = length;
    return parameter;
}

Parameter pixels(const char* key, double fallback, const char* meaning) {
    Parameter parameter = make(key, Kind::integer, "pixels", meaning);
    parameter.range = between(200.0, 8000.0);
    parameter.fallback = fallback;
    return parameter;
}

void add_when(Table& table) {
    table.push_back(absent(instead(number("insitu.every", "s", positive,
                                          "time between two looks: at the start, after the first step at or past "
                                          "each multiple, and at the end; the run's steps stay what they are"),
                                   "insitu.every_steps"),
                           "every output"));
    Parameter steps = make("insitu.every_steps", Kind::integer, "steps", "steps of the run between two looks");
    steps.range = between(1.0, 1e9);
    table.push_back(absent(instead(steps, "insitu.every"), "every output"));
}

void add_what(Table& table) {
    Parameter field = make("insitu.field", Kind::choice, "", "quantity that is looked at, one number a place");
    field.choices = scalar_names();
    table.push_back(with(field, kind, {"contour", "threshold", "figure"}, {"contour", "threshold", "figure"}));
    Parameter fields = make("insitu.fields", Kind::words, "", "quantities of the table");
    fields.choices = scalar_names();
    fields.fallback = std::vector<std::string>{"depth", "speed"};
    table.push_back(with(fields, kind, {"profile", "reduce"}));
    Parameter line = make("insitu.line", Kind::points, "m", "the cut's line: [[x, y], [x, y], ...]");
    line.length = 2;
    table.push_back(with(line, kind, {"profile"}, {"profile"}));
    table.push_back(with(flag("insitu.picture", false,
                              "a line chart of the cut besides its "
                              "table"),
                         kind, {"profile"}));
    table.push_back(
        with(list("insitu.levels", 0, "", "values of the lines, in the field's unit"), kind, {"contour"}, {"contour"}));
    Parameter of = choice("insitu.of", {"grid", "particles"}, "grid", "cells of the grid, or particles");
    table.push_back(with(of, kind, {"threshold"}));
    table.push_back(
        absent(with(number("insitu.from", "", any_number, "smallest value that is kept, in the field's unit"), kind,
                    {"threshold"}),
               "no lower limit"));
    table.push_back(absent(with(number("insitu.to", "", any_number, "largest value that is kept, in the field's unit"),
                                kind, {"threshold"}),
                           "no upper limit"));
    table.push_back(
        with(flag("insitu.gis", false,
                  "besides, for a GIS: insitu/NAME.gpkg with the lines, or the outlines of the cells, at all "
                  "times, in the coordinate system of the elevation model"),
             kind, {"contour", "threshold"}));
    table.push_back(
        absent(with(number("insitu.above", "", not_negative,
                           "reduce: depth [m] above which a node counts; figure: size of the field above "
                           "which it is drawn, in its unit"),
                    kind, {"figure", "reduce"}),
               "output.footprint_depth; fields other than a depth are then shown where the flow is deeper"));
}

void add_picture(Table& table) {
    table.push_back(
        absent(with(make("insitu.camera", Kind::name, "", "name of the [[camera]] of the picture"), kind, {"figure"}),
               "a map of the whole terrain"));
    table.push_back(
        absent(with(list("insitu.range", 2, "", "[low, high] of the colours, in the field's unit"), kind, {"figure"}),
               "each picture's own range"));
    table.push_back(with(pixels("insitu.width", 1000.0, "of the picture"), kind, {"figure", "profile"}));
    table.push_back(with(pixels("insitu.height", 800.0, "of the picture"), kind, {"figure", "profile"}));
    table.push_back(with(make("insitu.script", Kind::path, "", "ParaView Catalyst script in Python, version 2.0"), kind,
                         {"catalyst"}, {"catalyst"}));
}

void add_camera(Table& table) {
    const char* projection = "camera.projection";
    table.push_back(required(make("camera.name", Kind::name, "", "name that [[insitu]] gives in camera = ...")));
    Parameter kinds = make(projection, Kind::choice, "", "map: from above, north up; perspective: as an eye sees it");
    kinds.choices = {"map", "perspective"};
    table.push_back(required(kinds));
    table.push_back(absent(list("camera.window", 4, "m", "part of the terrain to show: [xmin, ymin, xmax, ymax]"),
                           "the whole terrain"));
    table.push_back(with(list("camera.position", 3, "m", "where the eye is: [x, y, elevation]"), projection,
                         {"perspective"}, {"perspective"}));
    table.push_back(with(list("camera.target", 3, "m", "what it looks at: [x, y, elevation]"), projection,
                         {"perspective"}, {"perspective"}));
    table.push_back(with(number("camera.view_angle_deg", "degree", between(1.0, 120.0), 30.0,
                                "its angle of view, "
                                "upright"),
                         projection, {"perspective"}));
}

}  // namespace

void add_insitu(Table& table) {
    table.push_back(required(make("insitu.name", Kind::name, "", "name of the files: insitu/NAME...")));
    Parameter kinds = make(kind, Kind::choice, "",
                           "profile: values along a line, a table; contour: lines of equal value, .vtp; threshold: "
                           "what "
                           "lies between two values, .vtu or .vtp; figure: a picture, .png; reduce: extremes, mean, "
                           "covered area and volume, a table; catalyst: a ParaView script");
    kinds.choices = {"profile", "contour", "threshold", "figure", "reduce", "catalyst"};
    table.push_back(required(kinds));
    add_when(table);
    add_what(table);
    add_picture(table);
    add_camera(table);
}

}  // namespace frana
