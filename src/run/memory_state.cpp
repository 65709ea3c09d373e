#include "run/memory_state.h"

#include <cstring>

#include "base/error.h"
#include "run/simulation.h"

namespace frana {
namespace {

std::size_t size_of(Archive::Kind kind) { return kind == Archive::Kind::bytes ? 1 : 8; }

}  // namespace

void MemoryState::save(Simulation& simulation) {
    loading_ = false;
    at_ = 0;
    simulation.serialize(*this);
    entries_.resize(at_);
}

void MemoryState::load(Simulation& simulation) {
    loading_ = true;
    at_ = 0;
    simulation.serialize(*this);
}

MemoryState::Entry& MemoryState::next(const std::string& name, Kind kind) {
    expect(at_ < entries_.size() && entries_[at_].name == name && entries_[at_].kind == kind,
           "a state is loaded as it was saved");
    return entries_[at_];
}

std::size_t MemoryState::stored(const std::string& name, Kind kind) { return next(name, kind).count; }

void MemoryState::exchange(const std::string& name, Kind kind, void* data, std::size_t count) {
    const std::size_t bytes = count * size_of(kind);
    if (!loading_) {
        if (at_ == entries_.size()) entries_.emplace_back();
        Entry& entry = entries_[at_];
        entry.name = name, entry.kind = kind, entry.count = count;
        entry.bytes.resize(bytes);
        if (bytes > 0) std::memcpy(entry.bytes.data(), data, bytes);
    } else if (bytes > 0) {
        std::memcpy(data, next(name, kind).bytes.data(), bytes);
    }
    ++at_;
}

}  // namespace frana
