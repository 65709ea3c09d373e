#pragma once
// A simulation's state put aside in memory, to come back to. Its room is used again the next time.
#include <string>
#include <vector>

#include "observe/archive.h"

namespace frana {

class Simulation;

class MemoryState final : public Archive {
public:
    void save(Simulation& simulation);
    /// What was saved last, with all its bits.
    void load(Simulation& simulation);
    bool loading() const override { return loading_; }
    bool aside() const override { return true; }

protected:
    std::size_t stored(const std::string& name, Kind kind) override;
    void exchange(const std::string& name, Kind kind, void* data, std::size_t count) override;

private:
    struct Entry {
        std::string name;
        Kind kind;
        std::size_t count;
        std::vector<char> bytes;
    };
    Entry& next(const std::string& name, Kind kind);

    std::vector<Entry> entries_;  ///< in the order of saving, which is that of loading
    std::size_t at_ = 0;
    bool loading_ = false;
};

}  // namespace frana
