#pragma once
// An archive that lies in memory, array by array.
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "observe/archive.h"

namespace frana {

/// Saves, and after rewind() loads. Throws InternalError when an entry is missing, or is there twice.
class MemoryArchive final : public Archive {
public:
    struct Entry {
        Kind kind;
        std::vector<char> bytes;
        bool operator==(const Entry& other) const { return kind == other.kind && bytes == other.bytes; }
    };
    bool loading() const override { return loading_; }
    MemoryArchive& rewind() {
        loading_ = true;
        return *this;
    }
    const std::map<std::string, Entry>& entries() const { return entries_; }
    std::map<std::string, Entry>& entries() { return entries_; }

protected:
    std::size_t stored(const std::string& name, Kind kind) override {
        const auto found = entries_.find(name);
        expect(found != entries_.end() && found->second.kind == kind, ("a state that was kept has " + name).c_str());
        return found->second.bytes.size() / size_of(kind);
    }
    void exchange(const std::string& name, Kind kind, void* data, std::size_t count) override {
        const std::size_t bytes = count * size_of(kind);
        if (!loading_) {
            const char* from = static_cast<const char*>(data);
            const bool is_new = entries_.emplace(name, Entry{kind, std::vector<char>(from, from + bytes)}).second;
            expect(is_new, ("a state has one " + name).c_str());
        } else if (bytes > 0) {
            std::memcpy(data, entries_.at(name).bytes.data(), bytes);
        }
    }

private:
    static std::size_t size_of(Kind kind) { return kind == Kind::bytes ? 1 : 8; }
    std::map<std::string, Entry> entries_;
    bool loading_ = false;
};

/// All that a saved state holds, but for the clock's wall time.
inline std::map<std::string, MemoryArchive::Entry> without_clock(const MemoryArchive& archive) {
    std::map<std::string, MemoryArchive::Entry> entries;
    for (const auto& [name, entry] : archive.entries())
        if (name.find("clock/") == std::string::npos) entries.emplace(name, entry);
    return entries;
}

/// All that a simulation serializes, likewise.
template <class Simulation>
std::map<std::string, MemoryArchive::Entry> state_bits(Simulation& run) {
    MemoryArchive archive;
    run.serialize(archive);
    return without_clock(archive);
}

}  // namespace frana
