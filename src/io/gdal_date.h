#pragma once
// Not for callers outside src/io.
#include <cpl_conv.h>

namespace frana::gdal {

/// GeoPackages carry the time of their making and of their last change, unless GDAL is told one.
class WithoutDate {
public:
    WithoutDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"); }
    ~WithoutDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }
    WithoutDate(const WithoutDate&) = delete;
    WithoutDate& operator=(const WithoutDate&) = delete;
};

}  // namespace frana::gdal
