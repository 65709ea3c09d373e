#include "observe/side_by_side.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "base/on_threads.h"
#include "observe/archive.h"

namespace frana {
namespace {

class SideBySide final : public Observer {
public:
    SideBySide(std::string name, std::vector<std::unique_ptr<Observer>> parts, int threads)
        : name_(std::move(name)), parts_(std::move(parts)), threads_(threads) {}
    std::string name() const override { return name_; }
    void step(const Status& now, const Probe& probe) override {
        for (auto& part : parts_) part->step(now, probe);
    }
    bool wants_frame(const Status& now) override {
        wanting_.clear();
        for (auto& part : parts_)
            if (part->wants_frame(now)) wanting_.push_back(part.get());
        return !wanting_.empty();
    }
    void observe_between(const Frame& frame) override {
        for (Observer* part : wanting_) part->observe_between(frame);
    }
    void observe(const Frame& frame) override {
        for_all([&](Observer& part) { part.observe(frame); });
    }
    bool looks_at_fields() const override {
        return std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part->looks_at_fields(); });
    }
    void end(const Frame& frame) override {
        for_all([&](Observer& part) { part.end(frame); });
    }
    void serialize(Archive& archive) override {
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            const Archive::Part part(archive, fmt::format("{:02d}", i));
            parts_[i]->serialize(archive);
        }
    }

private:
    void for_all(const std::function<void(Observer&)>& work) {
        for_each_on_threads(parts_.size(), threads_, [&](std::size_t k) { work(*parts_[k]); });
    }

    std::string name_;
    std::vector<std::unique_ptr<Observer>> parts_;
    std::vector<Observer*> wanting_;  ///< a frame between outputs
    int threads_;
};

}  // namespace

std::unique_ptr<Observer> side_by_side(std::string name, std::vector<std::unique_ptr<Observer>> parts, int threads) {
    return std::make_unique<SideBySide>(std::move(name), std::move(parts), threads);
}

}  // namespace frana
