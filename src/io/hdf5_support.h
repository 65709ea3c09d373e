#pragma once
// What the HDF5 writers and readers of this room share; includes HDF5, so only for .cpp files of this room.
#include <hdf5.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace frana::hdf5 {

/// Silences HDF5's printing while errors are thrown instead.
class QuietErrors {
public:
    QuietErrors() {
        H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;

private:
    H5E_auto2_t print_ = nullptr;
    void* data_ = nullptr;
};

/// A file while it is written or read: every HDF5 result passes `check`, which throws with the file's name.
class Access {
public:
    enum class Mode { write, read };
    explicit Access(std::filesystem::path file, Mode mode = Mode::write) : file_(std::move(file)), mode_(mode) {}

    template <class Result>
    Result check(Result result) const {
        if (result < 0) throw failure(last_reason());
        return result;
    }
    UserError failure(const std::string& reason) const;
    const std::filesystem::path& file() const { return file_; }

private:
    static std::string last_reason();
    std::filesystem::path file_;
    Mode mode_;
};

/// An HDF5 identifier with its closing function.
class Handle {
public:
    Handle(const Access& access, hid_t id, herr_t (*closer)(hid_t))
        : access_(access), id_(access.check(id)), closer_(closer) {}
    ~Handle() {
        if (id_ >= 0) closer_(id_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }
    /// Closes and checks; what is still in memory is written now, so a full disk shows here.
    void close() {
        const hid_t id = id_;
        id_ = -1;
        access_.check(closer_(id));
    }

private:
    const Access& access_;
    hid_t id_;
    herr_t (*closer_)(hid_t);
};

void put_text(const Access& access, hid_t object, const char* name, const std::string& text);
void put_numbers(const Access& access, hid_t object, const char* name, const std::vector<double>& numbers);

/// The first axis that is more than a formality.
std::size_t axis_of(const std::vector<hsize_t>& shape);

/// The shape of as many whole rows of a dataset as have at most so many bytes, but one row at least. All of it where it
/// is empty.
std::vector<hsize_t> piece_of(std::vector<hsize_t> shape, std::size_t bytes_of_a_number, hsize_t most);

/// Writes a dataset of that type in memory. In pieces: Linux may take single writes of more than 2 MB at a tenth of the
/// speed. That happens when no large pages are free for its cache (measured: 3 or 33 ms for 12 MB).
void write_whole(const Access& access, hid_t set, hid_t type, const void* values);

/// A dataset's shape and its values as double.
struct Numbers {
    std::vector<hsize_t> shape;
    std::vector<double> values;
};
Numbers read_numbers(const Access& access, hid_t group, const std::string& name);

/// Allocates the space on the disk before HDF5 writes. When the disk fills up under it, HDF5 leaves a broken file
/// behind (and crashes at exit). What is too much is given back when HDF5 closes the file.
void reserve(const Access& access, const std::filesystem::path& file, off_t bytes);

}  // namespace frana::hdf5
