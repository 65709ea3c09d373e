#pragma once
#include <array>
#include <cmath>

namespace frana {

/// A sum whose error does not grow with the number of terms (Neumaier, ZAMM 54 (1974) 39-51). It is about one unit in
/// the last place of the sum of absolute values, for up to 1e15 terms.
class CompensatedSum {
public:
    explicit CompensatedSum(double start = 0.0) : sum_(start) {}
    void add(double term) {
        const double next = sum_ + term;
        lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
        sum_ = next;
    }
    double value() const { return sum_ + lost_; }
    /// Both of its numbers, to be saved with all their bits.
    std::array<double*, 2> parts() { return {&sum_, &lost_}; }

private:
    double sum_, lost_ = 0.0;
};

}  // namespace frana
