#pragma once
// Saving a state and restoring it. Each owner names its data once, and the same lines save and load. Has no file
// format; io/checkpoint_file.h has one.
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/types.h"

namespace frana {

struct PhaseTime;
struct Status;

/// Named arrays of numbers, either going in (saving) or coming out (loading) with all their bits. Names must be unique
/// within a Part. Loading throws UserError when a name is missing or is of another kind.
class Archive {
public:
    enum class Kind { real, whole, bytes };  ///< double, 64-bit integer, octets

    virtual ~Archive() = default;
    virtual bool loading() const = 0;
    /// Whether the same simulation comes back to this state after a step of ordinary length at most. What that leaves
    /// as it is need not be saved.
    virtual bool aside() const { return false; }

    /// A vector of double, std::int64_t, Index or std::uint8_t; resized when loading.
    template <class Array>
    void array(const std::string& name, Array& values) {
        const Kind kind = kind_of<typename Array::value_type>();
        if (loading()) values.resize(stored(prefix_ + name, kind));
        exchange(prefix_ + name, kind, values.data(), values.size());
    }
    void number(const std::string& name, double& value) { exchange_one(name, Kind::real, &value); }
    void number(const std::string& name, Index& value) {
        static_assert(sizeof(Index) == 8);
        exchange_one(name, Kind::whole, &value);
    }
    void text(const std::string& name, std::string& value);
    void texts(const std::string& name, std::vector<std::string>& values);
    /// Numbers that belong together, as one array in the order given.
    void numbers(const std::string& name, const std::vector<double*>& values);

    /// Refuses a state: `found` values of `name` where `expected` belong.
    [[noreturn]] static void wrong_length(const std::string& name, std::size_t found, std::size_t expected);

    /// Names that are given while this lives stand under "name/".
    class Part {
    public:
        Part(Archive& archive, const std::string& name) : archive_(archive), outer_(archive.prefix_) {
            archive.prefix_ += name + "/";
        }
        ~Part() { archive_.prefix_ = outer_; }
        Part(const Part&) = delete;
        Part& operator=(const Part&) = delete;

    private:
        Archive& archive_;
        std::string outer_;
    };

protected:
    /// Loading: how many values lie under the full name.
    virtual std::size_t stored(const std::string& name, Kind kind) = 0;
    /// Saving: reads `count` values from `data`; loading: writes them there. `count` is what stored() said.
    virtual void exchange(const std::string& name, Kind kind, void* data, std::size_t count) = 0;

private:
    template <class T>
    static constexpr Kind kind_of() {
        static_assert(std::is_same_v<T, double> || std::is_same_v<T, std::uint8_t> ||
                      (std::is_integral_v<T> && sizeof(T) == 8));
        return std::is_same_v<T, double> ? Kind::real : std::is_same_v<T, std::uint8_t> ? Kind::bytes : Kind::whole;
    }
    void exchange_one(const std::string& name, Kind kind, void* value);

    std::string prefix_;
};

/// Saves and loads a status, all of it.
void serialize(Archive& archive, const std::string& name, Status& status);
/// Saves and loads phases with their names.
void serialize(Archive& archive, const std::string& name, std::vector<PhaseTime>& phases);

/// Bytes that a state would take, found by saving it nowhere.
class ArchiveSize final : public Archive {
public:
    bool loading() const override { return false; }
    std::uint64_t bytes() const { return bytes_; }
    std::uint64_t arrays() const { return arrays_; }

protected:
    std::size_t stored(const std::string&, Kind) override { return 0; }
    void exchange(const std::string&, Kind kind, void*, std::size_t count) override {
        bytes_ += count * (kind == Kind::bytes ? 1 : 8);
        ++arrays_;
    }

private:
    std::uint64_t bytes_ = 0, arrays_ = 0;
};

}  // namespace frana
