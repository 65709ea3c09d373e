// The file of a state: what goes in comes out with all its bits, and a file with any other bits is refused.
#include <fstream>
#include <limits>
#include <random>

#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "io/checkpoint_file.h"
#include "observe/frame.h"
#include "small_disk.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;

namespace {

/// Some of everything that an archive takes.
struct Things {
    std::vector<double> reals{1.0 / 3.0, -0.0, 5e-324, std::numeric_limits<double>::infinity()};
    std::vector<double> none;
    std::vector<Index> wholes{-1, std::numeric_limits<Index>::max()};
    std::vector<std::uint8_t> bytes{0, 255};
    std::vector<std::string> texts{"", "a / b", "\xc3\xa4"};
    double number = 0.1;
    Index count = 7;
    Status status;
    std::vector<PhaseTime> phases{{"deposit", 0.5, 0.25, 3}, {"grid update", 1.5, 0.0, 4}};

    void serialize(Archive& archive) {
        const Archive::Part part(archive, "things");
        archive.array("reals", reals);
        archive.array("none", none);
        archive.array("wholes", wholes);
        archive.array("bytes", bytes);
        archive.texts("texts", texts);
        archive.number("number", number);
        archive.number("count", count);
        frana::serialize(archive, "status", status);
        frana::serialize(archive, "phases", phases);
    }
};

const CheckpointLabels labels{{"version", "9.9"}, {"case", "time.end = 3\n"}};

void write(const fs::path& file, Things things = {}) {
    write_checkpoint(file, labels, [&](Archive& archive) { things.serialize(archive); });
}

/// What opening and loading the file says, empty when nothing.
std::string complaint(const fs::path& file) {
    try {
        Things things;
        CheckpointFile(file).load([&](Archive& archive) { things.serialize(archive); });
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

void put(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

}  // namespace

TEST_CASE("a state comes back from its file bit for bit", "[resume]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "checkpoint.h5";
    Things in, out;
    in.status.step = 12;
    in.status.time = 0.1 + 0.2;
    in.status.impulse = {3.0, -4.0};
    in.status.front = 17.25;
    write(file, in);
    CHECK(fs::file_size(file) > 512);
    out = Things{{}, {1.0}, {}, {}, {"x"}, 0.0, 0, {}, {}};
    const CheckpointFile opened(file);
    CHECK(opened.labels() == labels);
    opened.load([&](Archive& archive) { out.serialize(archive); });
    CHECK(std::memcmp(out.reals.data(), in.reals.data(), sizeof(double) * in.reals.size()) == 0);
    CHECK(out.none.empty());
    CHECK(out.wholes == in.wholes);
    CHECK(out.bytes == in.bytes);
    CHECK(out.texts == in.texts);
    CHECK(out.number == in.number);
    CHECK(out.count == in.count);
    CHECK(out.status.step == 12);
    CHECK(out.status.time == in.status.time);
    CHECK(out.status.impulse == in.status.impulse);
    CHECK(out.status.front == 17.25);
    REQUIRE(out.phases.size() == 2);
    CHECK(out.phases[1].name == "grid update");
    CHECK(out.phases[0].calls == 3);
    CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);  // nothing beside it
}

TEST_CASE("the same state gives the same file", "[resume]") {
    const FreshFolder folder;
    write(folder.path() / "one.h5");
    write(folder.path() / "two.h5");
    CHECK(text_of(folder.path() / "one.h5") == text_of(folder.path() / "two.h5"));
}

TEST_CASE("a checkpoint that was cut at any byte is refused with one sentence", "[resume]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "checkpoint.h5";
    write(file);
    const std::string whole = text_of(file);
    REQUIRE(complaint(file).empty());
    std::size_t refused = 0, cuts = 0;
    for (std::size_t bytes = 0; bytes < whole.size(); bytes += bytes < 600 ? 1 : 97, ++cuts) {
        put(file, whole.substr(0, bytes));
        const std::string said = complaint(file);
        refused += said.find("run with --overwrite instead of --resume") != std::string::npos &&
                   said.find('\n') == std::string::npos;
    }
    CHECK(refused == cuts);
    put(file, whole.substr(0, 10));
    CHECK_THAT(complaint(file), Contains("checkpoint.h5: is not a checkpoint of frana; expected the state"));
    put(file, whole.substr(0, whole.size() - 1));
    CHECK_THAT(complaint(file), Contains("was cut short or added to"));
    put(file, whole + "x");
    CHECK_THAT(complaint(file), Contains("was cut short or added to"));
}

TEST_CASE("a checkpoint with any flipped bit is refused with one sentence", "[resume]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "checkpoint.h5";
    write(file);
    const std::string whole = text_of(file);
    std::mt19937 random(7);
    std::size_t refused = 0;
    const std::size_t flips = 2000;
    for (std::size_t n = 0; n < flips; ++n) {
        std::string damaged = whole;
        char& byte = damaged[random() % (n % 4 == 0 ? 512 : whole.size())];
        byte = static_cast<char>(byte ^ (1 << random() % 8));
        put(file, damaged);
        const std::string said = complaint(file);
        refused += !said.empty() && said.find('\n') == std::string::npos;
    }
    CHECK(refused == flips);
    std::string damaged = whole;
    damaged[600] ^= 1;
    put(file, damaged);
    CHECK_THAT(complaint(file), Contains("is damaged, its checksum does not fit"));
    damaged = whole;
    damaged.replace(0, 18, "frana checkpoint 9");
    put(file, damaged);
    CHECK_THAT(complaint(file), Contains("has a format that this version does not know"));
}

TEST_CASE("a checkpoint that is not there, or lacks an entry, is refused", "[resume]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "checkpoint.h5";
    CHECK_THAT(complaint(file), Contains("checkpoint.h5: not found; expected the state that a run leaves there; "
                                         "run with --overwrite instead of --resume to start at the beginning"));
    write(file);
    const CheckpointFile opened(file);
    double number = 0.0;
    Index count = 0;
    CHECK_THROWS_WITH(opened.load([&](Archive& archive) { archive.number("absent", number); }),
                      Contains("has no absent as this program saves it"));
    CHECK_THROWS_WITH(opened.load([&](Archive& archive) { archive.number("things/number", count); }),
                      Contains("has no things/number as this program saves it"));
    CHECK_THROWS_WITH(opened.load([&](Archive& archive) { archive.number("things/reals", number); }),
                      Contains("has 4 values of things/reals, expected 1"));
}

TEST_CASE("a disk that fills up leaves the earlier checkpoint", "[resume]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "checkpoint.h5";
    write(file);
    const std::string before = text_of(file);
    Things large;
    large.reals.assign(100000, 1.0);
    for (const rlim_t bytes : {0, 100, 700, 50000, 799000}) {
        CAPTURE(bytes);
        const SmallDisk disk(bytes);
        CHECK_THROWS_WITH(write(file, large), Contains("checkpoint.h5: cannot be written: File too large"));
    }
    CHECK(text_of(file) == before);
    CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
    write(file, large);
    CHECK(complaint(file).empty());
}
