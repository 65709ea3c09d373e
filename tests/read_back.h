#pragma once
// How much of what was written came back through readers that are not ours (VTK, HDF5, GDAL) and was compared. A line
// at the end of the tests; those with ParaView say theirs themselves:
//   ctest -V -R '^(io|pvbatch)' | grep 'read back'
#include <cstdint>
#include <cstdio>

struct ReadBack {
    std::int64_t files = 0, arrays = 0, values = 0;
    ~ReadBack() {
        if (files + arrays == 0) return;
        std::printf("read back by VTK, HDF5 and GDAL: %lld files, %lld arrays, %lld values compared\n",
                    static_cast<long long>(files), static_cast<long long>(arrays), static_cast<long long>(values));
    }
    /// An array of that many values, each of which was compared.
    void array(std::int64_t of_values) { ++arrays, values += of_values; }
};
inline ReadBack read_back;
