#include "run/folder/gallery.h"

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <mutex>

#include "base/on_threads.h"
#include "run/folder/cutoff.h"

namespace frana {
namespace fs = std::filesystem;

/// What is still to be drawn. Several threads may take at the same time.
class Gallery::Queue {
public:
    explicit Queue(std::vector<Wanted>& wanted) {
        for (Wanted& one : wanted)
            if (one.draw) (one.rendered ? rendered_ : plain_).push_back(&one);
    }
    /// Null when all are taken. Another one for the renderer only when nothing else is left.
    Wanted* take() {
        const std::lock_guard<std::mutex> lock(mutex_);
        const bool from_rendered = !rendered_.empty() && (rendering_ == 0 || plain_.empty());
        std::deque<Wanted*>& queue = from_rendered ? rendered_ : plain_;
        if (queue.empty()) return nullptr;
        Wanted* const next = queue.front();
        queue.pop_front();
        rendering_ += next->rendered;
        return next;
    }
    void give_back(const Wanted& done) {
        const std::lock_guard<std::mutex> lock(mutex_);
        rendering_ -= done.rendered;
    }

private:
    std::mutex mutex_;
    std::deque<Wanted*> rendered_, plain_;
    int rendering_ = 0;
};

void Gallery::make(Wanted& wanted) const {
    const fs::path png = run_dir_ / wanted.figure.path;
    std::string why_not;
    try {
        fs::create_directories(png.parent_path());
        wanted.drawn = wanted.draw(png, why_not);
    } catch (const std::exception& error) {
        why_not = error.what();
    }
    wanted.draw = nullptr;  // with what it held
    if (!wanted.drawn) wanted.warning = fmt::format("{} was not drawn: {}", wanted.figure.path, why_not);
}

bool Gallery::stop() const { return Cutoff::asked() || (stop_ && stop_()); }

std::size_t Gallery::pictures() const {
    return static_cast<std::size_t>(
        std::count_if(wanted_.begin(), wanted_.end(), [](const Wanted& wanted) { return wanted.draw != nullptr; }));
}

std::vector<DrawnFigure> Gallery::draw(int threads, std::vector<std::string>& warnings, const Tell& tell) {
    Queue queue(wanted_);
    std::mutex telling;
    const std::size_t all = pictures();
    std::size_t done = 0;
    const auto work = [&] {
        for (Wanted* next = queue.take(); next != nullptr && !stop(); next = queue.take()) {
            make(*next);
            queue.give_back(*next);
            const std::lock_guard<std::mutex> lock(telling);
            if (tell) tell(++done, all);
        }
    };
    if (tell && all > 0) tell(0, all);
    on_threads(std::min(static_cast<std::size_t>(threads), wanted_.size()), work);
    std::vector<DrawnFigure> drawn;
    for (Wanted& wanted : wanted_) {
        if (wanted.drawn) drawn.push_back(std::move(wanted.figure));
        if (!wanted.warning.empty()) warnings.push_back(std::move(wanted.warning));
    }
    wanted_.clear();
    return drawn;
}

int threads_for_figures() { return std::clamp(omp_get_max_threads(), 1, 8); }

}  // namespace frana
