#pragma once
// The frames of a run as XDMF text over HDF5, for readers that do not use VTK's own files.
#include <filesystem>
#include <memory>

#include "observe/observer.h"

namespace frana {

/// Observer that writes run.h5 and run.xdmf in `run_dir`. run.h5 holds frame_NNNNNN/grid/<name> with shape
/// (1, ny, nx) or (1, ny, nx, 3). It also holds frame_NNNNNN/particles/<name> with shape (count) or (count, 3). Arrays
/// are contiguous and not compressed. Each has an attribute "unit" and, for 3 components, "components". A frame has the
/// attributes "time" [s] and "number"; its grid "origin" and "cell" [m]. Where some nodes have no terrain, grid/outside
/// (uint8) is 1 there. run.xdmf lists two temporal collections: "grid" (3DCoRectMesh of one layer) and "particles".
/// Those are a Polyvertex; a frame without particles has a mesh of no points. Each frame is closed in run.h5 before
/// run.xdmf names it, so both can be read while the run goes on. observe() throws UserError (path and reason) when
/// writing fails, NumericsError for a number that is not finite.
std::unique_ptr<Observer> make_xdmf_writer(const std::filesystem::path& run_dir);

}  // namespace frana
