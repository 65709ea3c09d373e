#pragma once
// How likely the values of a key are, as the value below which a share u of them lies.
#include <string>
#include <vector>

namespace frana {

/// A distribution of numbers, or of texts each with its weight.
struct Distribution {
    enum class Kind { uniform, loguniform, normal, lognormal, triangular, beta, discrete };
    Kind kind = Kind::uniform;
    double low = 0.0, high = 1.0;  ///< nothing lies beyond; infinite: not cut there
    double middle = 0.0;           ///< mean (normal), median (lognormal), mode (triangular)
    double spread = 1.0;           ///< standard deviation (normal), its factor (lognormal)
    double alpha = 1.0, beta = 1.0;
    std::vector<std::string> values;  ///< discrete: as a case file has them
    std::vector<double> weights;      ///< of them, sum 1

    /// The number below which the share u of all lies, 0 < u < 1. Not of a discrete one.
    double number(double u) const;
    /// Of a normal or lognormal one without its cuts: how much of it lies between them [1].
    double share_between() const;
    /// Which value of a discrete one stands there.
    std::size_t choice(double u) const;
    /// As a case file has it: numbers with as many digits as give the same number back.
    std::string text(double u) const;
};

}  // namespace frana
