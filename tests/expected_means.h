#pragma once
// Means of many runs against a case's expected.csv.
#include <cstdio>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>

#include "catch.h"
#include "fresh_folder.h"

/// Checks mean_of(key) of each row against its mean and tolerance. Returns how many rows there are.
inline int check_means(const std::filesystem::path& csv, const std::function<double(const std::string&)>& mean_of) {
    std::istringstream expected(text_of(csv));
    std::string line;
    int compared = 0;
    for (std::getline(expected, line); std::getline(expected, line); ++compared) {
        const std::string key = line.substr(0, line.find(','));
        double mean = 0.0, tolerance = 0.0;
        REQUIRE(std::sscanf(line.c_str() + key.size(), ",%lf,%lf", &mean, &tolerance) == 2);
        CAPTURE(key);
        CHECK(mean_of(key) == Approx(mean).margin(tolerance));
    }
    return compared;
}
