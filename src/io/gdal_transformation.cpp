#include "io/gdal_transformation.h"

#include <cmath>

namespace frana::gdal {
namespace {

/// Around the extent, in degrees west, south, east, north. False where it is not known.
bool place_in_degrees(const OGRSpatialReference& from, const std::array<double, 4>& e, std::array<double, 4>& place) {
    const std::unique_ptr<OGRSpatialReference> degrees(from.CloneGeogCS());
    if (!degrees) return false;
    degrees->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const Transformation there(OGRCreateCoordinateTransformation(&from, degrees.get()));
    constexpr int points = 21;  // along each edge, which need not stay straight
    return there &&
           there->TransformBounds(e[0], e[1], e[2], e[3], &place[0], &place[1], &place[2], &place[3], points) != 0 &&
           std::isfinite(place[0]) && std::isfinite(place[1]) && std::isfinite(place[2]) && std::isfinite(place[3]);
}

}  // namespace

Transformation transformation(const OGRSpatialReference& from, const OGRSpatialReference& to,
                              const std::array<double, 4>& extent) {
    OGRCoordinateTransformationOptions options;
    {
        const Messages quiet;  // without a place it is as it was
        std::array<double, 4> place{};
        if (place_in_degrees(from, extent, place)) options.SetAreaOfInterest(place[0], place[1], place[2], place[3]);
    }
    return Transformation(OGRCreateCoordinateTransformation(&from, &to, options));
}

}  // namespace frana::gdal
