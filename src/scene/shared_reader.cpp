#include "scene/shared_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace frana {
namespace {

std::string text_of(const GridGeometry& g) { return fmt::format("{} {} {} {} {}", g.nx, g.ny, g.x0, g.y0, g.cell); }

std::string text_of(const DemRequest& request) {
    std::string text;
    if (request.window) text += fmt::format("window {} ", *request.window);
    if (request.cell) text += fmt::format("cell {} ", *request.cell);
    return text;
}

std::string text_of(const NodeBox& box) { return fmt::format("part {} {} {} {}", box.i0, box.j0, box.nx, box.ny); }

}  // namespace

template <class Answer, class Read>
Answer SharedReader::recalled(Memory<Answer>& memory, const std::string& question, std::vector<std::string>& log,
                              const Read& read) const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    auto found = memory.find(question);
    if (found == memory.end()) {
        Known<Answer> known;
        known.answer = read(known.remarks);
        found = memory.emplace(question, std::move(known)).first;
    }
    log.insert(log.end(), found->second.remarks.begin(), found->second.remarks.end());
    return found->second.answer;
}

/// Which part is needed is found for each scene anew, since its releases may lie elsewhere. That reads files as well.
Raster SharedReader::read_dem(const std::filesystem::path& file, const DemRequest& request,
                              std::vector<std::string>& log) const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    const std::string question = fmt::format("{} {}", file.string(), text_of(request));
    const auto whole = whole_.find(question);
    DemRequest told = request;
    if (request.choose && whole == whole_.end()) {
        NodeBox chosen;
        told.choose = [&](const Raster& grid) {
            chosen = request.choose(grid);
            whole_.emplace(question, grid);
            return chosen;
        };
        Known<Raster> known;
        known.answer = inner_.read_dem(file, told, known.remarks);
        forget_terrain();
        log.insert(log.end(), known.remarks.begin(), known.remarks.end());
        return terrain_.emplace(question + text_of(chosen), std::move(known)).first->second.answer;
    }
    std::string part;
    if (request.choose) {
        const NodeBox box = request.choose(whole->second);
        part = text_of(box);
        told.choose = [box](const Raster&) { return box; };
        if (terrain_.count(question + part) == 0) forget_terrain();
    }
    return recalled(terrain_, question + part, log,
                    [&](auto& remarks) { return inner_.read_dem(file, told, remarks); });
}

/// Scenes that begin elsewhere need other parts: only some of them are held.
void SharedReader::forget_terrain() const {
    constexpr std::size_t at_most = 16;
    if (terrain_.size() >= at_most) terrain_.clear();
}

std::function<Raster(const NodeBox&)> SharedReader::read_dem_later(const std::filesystem::path& file,
                                                                   const DemRequest& request) const {
    auto later = inner_.read_dem_later(file, request);
    if (!later) return {};
    return [later, mutex = mutex_](const NodeBox& box) {
        const std::lock_guard<std::recursive_mutex> alone(*mutex);
        return later(box);
    };
}

std::shared_ptr<const GisReader> SharedReader::lasting() const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    return inner_.lasting();
}

void SharedReader::require_metres(const std::filesystem::path& file) const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    inner_.require_metres(file);
}

std::string SharedReader::unit_of(const std::filesystem::path& file) const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    return inner_.unit_of(file);
}

RasterPlace SharedReader::place_of(const std::filesystem::path& file, const std::array<double, 4>& extent,
                                   const std::string& crs_wkt) const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    return inner_.place_of(file, extent, crs_wkt);
}

std::optional<std::array<double, 4>> SharedReader::extent_above_zero(const std::filesystem::path& file,
                                                                     const std::array<double, 4>& extent,
                                                                     const std::string& crs_wkt) const {
    const std::lock_guard<std::recursive_mutex> alone(*mutex_);
    return inner_.extent_above_zero(file, extent, crs_wkt);
}

Raster SharedReader::read_raster(const std::filesystem::path& file, const std::array<double, 4>& extent,
                                 const std::string& crs_wkt, std::vector<std::string>& log) const {
    return recalled(rasters_, fmt::format("raster {} {} {}", file.string(), extent, crs_wkt), log,
                    [&](auto& remarks) { return inner_.read_raster(file, extent, crs_wkt, remarks); });
}

Raster SharedReader::read_mask(const std::filesystem::path& file, const std::array<double, 4>& extent,
                               const std::string& crs_wkt, std::vector<std::string>& log) const {
    return recalled(rasters_, fmt::format("mask {} {} {}", file.string(), extent, crs_wkt), log,
                    [&](auto& remarks) { return inner_.read_mask(file, extent, crs_wkt, remarks); });
}

Raster SharedReader::read_onto(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                               std::vector<std::string>& log) const {
    return recalled(rasters_, fmt::format("onto {} {} {}", file.string(), text_of(grid), crs_wkt), log,
                    [&](auto& remarks) { return inner_.read_onto(file, grid, crs_wkt, remarks); });
}

Raster SharedReader::read_deposit(const std::filesystem::path& file, const GridGeometry& grid,
                                  const std::string& crs_wkt, std::vector<std::string>& log) const {
    return recalled(rasters_, fmt::format("deposit {} {} {}", file.string(), text_of(grid), crs_wkt), log,
                    [&](auto& remarks) { return inner_.read_deposit(file, grid, crs_wkt, remarks); });
}

Polygons SharedReader::read_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                                     std::vector<std::string>& log) const {
    return recalled(polygons_, file.string() + " " + crs_wkt, log,
                    [&](auto& remarks) { return inner_.read_polygons(file, crs_wkt, remarks); });
}

ValuedPolygons SharedReader::read_valued_polygons(const std::filesystem::path& file, const std::string& attribute,
                                                  const std::string& crs_wkt, std::vector<std::string>& log) const {
    return recalled(valued_, file.string() + " " + attribute + " " + crs_wkt, log,
                    [&](auto& remarks) { return inner_.read_valued_polygons(file, attribute, crs_wkt, remarks); });
}

Polygons SharedReader::read_survey(const std::filesystem::path& file, const std::array<double, 4>& extent,
                                   const std::string& crs_wkt, std::vector<std::string>& log) const {
    return recalled(polygons_, fmt::format("survey {} {} {}", file.string(), extent, crs_wkt), log,
                    [&](auto& remarks) { return inner_.read_survey(file, extent, crs_wkt, remarks); });
}

std::vector<Polyline> SharedReader::read_lines(const std::filesystem::path& file, const std::string& crs_wkt,
                                               std::vector<std::string>& log) const {
    return recalled(lines_, file.string() + " " + crs_wkt, log,
                    [&](auto& remarks) { return inner_.read_lines(file, crs_wkt, remarks); });
}

Polyline SharedReader::read_line(const std::filesystem::path& file, const std::string& crs_wkt,
                                 std::vector<std::string>& log) const {
    return recalled(line_, file.string() + " " + crs_wkt, log,
                    [&](auto& remarks) { return inner_.read_line(file, crs_wkt, remarks); });
}

}  // namespace frana
