#include "vtk_io/seeds_vtp.h"

#include "vtk_io/points_vtp.h"

namespace frana {

void write_seeds_vtp(const std::filesystem::path& file, const SeedsExport& data) {
    const Seeds& seeds = data.seeds;
    std::vector<double> surface;
    surface.reserve(3 * seeds.x.size());
    for (std::size_t p = 0; p < seeds.x.size(); ++p)
        surface.insert(surface.end(), {seeds.x[p], seeds.y[p], data.elevation[p] + seeds.depth[p]});
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    write_points_vtp(file, seeds_table(data, columns), surface.data());
}

}  // namespace frana
