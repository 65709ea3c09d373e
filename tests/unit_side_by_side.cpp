#include "observe/side_by_side.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stdexcept>

#include "catch.h"

using namespace frana;

namespace {

/// Comes back from observe() only once so many are in it: proof that they are there at the same time.
struct Meeting {
    std::mutex lock;
    std::condition_variable all_there;
    int waited_for, there = 0;
    explicit Meeting(int number) : waited_for(number) {}
    bool wait() {
        std::unique_lock<std::mutex> guard(lock);
        ++there;
        all_there.notify_all();
        return all_there.wait_for(guard, std::chrono::seconds(30), [&] { return there >= waited_for; });
    }
};

struct Part final : Observer {
    Part(Meeting& with, std::string fails_with) : meeting(with), fails(std::move(fails_with)) {}
    std::string name() const override { return "part"; }
    void observe(const Frame& frame) override {
        met = meeting.wait();
        seen = frame.number;
        if (!fails.empty()) throw std::runtime_error(fails);
    }
    Meeting& meeting;
    std::string fails;
    bool met = false;
    Index seen = -1;
};

}  // namespace

TEST_CASE("Observers side by side see a frame at the same time, and the first that fails is told of", "[threads]") {
    Meeting meeting(3);
    std::vector<std::unique_ptr<Observer>> parts;
    std::vector<Part*> seen;
    for (const char* fails : {"", "second", "third"}) {
        auto part = std::make_unique<Part>(meeting, fails);
        seen.push_back(part.get());
        parts.push_back(std::move(part));
    }
    const auto all = side_by_side("all", std::move(parts), 3);
    CHECK(all->name() == "all");
    Frame frame;
    frame.number = 7;
    std::string told;
    try {
        all->observe(frame);
    } catch (const std::runtime_error& error) {
        told = error.what();
    }
    CHECK(told == "second");
    for (const Part* part : seen) {
        CHECK(part->met);
        CHECK(part->seen == 7);
    }
}

TEST_CASE("One thread writes one part after the other", "[threads]") {
    Meeting nobody(1);
    std::vector<std::unique_ptr<Observer>> parts;
    auto part = std::make_unique<Part>(nobody, "");
    const Part* seen = part.get();
    parts.push_back(std::move(part));
    parts.push_back(std::make_unique<Part>(nobody, ""));
    side_by_side("all", std::move(parts), 1)->observe(Frame());
    CHECK(nobody.there == 2);
    CHECK(seen->met);
}
