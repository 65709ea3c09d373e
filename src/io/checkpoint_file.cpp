#include "io/checkpoint_file.h"

#include <fmt/core.h>

#include <fstream>
#include <vector>

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "io/hdf5_support.h"

namespace frana {
namespace fs = std::filesystem;

using hdf5::Access;
using hdf5::Handle;

namespace {

constexpr std::size_t kHead = 512;  ///< HDF5's smallest user block [bytes]

struct NumberType {
    hid_t memory, file;
};
NumberType number_type(Archive::Kind kind) {
    switch (kind) {
        case Archive::Kind::real:
            return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
        case Archive::Kind::whole:
            return {H5T_NATIVE_INT64, H5T_STD_I64LE};
        case Archive::Kind::bytes:
            break;
    }
    return {H5T_NATIVE_UINT8, H5T_STD_U8LE};
}

class Saver final : public Archive {
public:
    Saver(const Access& access, hid_t file)
        : access_(access),
          file_(file),
          links_(access, H5Pcreate(H5P_LINK_CREATE), H5Pclose),
          creation_(access, H5Pcreate(H5P_DATASET_CREATE), H5Pclose) {
        access_.check(H5Pset_create_intermediate_group(links_, 1));
        access_.check(H5Pset_obj_track_times(creation_, false));
    }
    bool loading() const override { return false; }

protected:
    std::size_t stored(const std::string&, Kind) override { return 0; }
    void exchange(const std::string& name, Kind kind, void* data, std::size_t count) override {
        const hsize_t size = count;
        const Handle space(access_, H5Screate_simple(1, &size, nullptr), H5Sclose);
        Handle set(access_,
                   H5Dcreate2(file_, name.c_str(), number_type(kind).file, space, links_, creation_, H5P_DEFAULT),
                   H5Dclose);
        hdf5::write_whole(access_, set, number_type(kind).memory, data);
        set.close();
    }

private:
    const Access& access_;
    hid_t file_;
    Handle links_, creation_;
};

class Loader final : public Archive {
public:
    Loader(const Access& access, hid_t file) : access_(access), file_(file) {}
    bool loading() const override { return true; }

protected:
    std::size_t stored(const std::string& name, Kind kind) override {
        const Handle set(access_, open(name), H5Dclose);
        const Handle space(access_, H5Dget_space(set), H5Sclose);
        const Handle type(access_, H5Dget_type(set), H5Tclose);
        if (H5Tequal(type, number_type(kind).file) <= 0) throw stranger(name);
        const auto count = static_cast<std::size_t>(access_.check(H5Sget_simple_extent_npoints(space)));
        if (count > fs::file_size(access_.file()) / H5Tget_size(type))  // arrays are not packed
            throw UserError(
                fmt::format("{}: claims {} values of {}, more than a file of its size holds; it is damaged, "
                            "run with --overwrite instead of --resume",
                            access_.file().string(), count, name));
        return count;
    }
    void exchange(const std::string& name, Kind kind, void* data, std::size_t count) override {
        if (count == 0) return;
        const Handle set(access_, open(name), H5Dclose);
        if (!lies_whole(set, count * H5Tget_size(number_type(kind).file)))
            throw UserError(
                fmt::format("{}: {} does not lie in it as this program writes it; it is damaged, run without "
                            "--resume",
                            access_.file().string(), name));
        access_.check(H5Dread(set, number_type(kind).memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
    }

private:
    /// In one piece, within the file, whose head HDF5 counts in. HDF5 (1.10) follows other layouts of a damaged file to
    /// addresses that are not there.
    bool lies_whole(hid_t set, std::size_t bytes) const {
        const Handle made(access_, H5Dget_create_plist(set), H5Pclose);
        const haddr_t place = H5Dget_offset(set);
        const std::uintmax_t held = fs::file_size(access_.file());
        return H5Pget_layout(made) == H5D_CONTIGUOUS && H5Pget_external_count(made) == 0 && place != HADDR_UNDEF &&
               place >= kHead && H5Dget_storage_size(set) == bytes && bytes <= held && place <= held - bytes;
    }
    hid_t open(const std::string& name) const {
        const hid_t set = H5Dopen2(file_, name.c_str(), H5P_DEFAULT);
        if (set < 0) throw stranger(name);
        return set;
    }
    UserError stranger(const std::string& name) const {
        return UserError(
            fmt::format("{}: has no {} as this program saves it; it was left by another build of this "
                        "version, resume with that one or run with --overwrite instead of --resume",
                        access_.file().string(), name));
    }
    const Access& access_;
    hid_t file_;
};

/// Sum of all that follows the head.
std::uint64_t sum_of(std::ifstream& stream) {
    Checksum sum;
    std::vector<char> piece(1 << 20);
    stream.seekg(kHead);
    while (stream) {
        stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
        sum.add(piece.data(), static_cast<std::size_t>(stream.gcount()));
    }
    return sum.sum();
}

std::string head_text(std::uintmax_t bytes, std::uint64_t sum) {
    return fmt::format("{}\nbytes {}\nsum {:016x}\n", kCheckpointFormat, bytes, sum);
}

void write_head(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string text = head_text(fs::file_size(file), sum_of(in));
    std::fstream out(file, std::ios::binary | std::ios::in | std::ios::out);
    out << text;
    out.flush();
    if (!out) throw UserError(fmt::format("{}: cannot be written; check the disk and its free space", file.string()));
}

/// The file is a checkpoint, as long as it was and with the bytes that it had.
void require_whole(const fs::path& file) {
    const auto damaged = [&](const std::string& what) {
        return UserError(fmt::format(
            "{}: {}; expected the state that a run leaves there; run with --overwrite instead of --resume to start "
            "at the beginning",
            file.string(), what));
    };
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw damaged(fs::exists(file) ? "cannot be read" : "not found");
    std::string text(kHead, ' ');
    stream.read(text.data(), kHead);
    text.resize(static_cast<std::size_t>(stream.gcount()));
    stream.clear();
    const std::uintmax_t bytes = fs::file_size(file);
    std::string expected = head_text(bytes, sum_of(stream));
    expected.resize(kHead, '\0');
    if (text == expected) return;
    if (text.rfind("frana checkpoint ", 0) != 0) throw damaged("is not a checkpoint of frana");
    if (text.rfind(kCheckpointFormat + std::string("\n"), 0) != 0)
        throw damaged("has a format that this version does not know");
    if (text.rfind(fmt::format("{}\nbytes {}\n", kCheckpointFormat, bytes), 0) != 0)
        throw damaged("was cut short or added to");
    throw damaged("is damaged, its checksum does not fit");
}

void serialize_labels(Archive& archive, std::vector<std::string>& names, std::vector<std::string>& texts) {
    const Archive::Part part(archive, "labels");
    archive.texts("names", names);
    archive.texts("texts", texts);
}

void put_labels(Archive& archive, const CheckpointLabels& labels) {
    std::vector<std::string> names, texts;
    for (const auto& [name, text] : labels) {
        names.push_back(name);
        texts.push_back(text);
    }
    serialize_labels(archive, names, texts);
}

CheckpointLabels taken_labels(Archive& archive) {
    std::vector<std::string> names, texts;
    serialize_labels(archive, names, texts);
    if (names.size() != texts.size()) Archive::wrong_length("labels/texts", texts.size(), names.size());
    CheckpointLabels labels;
    for (std::size_t i = 0; i < names.size(); ++i) labels[names[i]] = texts[i];
    return labels;
}

void read_with(const fs::path& path, const std::function<void(Archive&)>& take) {
    const hdf5::QuietErrors quiet;
    const Access access(path, Access::Mode::read);
    const Handle file(access, H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    Loader loader(access, file);
    take(loader);
}

}  // namespace

std::uintmax_t write_checkpoint(const fs::path& path, const CheckpointLabels& labels,
                                const std::function<void(Archive&)>& state) {
    const auto put_all = [&](Archive& archive) {
        put_labels(archive, labels);
        state(archive);
    };
    const hdf5::QuietErrors quiet;
    ArchiveSize size;
    put_all(size);
    AtomicFile pending(path);
    const Access access(path);
    const std::string place = pending.path().string();
    {
        const Handle creation(access, H5Pcreate(H5P_FILE_CREATE), H5Pclose);
        access.check(H5Pset_userblock(creation, kHead));
        std::ofstream(pending.path()).close();
        hdf5::reserve(access, place, 4096);  // for what the next line writes
        Handle(access, H5Fcreate(place.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT), H5Fclose).close();
    }
    hdf5::reserve(access, place, static_cast<off_t>(size.bytes() + 2048 * size.arrays() + 65536));
    Handle file(access, H5Fopen(place.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    Saver saver(access, file);
    put_all(saver);
    file.close();
    write_head(pending.path());
    const std::uintmax_t written = fs::file_size(pending.path());
    pending.commit_to_disk();
    return written;
}

CheckpointFile::CheckpointFile(const fs::path& file) : file_(file) {
    require_whole(file);
    read_with(file, [&](Archive& archive) { labels_ = taken_labels(archive); });
}

void CheckpointFile::load(const std::function<void(Archive&)>& state) const { read_with(file_, state); }

}  // namespace frana
