#pragma once
// One reader for many scenes: each file is read once.
#include <map>
#include <memory>
#include <mutex>

#include "scene/toolbox.h"

namespace frana {

/// Answers from what `inner` said before to the same question. Scenes may be built on several threads at once: one of
/// them at a time calls `inner`. Files that change meanwhile are not read again.
class SharedReader : public GisReader {
public:
    explicit SharedReader(const GisReader& inner) : inner_(inner) {}

    Raster read_dem(const std::filesystem::path& file, const DemRequest& request,
                    std::vector<std::string>& log) const override;
    std::function<Raster(const NodeBox&)> read_dem_later(const std::filesystem::path& file,
                                                         const DemRequest& request) const override;
    /// The inner one's: what this one remembers would grow with each part.
    std::shared_ptr<const GisReader> lasting() const override;
    void require_metres(const std::filesystem::path& file) const override;
    std::string unit_of(const std::filesystem::path& file) const override;
    RasterPlace place_of(const std::filesystem::path& file, const std::array<double, 4>& extent,
                         const std::string& crs_wkt) const override;
    std::optional<std::array<double, 4>> extent_above_zero(const std::filesystem::path& file,
                                                           const std::array<double, 4>& extent,
                                                           const std::string& crs_wkt) const override;
    Raster read_raster(const std::filesystem::path& file, const std::array<double, 4>& extent,
                       const std::string& crs_wkt, std::vector<std::string>& log) const override;
    Raster read_mask(const std::filesystem::path& file, const std::array<double, 4>& extent, const std::string& crs_wkt,
                     std::vector<std::string>& log) const override;
    Raster read_onto(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                     std::vector<std::string>& log) const override;
    Raster read_deposit(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                        std::vector<std::string>& log) const override;
    Polygons read_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                           std::vector<std::string>& log) const override;
    ValuedPolygons read_valued_polygons(const std::filesystem::path& file, const std::string& attribute,
                                        const std::string& crs_wkt, std::vector<std::string>& log) const override;
    Polygons read_survey(const std::filesystem::path& file, const std::array<double, 4>& extent,
                         const std::string& crs_wkt, std::vector<std::string>& log) const override;
    std::vector<Polyline> read_lines(const std::filesystem::path& file, const std::string& crs_wkt,
                                     std::vector<std::string>& log) const override;
    Polyline read_line(const std::filesystem::path& file, const std::string& crs_wkt,
                       std::vector<std::string>& log) const override;

private:
    /// What was read, and what was remarked on it.
    template <class Answer>
    struct Known {
        Answer answer;
        std::vector<std::string> remarks;
    };
    template <class Answer>
    using Memory = std::map<std::string, Known<Answer>>;
    template <class Answer, class Read>
    Answer recalled(Memory<Answer>& memory, const std::string& question, std::vector<std::string>& log,
                    const Read& read) const;

    void forget_terrain() const;

    const GisReader& inner_;
    /// What part is needed may depend on other files, so one call may cause another.
    std::shared_ptr<std::recursive_mutex> mutex_ = std::make_shared<std::recursive_mutex>();
    mutable Memory<Raster> rasters_, terrain_;
    mutable std::map<std::string, Raster> whole_;  ///< grids without values, as DemRequest::choose is told
    mutable Memory<Polygons> polygons_;
    mutable Memory<ValuedPolygons> valued_;
    mutable Memory<std::vector<Polyline>> lines_;
    mutable Memory<Polyline> line_;
};

}  // namespace frana
