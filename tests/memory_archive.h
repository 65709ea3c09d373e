#pragma once
// An archive that lies in memory, array by array.
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "catch.h"
#include "observe/archive.h"

/// Saves, and after rewind() loads.
class MemoryArchive final : public frana::Archive {
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

protected:
    std::size_t stored(const std::string& name, Kind kind) override {
        INFO(name);
        REQUIRE(entries_.count(name) == 1);
        REQUIRE(entries_.at(name).kind == kind);
        return entries_.at(name).bytes.size() / size_of(kind);
    }
    void exchange(const std::string& name, Kind kind, void* data, std::size_t count) override {
        const std::size_t bytes = count * size_of(kind);
        if (!loading_) {
            INFO(name);
            REQUIRE(entries_.count(name) == 0);
            const char* from = static_cast<const char*>(data);
            entries_[name] = {kind, std::vector<char>(from, from + bytes)};
        } else if (bytes > 0) {
            std::memcpy(data, entries_.at(name).bytes.data(), bytes);
        }
    }

private:
    static std::size_t size_of(Kind kind) { return kind == Kind::bytes ? 1 : 8; }
    std::map<std::string, Entry> entries_;
    bool loading_ = false;
};

/// All that a simulation keeps, but for its clock.
template <class Simulation>
std::map<std::string, MemoryArchive::Entry> kept_bits(Simulation& run) {
    MemoryArchive archive;
    run.keep(archive);
    std::map<std::string, MemoryArchive::Entry> entries = archive.entries();
    for (auto entry = entries.begin(); entry != entries.end();)
        entry = entry->first.find("clock/") != std::string::npos ? entries.erase(entry) : std::next(entry);
    return entries;
}
