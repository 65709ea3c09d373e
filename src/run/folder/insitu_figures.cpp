#include "run/folder/insitu_figures.h"

#include <fmt/core.h>

#include <algorithm>
#include <type_traits>

#include "base/error.h"
#include "observe/insitu_tables.h"
#include "observe/profiles.h"
#include "run/folder/barrier_plans.h"
#include "vtk_io/figures/chart_figure.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/map_figure_perspective.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// "peak_depth" for people.
std::string words(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

/// Pictures in a folder of their own.
class Pictures {
public:
    Pictures(const fs::path& folder, std::string name) : folder_(folder / name), name_(std::move(name)) {}

    /// `draw` returns false with a reason when there is no picture.
    template <class Draw>
    void add(Index number, const Draw& draw) const {
        std::error_code failure;
        fs::create_directories(folder_, failure);
        if (failure)
            throw UserError(fmt::format("{}: cannot be made: {}; check the folder's permissions and free space",
                                        folder_.string(), failure.message()));
        std::string why_not;
        if (!draw(folder_ / fmt::format("{}_{:06d}.png", name_, number), why_not)) throw UserError(why_not);
    }

private:
    fs::path folder_;
    std::string name_;
};

std::string title_of(const Scene& scene, const std::string& what, const Frame& frame) {
    return fmt::format("{}: {}, t = {:.2f} s", scene.title.empty() ? scene.name : scene.title, what, frame.status.time);
}

bool is_depth(const std::string& field) { return field == "depth" || field == "thickness" || field == "peak_depth"; }

/// What may be below zero, and is coloured so.
bool is_signed(const std::string& field) {
    return field.find("stress") != std::string::npos || field.rfind("velocity", 0) == 0;
}

class FigureWork final : public InsituWork {
public:
    FigureWork(const Scene& scene, const Insitu& entry, const fs::path& folder)
        : scene_(scene), entry_(entry), pictures_(folder, entry.name) {
        view_.bed = scene.bed;
        view_.range = map_.range = entry.range;
        view_.width = map_.width = entry.width;
        view_.height = map_.height = entry.height;
        view_.survey = map_.survey = scene.survey;
        view_.barriers = map_.barriers = barrier_plans(scene.barriers);
        view_.colormap = map_.colormap = is_signed(entry.fields.front()) ? Colormap::diverging : Colormap::depth;
        view_.raised = is_depth(entry.fields.front());
        view_.focus = map_.focus = scene.bed.geometry.pixel_extent();
        if (entry.camera && entry.camera->window) view_.focus = map_.focus = entry.camera->window;
        if (perspective()) {
            const Camera& camera = *entry.camera;
            view_.eye = PerspectiveFigure::Eye{camera.position, camera.target, camera.view_angle_deg};
        } else {
            map_.bed = scene.bed;
        }
    }

    void sample(const Frame& frame, Index number) override {
        const Scalar values = scalar(frame.nodes, entry_.fields.front(), "the grid");
        pictures_.add(number, [&](const fs::path& png, std::string& why_not) {
            if (perspective()) return fill(view_, frame, values), render_perspective(view_, png, why_not);
            return fill(map_, frame, values), render_map(map_, png, why_not);
        });
    }

private:
    bool perspective() const { return entry_.camera && entry_.camera->perspective; }

    /// The depth that says where a field is shown; peaks and arrivals outlast the flow.
    static const char* extent_of(const std::string& field) {
        return field.rfind("peak", 0) == 0 || field == "arrival_time" ? "peak_depth" : "depth";
    }

    /// A depth is shown and outlined by its own size, another field too when `above` is given. Else the flow's depth
    /// decides.
    template <class Figure>
    void fill(Figure& figure, const Frame& frame, const Scalar& values) const {
        const bool by_itself = is_depth(values.name) || entry_.above;
        figure.field = numbers(values);
        figure.shown_above = by_itself && entry_.above ? *entry_.above : scene_.output.footprint_depth;
        if (!by_itself) {
            const Scalar extent = scalar(frame.nodes, extent_of(values.name), "the grid");
            figure.outline_field = numbers(extent);
            if constexpr (std::is_same_v<Figure, MapFigure>)
                figure.outline_label = fmt::format("{} [{}]", words(extent.name), extent.unit);
        }
        figure.title = title_of(scene_, words(values.name), frame);
        figure.field_label = fmt::format("{} [{}]", words(values.name), values.unit);
    }

    static std::vector<double> numbers(const Scalar& values) {
        std::vector<double> result(static_cast<std::size_t>(values.count));
        for (Index k = 0; k < values.count; ++k) result[static_cast<std::size_t>(k)] = values[k];
        return result;
    }

    const Scene& scene_;
    const Insitu& entry_;
    Pictures pictures_;
    MapFigure map_;
    PerspectiveFigure view_;
};

/// The ground and the flow's surface in one panel, every other field in one of its own.
class CutFigure final : public InsituWork {
public:
    CutFigure(const Scene& scene, const Insitu& entry, const fs::path& folder)
        : scene_(scene), entry_(entry), pictures_(folder, entry.name) {}

    void sample(const Frame& frame, Index number) override {
        const std::vector<Station> places = stations(entry_.line, 0.5 * frame.grid.cell);
        std::vector<double> x;
        x.reserve(places.size());
        for (const Station& place : places) x.push_back(place.distance);
        const auto curve = [&](const std::string& field, Curve::Kind kind) {
            const Scalar values = scalar(frame.nodes, field, "the grid");
            Curve result{words(field), x, {}, kind};
            for (const Station& place : places) result.y.push_back(value_at(values, frame.grid, place.point));
            return result;
        };
        ChartFigure chart;
        chart.title = title_of(scene_, words(entry_.name), frame);
        chart.x_label = "distance along the line [m]";
        chart.width = entry_.width;
        chart.height = entry_.height;
        ChartPanel ground{"elevation [m]", {}, false, {}, 1.4};
        ground.curves = {curve("elevation", Curve::Kind::ground), curve("surface", Curve::Kind::water)};
        hide_dry(ground.curves[0].y, ground.curves[1].y);
        chart.panels = {ground};
        for (const std::string& field : entry_.fields) {
            if (field == "elevation" || field == "surface") continue;
            const std::string unit = scalar(frame.nodes, field, "the grid").unit;
            chart.panels.push_back(
                {fmt::format("{} [{}]", words(field), unit), {curve(field, Curve::Kind::line)}, false, {}, 1.0});
        }
        pictures_.add(number,
                      [&](const fs::path& png, std::string& why_not) { return render_chart(chart, png, why_not); });
    }

private:
    /// A surface only where there is a flow under it. It extends to the first station next to it, so that it closes.
    static void hide_dry(const std::vector<double>& bed, std::vector<double>& surface) {
        const std::vector<double> all = surface;
        const auto wet = [&](std::size_t i) { return all[i] > bed[i]; };
        for (std::size_t i = 0; i < all.size(); ++i)
            if (!wet(i) && !(i > 0 && wet(i - 1)) && !(i + 1 < all.size() && wet(i + 1))) surface[i] = Raster::nodata;
    }

    const Scene& scene_;
    const Insitu& entry_;
    Pictures pictures_;
};

}  // namespace

std::unique_ptr<InsituWork> make_figure(const Scene& scene, const Insitu& entry, const fs::path& folder) {
    return std::make_unique<FigureWork>(scene, entry, folder);
}

std::unique_ptr<InsituWork> make_cut_figure(const Scene& scene, const Insitu& entry, const fs::path& folder) {
    return std::make_unique<CutFigure>(scene, entry, folder);
}

}  // namespace frana
