#include "observe/only_fields.h"

#include <algorithm>
#include <utility>

namespace frana {
namespace {

class OnlyFields : public Observer {
public:
    OnlyFields(std::unique_ptr<Observer> inner, std::vector<std::string> names)
        : inner_(std::move(inner)), names_(std::move(names)) {
        for (const char* always : {"position", "elevation", "id", "model"}) names_.emplace_back(always);
    }
    std::string name() const override { return inner_->name(); }
    void step(const Status& now, const Probe& probe) override { inner_->step(now, probe); }
    void observe(const Frame& frame) override { inner_->observe(chosen(frame)); }
    bool looks_at_fields() const override { return inner_->looks_at_fields(); }
    void end(const Frame& frame) override { inner_->end(chosen(frame)); }
    void serialize(Archive& archive) override { inner_->serialize(archive); }

private:
    Frame chosen(const Frame& frame) const {
        Frame result = frame;
        for (std::vector<Field>* fields : {&result.particles, &result.nodes})
            fields->erase(
                std::remove_if(fields->begin(), fields->end(), [&](const Field& field) { return !wanted(field.name); }),
                fields->end());
        return result;
    }
    bool wanted(const std::string& name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }

    std::unique_ptr<Observer> inner_;
    std::vector<std::string> names_;
};

}  // namespace

std::unique_ptr<Observer> only_fields(std::unique_ptr<Observer> inner, std::vector<std::string> names) {
    if (names.empty()) return inner;
    return std::make_unique<OnlyFields>(std::move(inner), std::move(names));
}

}  // namespace frana
