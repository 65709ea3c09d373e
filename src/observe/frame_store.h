#pragma once
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "observe/frame.h"

namespace frana {

/// The memory that a model's frames point into. Frames are alike, so memory is allocated once.
class FrameStore {
public:
    /// A new frame: what the last one pointed to may be overwritten.
    void begin() { used_ = 0; }
    /// A new field of `fields`, and its count * components numbers: what was left there, to be filled by the caller.
    double* raw(std::vector<Field>& fields, const std::string& name, const std::string& unit, int components,
                Index count) {
        if (used_ == storage_.size()) storage_.emplace_back();
        std::vector<double>& numbers = storage_[used_++];
        numbers.resize(static_cast<std::size_t>(count * components));
        fields.push_back({name, unit, components, numbers.data(), count});
        return numbers.data();
    }
    /// The same, all zero.
    double* zeros(std::vector<Field>& fields, const std::string& name, const std::string& unit, int components,
                  Index count) {
        double* const numbers = raw(fields, name, unit, components, count);
        std::fill_n(numbers, count * components, 0.0);
        return numbers;
    }

    /// The memory of the last frame. It stays as it is while somebody holds it, and the next frame has other memory.
    std::shared_ptr<const void> give_away() {
        used_ = 0;
        auto given = std::make_shared<const std::vector<std::vector<double>>>(std::move(storage_));
        storage_.clear();
        return given;
    }

private:
    std::vector<std::vector<double>> storage_;
    std::size_t used_ = 0;
};

}  // namespace frana
