// What HDF5's own C functions find in run.h5, and that run.xdmf points at it.
#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>

#include "base/error.h"
#include "catch.h"
#include "frame_maker.h"
#include "fresh_folder.h"
#include "io/xdmf_writer.h"
#include "observe/memory_archive.h"
#include "read_back.h"
#include "small_disk.h"
#include "threads_of_test.h"

using namespace frana;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

struct StoredArray {
    std::vector<hsize_t> shape;
    std::vector<double> numbers;
    H5T_class_t kind = H5T_NO_CLASS;
    std::size_t bytes = 0;  ///< of one number
    bool contiguous = false;
    std::string unit;
};

std::string text_attribute(hid_t object, const char* name) {
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    REQUIRE(attribute >= 0);
    const hid_t type = H5Aget_type(attribute);
    std::string text(H5Tget_size(type), '\0');
    H5Aread(attribute, type, text.data());
    H5Tclose(type);
    H5Aclose(attribute);
    return text.c_str();
}

StoredArray read_array(const fs::path& file, const std::string& name) {
    CAPTURE(name);
    const hid_t opened = H5Fopen(file.string().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    REQUIRE(opened >= 0);
    const hid_t set = H5Dopen2(opened, name.c_str(), H5P_DEFAULT);
    REQUIRE(set >= 0);
    StoredArray array;
    const hid_t space = H5Dget_space(set), type = H5Dget_type(set), plist = H5Dget_create_plist(set);
    array.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, array.shape.data(), nullptr);
    array.numbers.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    array.kind = H5Tget_class(type);
    array.bytes = H5Tget_size(type);
    array.contiguous = H5Pget_layout(plist) == H5D_CONTIGUOUS;
    array.unit = text_attribute(set, "unit");
    if (!array.numbers.empty())
        CHECK(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.numbers.data()) >= 0);
    H5Pclose(plist);
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(opened);
    return array;
}

void check_same(const Field& field, std::vector<hsize_t> shape, const StoredArray& found) {
    CAPTURE(field.name);
    if (field.components > 1) shape.push_back(static_cast<hsize_t>(field.components));
    CHECK(found.shape == shape);
    CHECK(found.unit == field.unit);
    CHECK(found.contiguous == (found.numbers.size() * found.bytes < 16384));  // longer ones are deflated
    REQUIRE(static_cast<Index>(found.numbers.size()) == field.count * field.components);
    Index different = 0;
    for (std::size_t k = 0; k < found.numbers.size(); ++k) {
        const double wanted = found.bytes == 4 ? static_cast<double>(static_cast<float>(field.data[k])) : field.data[k];
        different += std::memcmp(&found.numbers[k], &wanted, sizeof wanted) != 0;
    }
    read_back.array(static_cast<Index>(found.numbers.size()));
    CHECK(different == 0);
}

void check_frame(const Frame& frame, const fs::path& file) {
    ++read_back.files;
    char name[32];
    std::snprintf(name, sizeof name, "/frame_%06d/", static_cast<int>(frame.number));
    const auto& grid = frame.grid;
    for (const Field& field : frame.nodes)
        check_same(field, {1, static_cast<hsize_t>(grid.ny), static_cast<hsize_t>(grid.nx)},
                   read_array(file, name + ("grid/" + field.name)));
    for (const Field& field : frame.particles)
        check_same(field, {static_cast<hsize_t>(field.count)}, read_array(file, name + ("particles/" + field.name)));
}

/// The filters that a reader needs for an array.
std::vector<H5Z_filter_t> filters_of(const fs::path& file, const std::string& name) {
    const hid_t opened = H5Fopen(file.string().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t set = H5Dopen2(opened, name.c_str(), H5P_DEFAULT), plist = H5Dget_create_plist(set);
    std::vector<H5Z_filter_t> filters;
    for (int k = 0; k < H5Pget_nfilters(plist); ++k)
        filters.push_back(
            H5Pget_filter2(plist, static_cast<unsigned>(k), nullptr, nullptr, nullptr, 0, nullptr, nullptr));
    H5Pclose(plist);
    H5Dclose(set);
    H5Fclose(opened);
    return filters;
}

/// Every piece of text that stands between `head` and the next `tail`.
std::vector<std::string> between(const std::string& text, const std::string& head, char tail) {
    std::vector<std::string> pieces;
    for (auto at = text.find(head); at != std::string::npos; at = text.find(head, at + 1)) {
        const auto start = at + head.size();
        pieces.push_back(text.substr(start, text.find(tail, start) - start));
    }
    return pieces;
}

/// The path in run.h5 of every array that the XDMF text names.
std::vector<std::string> named_arrays(const std::string& xdmf) { return between(xdmf, "run.h5:", '<'); }

}  // namespace

TEST_CASE("HDF5 reads every frame back bit for bit", "[io][xdmf]") {
    const FreshFolder run;
    const auto writer = make_xdmf_writer(run.path());
    const std::vector<std::pair<Index, Index>> shapes{{1, 1}, {9, 1}, {37, 23}};
    Index number = 0;
    for (const auto& [nx, ny] : shapes) {
        FrameMaker maker(number, 0.1 * static_cast<double>(number), 1000 * number, FrameMaker::utm(nx, ny));
        maker.node_numbers("depth")[0] = 1e-42;  // a denormal of float32
        if (number > 0) maker.particle_numbers("mass")[0] = 5e-324;
        writer->observe(maker.frame);
        CAPTURE(number);
        check_frame(maker.frame, run.path() / "run.h5");
        ++number;
    }
    FrameMaker first(0, 0.0, 0, FrameMaker::utm(1, 1));  // later frames leave earlier ones alone
    first.node_numbers("depth")[0] = 1e-42;
    check_frame(first.frame, run.path() / "run.h5");
}

TEST_CASE("HDF5 arrays have the number types that the contract names", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker maker(7, 1.0, 5, FrameMaker::utm(3, 3));
    make_xdmf_writer(run.path())->observe(maker.frame);
    const fs::path file = run.path() / "run.h5";
    CHECK(read_array(file, "/frame_000007/particles/id").kind == H5T_INTEGER);
    CHECK(read_array(file, "/frame_000007/particles/id").bytes == 8);
    CHECK(read_array(file, "/frame_000007/particles/position").bytes == 8);
    CHECK(read_array(file, "/frame_000007/particles/mass").bytes == 8);
    CHECK(read_array(file, "/frame_000007/particles/depth").bytes == 4);
    CHECK(read_array(file, "/frame_000007/grid/stress").bytes == 4);
}

TEST_CASE("After every frame run.xdmf names only arrays that run.h5 has, with exact times", "[io][xdmf]") {
    const FreshFolder run;
    const auto writer = make_xdmf_writer(run.path());
    for (Index number = 0; number < 5; ++number) {
        FrameMaker maker(number, static_cast<double>(number) / 3.0, 20, FrameMaker::utm(6, 4));
        if (number == 4) maker.cut_corner();
        writer->observe(maker.frame);
        const std::string text = text_of(run.path() / "run.xdmf");
        const auto names = named_arrays(text);
        CHECK(names.size() == static_cast<std::size_t>(14 * (number + 1) + (number == 4 ? 1 : 0)));
        for (const auto& name : names) CHECK(!read_array(run.path() / "run.h5", name).numbers.empty());
        std::vector<double> times;
        for (const auto& time : between(text, "<Time Value=\"", '"')) times.push_back(std::stod(time));
        REQUIRE(times.size() == static_cast<std::size_t>(2 * (number + 1)));
        CHECK(times[static_cast<std::size_t>(number)] == maker.frame.status.time);
        CHECK(times.back() == maker.frame.status.time);
    }
    CHECK(text_of(run.path() / "run.xdmf").find("1756969.123456789") != std::string::npos);
}

TEST_CASE("Nodes without terrain are marked and leave no NaN in run.h5", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 0, FrameMaker::utm(20, 10));
    maker.cut_corner();
    make_xdmf_writer(run.path())->observe(maker.frame);
    const auto outside = read_array(run.path() / "run.h5", "/frame_000000/grid/outside").numbers;
    const auto elevation = read_array(run.path() / "run.h5", "/frame_000000/grid/elevation").numbers;
    for (std::size_t k = 0; k < 200; ++k) {
        CHECK((outside[k] == 1.0) == (k % 20 >= 10 && k / 20 >= 5));
        CHECK(std::isfinite(elevation[k]));
    }
}

TEST_CASE("A viewer that holds a lock on run.h5 does not stop the writer", "[io][xdmf]") {
    const FreshFolder run;
    const auto writer = make_xdmf_writer(run.path());
    FrameMaker first(0, 0.0, 10, FrameMaker::utm(5, 5)), second(1, 1.0, 10, FrameMaker::utm(5, 5));
    writer->observe(first.frame);
    const int viewer = ::open((run.path() / "run.h5").c_str(), O_RDONLY);
    REQUIRE(viewer >= 0);
    REQUIRE(::flock(viewer, LOCK_SH) == 0);  // what HDF5 does to a file it reads
    CHECK_NOTHROW(writer->observe(second.frame));
    ::close(viewer);
    check_frame(second.frame, run.path() / "run.h5");
}

TEST_CASE("A frame number seen twice is replaced in run.h5 and run.xdmf", "[io][xdmf]") {
    const FreshFolder run;
    const auto writer = make_xdmf_writer(run.path());
    FrameMaker first(0, 1.0, 10, FrameMaker::utm(5, 5)), second(0, 2.0, 7, FrameMaker::utm(6, 5));
    writer->observe(first.frame);
    writer->observe(second.frame);
    check_frame(second.frame, run.path() / "run.h5");
    CHECK(named_arrays(text_of(run.path() / "run.xdmf")).size() == 14);
}

TEST_CASE("A run.h5 that cannot be written is an error with path and reason", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 20000, FrameMaker::utm(100, 100));
    CHECK_THROWS_WITH(make_xdmf_writer(run.path() / "absent")->observe(maker.frame),
                      Contains("run.h5: cannot be written") && Contains("No such file or directory"));
}

TEST_CASE("A full disk is an error with path and reason, and the frames before it stay readable", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 200, FrameMaker::utm(20, 20)), large(1, 1.0, 20000, FrameMaker::utm(100, 100));
    const auto writer = make_xdmf_writer(run.path());
    writer->observe(maker.frame);
    const auto size = fs::file_size(run.path() / "run.h5");
    {
        const SmallDisk disk(size + 50000);
        CHECK_THROWS_WITH(writer->observe(large.frame),
                          Contains("run.h5: cannot be written") && Contains("File too large"));
    }
    CHECK(fs::file_size(run.path() / "run.h5") == size);
    check_frame(maker.frame, run.path() / "run.h5");
    CHECK(named_arrays(text_of(run.path() / "run.xdmf")).size() == 14);
}

TEST_CASE("run.h5 keeps no space beyond its arrays", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 1000, FrameMaker::utm(100, 100));
    make_xdmf_writer(run.path())->observe(maker.frame);
    // 11 float32 of 1e4 nodes; 7 float32 and 6 eight-byte numbers of 1e3 particles; 64 kB for HDF5's own
    // tables
    CHECK(fs::file_size(run.path() / "run.h5") < 11 * 4 * 10000 + (7 * 4 + 6 * 8) * 1000 + 65536);
}

TEST_CASE("Long arrays are deflated, and a state takes back what was written after it", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker first(0, 0.0, 9000, FrameMaker::utm(300, 700)), second(1, 1.0, 500, FrameMaker::utm(300, 700));
    first.particle_numbers("mass")[0] = 5e-324;
    const auto writer = make_xdmf_writer(run.path());
    writer->observe(first.frame);
    check_frame(first.frame, run.path() / "run.h5");
    // Seven eighths of the nodes have no flow: of 11 float32 a node two are the terrain. Particles do not deflate.
    const auto bytes = fs::file_size(run.path() / "run.h5");
    CHECK(bytes < 11 * 4 * 300 * 700 / 2 + (7 * 4 + 6 * 8) * 9000);
    MemoryArchive kept;
    writer->serialize(kept);
    writer->observe(second.frame);
    check_frame(second.frame, run.path() / "run.h5");
    const auto resumed = make_xdmf_writer(run.path());
    kept.rewind();
    resumed->serialize(kept);
    CHECK(fs::file_size(run.path() / "run.h5") == bytes);
    check_frame(first.frame, run.path() / "run.h5");
    resumed->observe(second.frame);
    check_frame(first.frame, run.path() / "run.h5");
    check_frame(second.frame, run.path() / "run.h5");
}

TEST_CASE("Long arrays need no more than HDF5's own filters, and have the same bytes from any threads", "[io][xdmf]") {
    // Several chunks an array, the last of them in part; noise, flat and empty stretches, and numbers of 4 and 8 bytes.
    FrameMaker maker(0, 0.0, 70000, FrameMaker::utm(301, 703));
    auto& mass = maker.particle_numbers("mass");
    std::fill(mass.begin(), mass.begin() + 40000, 0.25);
    std::fill(maker.particle_numbers("volume").begin(), maker.particle_numbers("volume").end(), 0.0);
    std::mt19937_64 random(1);
    for (double& depth : maker.particle_numbers("depth")) {  // a number of which no byte can be told
        const auto bits = static_cast<std::uint32_t>(random());
        float number = 0.0F;
        std::memcpy(&number, &bits, sizeof number);
        depth = std::isfinite(number) ? static_cast<double>(number) : 1.0;
    }
    std::string first;
    for (const int threads : {1, 2, 3}) {
        const Threads of_test(threads);
        const FreshFolder run;
        make_xdmf_writer(run.path())->observe(maker.frame);
        const fs::path file = run.path() / "run.h5";
        check_frame(maker.frame, file);
        for (const char* const name : {"/frame_000000/particles/position", "/frame_000000/grid/depth"})
            CHECK(filters_of(file, name) == std::vector<H5Z_filter_t>{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE});
        const std::string bytes = text_of(file);
        if (threads == 1) first = bytes;
        CHECK(bytes == first);
    }
}

TEST_CASE("Noise takes no more room in run.h5 than it has, and what is flat next to none", "[io][xdmf]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 200000, FrameMaker::utm(3, 3));
    std::fill(maker.particle_numbers("mass").begin(), maker.particle_numbers("mass").end(), 0.25);
    std::fill(maker.particle_numbers("stress").begin(), maker.particle_numbers("stress").end(), 0.0);
    make_xdmf_writer(run.path())->observe(maker.frame);
    // All but mass and stress: 4 float32, of random mantissas of 23 bits, and 5 numbers of eight bytes. A hundredth for
    // the frames of blocks.
    const double noise = 200000.0 * (4 * 4 + 5 * 8);
    CHECK(static_cast<double>(fs::file_size(run.path() / "run.h5")) < 1.01 * noise);
}
