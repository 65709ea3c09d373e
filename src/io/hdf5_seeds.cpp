#include "io/hdf5_seeds.h"

#include "io/hdf5_points.h"

namespace frana {

void write_seeds_hdf5(const std::filesystem::path& file, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    write_points_hdf5(file, seeds_table(data, columns));
}

}  // namespace frana
