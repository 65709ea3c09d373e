#pragma once
// Figures that are drawn side by side.
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "run/folder/run_record.h"

namespace frana {

/// What is to be drawn into a folder. A picture that cannot be drawn is one warning and never more: the run is worth more
/// than its pictures.
class Gallery {
public:
    /// Draws into a PNG, on any thread; false with a reason when that is not possible.
    using Draw = std::function<bool(const std::filesystem::path& png, std::string& why_not)>;

    explicit Gallery(std::filesystem::path run_dir) : run_dir_(std::move(run_dir)) {}

    /// What `draw` refers to has to stay until draw() is over.
    void add(DrawnFigure figure, Draw draw) {
        wanted_.push_back({std::move(figure), std::move(draw), "", false, false});
    }
    /// One for the renderer, of which a process has one. These are begun first, since they take longest, and one after the
    /// other while there is anything else to draw.
    void add_rendered(DrawnFigure figure, Draw draw) {
        wanted_.push_back({std::move(figure), std::move(draw), "", false, true});
    }
    void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
    /// A warning in its place among those of the figures.
    void warn(std::string warning) { wanted_.push_back({{}, nullptr, std::move(warning), false, false}); }

    /// Draws all on so many threads. Returns what was made, in the order in which it was added. Once an end was
    /// requested (run/folder/cutoff.h, or `stop_when`) nothing more is begun.
    /// `tell` hears how many are done, of how many; one thread at a time, with none done first.
    using Tell = std::function<void(std::size_t done, std::size_t all)>;
    std::vector<DrawnFigure> draw(int threads, std::vector<std::string>& warnings, const Tell& tell = {});

    /// How many are still to be drawn.
    std::size_t pictures() const;

private:
    struct Wanted {
        DrawnFigure figure;
        Draw draw;
        std::string warning;
        bool drawn, rendered;
    };
    class Queue;
    void make(Wanted& wanted) const;
    bool stop() const;

    std::filesystem::path run_dir_;
    std::function<bool()> stop_;
    std::vector<Wanted> wanted_;
};

/// As many threads as the program may use, at most eight: each holds a picture's fields.
int threads_for_figures();

}  // namespace frana
