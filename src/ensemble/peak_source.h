#pragma once
// Where the peaks of an ensemble's runs are. Of ten thousand runs they fill a few hundred MB, so callers take one run
// after the other.
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "terrain/sparse_rasters.h"

namespace frana {

class PeakSource {
public:
    virtual ~PeakSource() = default;

    virtual std::size_t runs() const = 0;

    /// Calls body(run, peaks) for each run, from the first to the last. Of the fields those with these numbers have values.
    virtual void for_each_run(const std::vector<std::size_t>& fields,
                              const std::function<void(std::size_t, const SparseRasters&)>& body) const = 0;
};

/// Runs that lie in memory, and outlive this.
class PeaksInMemory : public PeakSource {
public:
    explicit PeaksInMemory(std::vector<const SparseRasters*> peaks) : peaks_(std::move(peaks)) {}

    std::size_t runs() const override { return peaks_.size(); }

    void for_each_run(const std::vector<std::size_t>&,
                      const std::function<void(std::size_t, const SparseRasters&)>& body) const override {
        for (std::size_t run = 0; run < peaks_.size(); ++run) body(run, *peaks_[run]);
    }

private:
    std::vector<const SparseRasters*> peaks_;
};

}  // namespace frana
