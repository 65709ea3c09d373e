#pragma once
// What a flow gained and lost since its start.
#include <array>
#include <cstring>
#include <string>
#include <type_traits>

#include "base/compensated_sum.h"
#include "observe/archive.h"

namespace frana {

/// Two numbers without Eigen's alignment: a struct of these and of doubles has no gaps.
using Flat2 = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

/// Sums over all steps: their error does not grow with the number of steps. Sums: a struct of doubles, and vectors of
/// them, which a step fills. Each of its numbers is summed by itself.
template <class Sums>
class Ledger {
    static_assert(alignof(Sums) == alignof(double) && sizeof(Sums) % sizeof(double) == 0 &&
                      std::is_trivially_destructible_v<Sums>,
                  "a struct of numbers without gaps");

public:
    /// Adds what a step gained and lost. Returns the sums since the start.
    Sums add(const Sums& step) {
        const Numbers terms = numbers_of(step);
        for (std::size_t n = 0; n < kCount; ++n) sums_[n].add(terms[n]);
        return total();
    }
    Sums total() const {
        Numbers values;
        for (std::size_t n = 0; n < kCount; ++n) values[n] = sums_[n].value();
        Sums all;
        std::memcpy(static_cast<void*>(&all), &values, sizeof all);
        return all;
    }
    void serialize(Archive& archive, const std::string& name) {
        std::vector<double*> parts;
        for (CompensatedSum& sum : sums_)
            for (double* part : sum.parts()) parts.push_back(part);
        archive.numbers(name, parts);
    }

private:
    static constexpr std::size_t kCount = sizeof(Sums) / sizeof(double);
    using Numbers = std::array<double, kCount>;
    static Numbers numbers_of(const Sums& sums) {
        Numbers numbers;
        std::memcpy(&numbers, static_cast<const void*>(&sums), sizeof numbers);
        return numbers;
    }
    std::array<CompensatedSum, kCount> sums_;
};

}  // namespace frana
