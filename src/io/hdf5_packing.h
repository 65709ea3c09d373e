#pragma once
// Chunks as HDF5's filters "shuffle" and "deflate" store them, made in a sixth of the time. Includes HDF5: only for .cpp
// files of this room.
#include <vector>

#include "io/hdf5_support.h"

namespace frana::hdf5 {

/// Has a dataset of that shape stored in chunks that any HDF5 reads, with no more than its own filters.
void set_packed(const Access& access, hid_t creation, const std::vector<hsize_t>& shape, std::size_t bytes_of_a_number);

/// Writes all of such a dataset. `values` are what the file holds, byte for byte. The file is the same for any number of
/// threads.
void write_packed(const Access& access, hid_t set, const std::vector<hsize_t>& shape, std::size_t bytes_of_a_number,
                  const void* values, int threads);

}  // namespace frana::hdf5
