#pragma once
// A run that tests of `frana convert` share, and what they make of it.
#include <hdf5.h>

#include <vector>

#include "catch.h"
#include "plane_case.h"

namespace convert_run {

namespace fs = std::filesystem;
using Numbers = std::vector<double>;

inline double sum(const Numbers& numbers) {
    double total = 0.0;
    for (const double number : numbers) total += number;
    return total;
}

/// A short run, made once: a plane that falls 0.1 in x, 1.5 m of a viscous fluid, frames every half second to 2 s.
inline const PlaneCase& finished_run() {
    static const PlaneCase scene;
    static const bool made = [] {
        scene.write(
            "[material]\ndensity = 1300\n[material.rheology]\nlaw = \"newtonian\"\nviscosity = 40\n"
            "[output]\nevery = 0.5\nformats = [\"vtk\", \"xdmf\", \"geotiff\"]\n");
        const Outcome run = scene.frana("run CASE --out out --quiet --threads 1");
        INFO(run.err);
        REQUIRE(run.code == 0);
        return true;
    }();
    REQUIRE(made);
    return scene;
}

/// Converts the run into `file` and returns where it lies.
inline fs::path convert(const std::string& file, const std::string& rest = "--time 1 --spacing 0.25") {
    const Outcome outcome = finished_run().frana("convert out " + rest + " --out " + file);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return finished_run().folder() / file;
}

inline Outcome refused(const std::string& arguments) {
    const Outcome outcome = finished_run().frana("convert " + arguments);
    CHECK(outcome.code == 2);
    return outcome;
}

inline Numbers hdf5_numbers(const fs::path& file, const char* name, bool attribute = false) {
    const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    REQUIRE(opened >= 0);
    const hid_t set = attribute ? H5Aopen(opened, name, H5P_DEFAULT) : H5Dopen2(opened, name, H5P_DEFAULT);
    REQUIRE(set >= 0);
    const hid_t space = attribute ? H5Aget_space(set) : H5Dget_space(set);
    Numbers numbers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    const auto read = attribute ? H5Aread(set, H5T_NATIVE_DOUBLE, numbers.data())
                                : H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
    REQUIRE(read >= 0);
    H5Sclose(space);
    attribute ? H5Aclose(set) : H5Dclose(set);
    H5Fclose(opened);
    return numbers;
}

}  // namespace convert_run
