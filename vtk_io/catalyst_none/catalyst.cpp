// A build without ParaView Catalyst.
#include "vtk_io/catalyst.h"

#include "base/error.h"

namespace frana {

std::string no_catalyst_reason() {
    return "this frana was built without ParaView Catalyst (cmake -DFRANA_CATALYST=legacy, see README.md)";
}

std::unique_ptr<InsituWork> make_catalyst(const std::filesystem::path&) { throw UserError(no_catalyst_reason()); }

}  // namespace frana
