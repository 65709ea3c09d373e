#pragma once
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "base/types.h"

namespace frana::fuzz {

/// Random numbers that are the same on every platform: splitmix64 (Steele, Lea and Flood 2014).
class Dice {
public:
    explicit Dice(std::uint64_t seed) : state_(seed) {}
    /// Of throw `n` of a series: unlike any other n of that seed.
    Dice(std::uint64_t seed, std::uint64_t n) : state_(seed) { state_ = bits() ^ (n * 0xd1342543de82ef95u); }

    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  ///< [0, 1)
    double between(double low, double high) { return low + (high - low) * unit(); }
    double decades(double low, double high) { return low * std::pow(high / low, unit()); }  ///< even in the logarithm
    Index below(Index n) { return static_cast<Index>(bits() % static_cast<std::uint64_t>(n)); }
    bool chance(double share) { return unit() < share; }
    template <class T>
    T one_of(std::initializer_list<T> choices) {
        return choices.begin()[below(static_cast<Index>(choices.size()))];
    }

private:
    std::uint64_t state_;
};

}  // namespace frana::fuzz
