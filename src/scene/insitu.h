#pragma once
// What is observed inside the solver process while a case runs: plain data, as [[insitu]] and [[camera]] give it.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// A view for the pictures of [[insitu]].
struct Camera {
    std::string name;
    bool perspective = false;                     ///< or a map
    std::optional<std::array<double, 4>> window;  ///< xmin, ymin, xmax, ymax in view [m]; nothing: all terrain
    std::array<double, 3> position{}, target{};   ///< of the perspective: x, y, elevation [m]
    double view_angle_deg = 30.0;                 ///< upright [degree]
};

/// One [[insitu]]. Which members count depends on the kind; `frana describe insitu` says what they mean.
struct Insitu {
    enum class Kind { profile, contour, threshold, figure, reduce, catalyst };
    std::string name;
    Kind kind = Kind::profile;
    std::string place;                 ///< "case.toml:12: insitu.0", for messages
    std::optional<double> every;       ///< [s]
    std::optional<Index> every_steps;  ///< neither: every output
    std::vector<std::string> fields;   ///< scalar names; one of contour, threshold and figure
    Polyline line;
    bool picture = false;  ///< of a profile
    std::vector<double> levels;
    bool of_particles = false;
    bool gis = false;                ///< of contour and threshold: a GeoPackage besides
    std::optional<double> from, to;  ///< of threshold
    std::optional<double> above;     ///< of figure and reduce
    std::optional<std::pair<double, double>> range;
    std::optional<Camera> camera;
    int width = 1000, height = 800;  ///< [px]
    std::filesystem::path script;
};

/// "profile", "contour", ...: the word of the case file.
const char* kind_word(Insitu::Kind kind);

}  // namespace frana
