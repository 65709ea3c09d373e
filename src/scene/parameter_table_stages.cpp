// The keys of [[barrier]] and of [[stage]]. A stage says which model carries the material until when, and how the 3D
// one is set up.
#include "law/solid/laws.h"
#include "scene/parameter_makers.h"

namespace frana {
namespace {

using namespace rows;

const char* const model = "stage.model";
const std::vector<std::string> in_3d = {"mpm3d"};

Parameter of_3d(Parameter parameter, const char* otherwise) {
    return absent(with(std::move(parameter), model, in_3d), otherwise);
}

/// Keys of laws of 3D material, which bring them; other laws refuse them.
void add_laws(Table& table) {
    const char* const law = "stage.law";
    Parameter choice_of_law = make(law, Kind::choice, "", "law of the material in 3D");
    choice_of_law.choices = solid::words();
    table.push_back(
        of_3d(choice_of_law,
              "bingham or a fluid, by the rheology or the bed law of mud; else mu_i by a bed law pouliquen, "
              "sand as steep inside as the bed's friction, or a fluid on a bed without"));
    for (const auto& [key, used_by, needed_by] : solid::shared_keys()) {
        const std::string name = std::string("stage.") + key.name;
        Parameter row = number(name.c_str(), key.unit, key.range, key.meaning);
        if (!key.choices.empty())
            row = choice(name.c_str(), key.choices, key.choices.front().c_str(), key.meaning);
        else if (key.missing == laws::Missing::usual)
            row.fallback = key.usual;
        if (key.missing == laws::Missing::none)  // a case without stage.law may have it too
            table.push_back(of_3d(row, key.absent));
        else
            table.push_back(with(row, law, used_by, needed_by));
    }
}

}  // namespace

void add_barriers(Table& table) {
    table.push_back(absent(make("barrier.name", Kind::name, "", "name in reports and of the barrier's files"),
                           "barrier_1, barrier_2, ..."));
    table.push_back(
        absent(instead(make("barrier.outline", Kind::path, "",
                            "polygons on which the barrier stands with vertical walls: any OGR vector file"),
                       "barrier.line"),
               "line is needed"));
    table.push_back(flag("barrier.each", false,
                         "every polygon of the outline is a barrier of its own, NAME_1, NAME_2, ...; otherwise all are "
                         "one"));
    Parameter line =
        make("barrier.line", Kind::points, "m", "foot of a wall's face that material comes to: [[x, y], [x, y], ...]");
    line.length = 2;
    table.push_back(absent(instead(line, "barrier.outline"), "outline is needed"));
    table.push_back(
        absent(make("barrier.mesh", Kind::path, "",
                    "instead of outline, line, height and top: a closed surface in metres (.stl, .vtp or .obj)"),
               "outline or line is needed"));
    Parameter origin =
        make("barrier.origin", Kind::numbers, "m",
             "where the mesh's own coordinates begin in the map: [x, y, elevation]; such files hold seven "
             "digits");
    origin.length = 3;
    table.push_back(absent(origin, "0, 0, 0"));
    table.push_back(
        choice("barrier.wet", {"left", "right"}, "left",
               "side of the line, walking along it, that material comes from; the wall stands on the other"));
    table.push_back(absent(number("barrier.thickness", "m", positive, "thickness of a wall along a line"),
                           "as little as keeps both sides apart: three cells of the stage, up to 4.3 askew"));
    table.push_back(absent(
        instead(number("barrier.height", "m", positive, "height above the bed, which the top follows"), "barrier.top"),
        "top or height_field is needed"));
    table.push_back(absent(make("barrier.height_field", Kind::text, "",
                                "instead of height: attribute of each polygon that holds it [m]; with each"),
                           "height or top is needed"));
    table.push_back(
        absent(instead(number("barrier.top", "m", any_number, "elevation of a level top"), "barrier.height"),
               "height or height_field is needed"));
    table.push_back(
        number("barrier.friction", "1", between(0.0, 10.0), 0.0,
               "Coulomb's friction coefficient between 3D points, or structured particles, and the barrier"));
    table.push_back(flag("barrier.stuck", false, "3D points and structured particles do not slide along the barrier"));
    Parameter windows =
        make("barrier.windows", Kind::numbers, "s",
             "times over which forces of 3D points are averaged: one to eight, ascending, up to 10 s; the report "
             "gives the largest mean over each; before the start there is no force");
    windows.fallback = std::vector<double>{0.01, 0.05, 1.0};
    table.push_back(windows);
}

void add_stages(Table& table) {
    Parameter choice_of_model =
        make(model, Kind::choice, "",
             "depth_averaged: particles; mpm3d: 3D points, within the stage's window; particles may come before it, "
             "after it, or both");
    choice_of_model.choices = {"depth_averaged", "mpm3d"};
    choice_of_model.former = {{"solid_flow", "mpm3d"}};
    table.push_back(required(choice_of_model));
    table.push_back(absent(number("stage.until", "s", positive, "time at which the stage ends and the next begins"),
                           "the end of the run"));
    Parameter window = make("stage.window", Kind::numbers, "m",
                            "where material becomes 3D points: [xmin, ymin, xmax, ymax] in map coordinates; "
                            "cells whose nodes lie in it belong to it");
    window.length = 4;
    table.push_back(of_3d(window, "the whole terrain"));
    Parameter closed = make("stage.closed", Kind::words, "",
                            "sides of the window that points do not cross; particles still come in over them");
    closed.choices = {"west", "east", "south", "north"};
    closed.may_be_empty = true;
    closed.fallback = std::vector<std::string>{};
    table.push_back(with(closed, model, in_3d));
    table.push_back(
        of_3d(number("stage.cell", "m", positive, "node distance of the 3D grid"), "half of the grid's cell"));
    table.push_back(of_3d(number("stage.spacing", "m", positive, "distance of the 3D points at the start"),
                          "half of the stage's cell: eight points a cell"));
    table.push_back(of_3d(
        number("stage.top", "m", any_number, "elevation above which points leave the space"),
        "four times as high above the lowest ground as the energy of the material reaches, and at least eight cells of "
        "the stage above the highest ground"));
    add_laws(table);
    table.push_back(of_3d(
        make("stage.stuck", Kind::flag, "", "the lowest material does not slide on the bed"),
        "false; of mud by its bed law, with neither stage.law nor stage.bed_friction: true where the cells show the "
        "layer that shears at the bed"));
    table.push_back(of_3d(number("stage.bed_friction", "1", between(0.0, 10.0),
                                 "Coulomb's friction coefficient between the points and the bed"),
                          "the whole law of material.bed"));
    table.push_back(with(
        number("stage.cfl", "1", above_to(0.0, 1.0), 0.4, "largest way of sound and flow in one time step, in cells"),
        model, in_3d));
    Parameter transfer =
        make("stage.transfer", Kind::choice, "",
             "how velocity passes between points and grid: tpic has the quieter pressure, apic keeps angular momentum, "
             "flip lets points keep their velocity, so that what few cells hold is damped by time and not by step");
    transfer.choices = {"tpic", "apic", "flip"};
    table.push_back(of_3d(transfer, "flip for drucker_prager and mu_i, else tpic"));
    table.push_back(
        of_3d(number("stage.blending", "s", positive, "time in which points with flip take over the grid's velocity"),
              "sqrt(cell / gravity), in which material falls half a cell"));
    table.push_back(
        of_3d(make("stage.split", Kind::flag, "",
                   "points that are drawn 0.8 of a cell apart become two, down to 1/64 of a cell each: thin ends "
                   "keep together; up to eight times as many points"),
              "true for drucker_prager and mu_i, else false"));
    table.push_back(with(choice("stage.profile", {"plug", "linear", "parabolic", "bagnold"}, "plug",
                                "velocity over the depth that particles become points with"),
                         model, in_3d));
    table.push_back(with(choice("stage.vertical", {"along-bed", "zero"}, "along-bed",
                                "vertical velocity that particles become points with; zero: Fois et al. (2025)"),
                         model, in_3d));
}

}  // namespace frana
