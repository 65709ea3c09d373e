#pragma once
#include <cmath>

namespace frana {

/// Sum whose error does not grow with the number of terms (Neumaier 1974).
class CompensatedSum {
public:
    void add(double term) {
        const double total = sum_ + term;
        rest_ += std::abs(sum_) >= std::abs(term) ? (sum_ - total) + term : (term - total) + sum_;
        sum_ = total;
    }
    double value() const { return sum_ + rest_; }

private:
    double sum_ = 0.0;
    double rest_ = 0.0;
};

}  // namespace frana
