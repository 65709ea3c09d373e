// A build without ParaView Catalyst.
#include "vtk_io/catalyst.h"

#include "base/error.h"

namespace frana {

void check_catalyst(const std::filesystem::path&, const std::string& place) {
    throw UserError(place +
                    ".kind: found \"catalyst\"; expected another kind, since this frana was built without ParaView "
                    "Catalyst; build it with cmake -DFRANA_CATALYST=legacy (README.md), or remove this [[insitu]]");
}

std::unique_ptr<InsituWork> make_catalyst(const std::filesystem::path&) {
    throw InternalError("internal error: a Catalyst script in a build without Catalyst");
}

}  // namespace frana
