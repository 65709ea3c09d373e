// Files that a run leaves and reads again. The readers take a path, so the bytes go through a folder of the system's.
#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/checksum.h"
#include "fuzz/answers.h"
#include "fuzz/targets.h"
#include "io/checkpoint_file.h"
#include "observe/frame.h"
#include "observe/table.h"

namespace frana::fuzz {
namespace fs = std::filesystem;
namespace {

/// A file of this process, gone at the end.
class DiskFile {
public:
    DiskFile(const char* name, const Input& bytes)
        : path_(fs::temp_directory_path() / fmt::format("frana_fuzz_{}_{}", getpid(), name)) {
        std::ofstream(path_, std::ios::binary) << bytes;
    }
    ~DiskFile() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    DiskFile(const DiskFile&) = delete;
    DiskFile& operator=(const DiskFile&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

/// A little of everything that a state has.
struct State {
    std::vector<double> reals;
    std::vector<Index> wholes;
    std::vector<std::uint8_t> octets;
    std::vector<std::string> texts;
    double number = 0.0;
    Index count = 0;
    Status status;
    std::vector<PhaseTime> phases;

    void serialize(Archive& archive) {
        const Archive::Part part(archive, "state");
        archive.array("reals", reals);
        archive.array("wholes", wholes);
        archive.array("octets", octets);
        archive.texts("texts", texts);
        archive.number("number", number);
        archive.number("count", count);
        frana::serialize(archive, "status", status);
        frana::serialize(archive, "phases", phases);
    }
};

void load(const Input& bytes) {
    const DiskFile file("checkpoint.h5", bytes);
    refused_fairly([&] {
        State state;
        CheckpointFile(file.path()).load([&](Archive& archive) { state.serialize(archive); });
    });
}

constexpr std::size_t kHead = 512;

}  // namespace

void checkpoint(const Input& bytes) {
    load(bytes);
    if (bytes.size() <= kHead) return;
    Input mended = bytes;
    Checksum sum;
    sum.add(bytes.data() + kHead, bytes.size() - kHead);
    std::string head = fmt::format("{}\nbytes {}\nsum {:016x}\n", kCheckpointFormat, bytes.size(), sum.sum());
    head.resize(kHead, '\0');
    mended.replace(0, kHead, head);
    load(mended);
}

void make_checkpoint(const std::string& file) {
    State state;
    state.reals = {0.5, -1.0};
    state.wholes = {-1};
    state.octets = {0, 255};
    state.texts = {"", "a"};
    state.phases = {{"grid update", 0.5, 0.25, 3}};
    write_checkpoint(file, {{"case", "x = 1"}}, [&](Archive& archive) { state.serialize(archive); });
}

void table(const Input& bytes) {
    const DiskFile file("table.csv", bytes);
    refused_fairly([&] {
        const Table read = read_table(file.path());
        for (const auto& column : read.values)
            if (column.size() != read.rows()) throw std::logic_error("columns of different lengths");
    });
}

}  // namespace frana::fuzz
