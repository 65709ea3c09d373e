// Figures that are drawn side by side: in their order whatever the threads, and each failure a warning in its place.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "run/folder/gallery.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

/// Ten pictures, of which the fourth cannot be drawn and the eighth throws; the first takes longest.
struct Ten {
    FreshFolder folder;
    Gallery gallery{folder.path()};
    std::atomic<int> at_once{0}, most_at_once{0};

    Ten() {
        for (int k = 0; k < 10; ++k)
            gallery.add({"figures/" + std::to_string(k) + ".png", "number " + std::to_string(k)},
                        [this, k](const fs::path& png, std::string& why_not) { return draw(k, png, why_not); });
        gallery.warn("the last word");
    }
    bool draw(int k, const fs::path& png, std::string& why_not) {
        const int now = ++at_once;
        for (int most = most_at_once; now > most && !most_at_once.compare_exchange_weak(most, now);) {
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(k == 0 ? 60 : 5));
        --at_once;
        if (k == 3) return why_not = "there is nothing to see", false;
        if (k == 7) throw UserError("the paper is wet");
        write_text(png, "picture");
        return true;
    }
};

}  // namespace

TEST_CASE("figures come in the order in which they were added, on one thread and on several", "[gallery]") {
    for (const int threads : {1, 4}) {
        CAPTURE(threads);
        Ten ten;
        std::vector<std::string> warnings;
        std::vector<std::size_t> told;
        const auto drawn = ten.gallery.draw(threads, warnings, [&](std::size_t done, std::size_t all) {
            CHECK(all == 10);
            told.push_back(done);
        });
        REQUIRE(drawn.size() == 8);
        const char* names[] = {"0", "1", "2", "4", "5", "6", "8", "9"};
        for (std::size_t k = 0; k < drawn.size(); ++k) {
            CHECK(drawn[k].path == "figures/" + std::string(names[k]) + ".png");
            CHECK(fs::exists(ten.folder.path() / drawn[k].path));
        }
        CHECK(warnings == std::vector<std::string>{"figures/3.png was not drawn: there is nothing to see",
                                                   "figures/7.png was not drawn: the paper is wet", "the last word"});
        REQUIRE(told.size() == 11);
        for (std::size_t k = 0; k < told.size(); ++k) CHECK(told[k] == k);
        CHECK(ten.most_at_once <= threads);
        if (threads > 1) CHECK(ten.most_at_once > 1);  // the first alone would hold the others up
    }
}

TEST_CASE("pictures for the renderer are begun first, one after the other while there is anything else", "[gallery]") {
    const FreshFolder folder;
    Gallery gallery(folder.path());
    std::mutex mutex;
    std::vector<std::string> begun;
    int rendering = 0, most_rendering = 0, plain_left = 6;
    const auto draw = [&](const fs::path& png, bool rendered) {
        {
            const std::lock_guard<std::mutex> lock(mutex);
            begun.push_back(png.stem().string());
            plain_left -= !rendered;
            rendering += rendered;
            if (plain_left > 0) most_rendering = std::max(most_rendering, rendering);
        }
        for (int wait = 0; !rendered && wait < 200; ++wait) {  // or a thread that is held up would tell its name late
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            const std::lock_guard<std::mutex> lock(mutex);
            if (std::find(begun.begin(), begun.end(), "view") != begun.end()) break;
        }
        if (rendered) std::this_thread::sleep_for(std::chrono::milliseconds(30));
        const std::lock_guard<std::mutex> lock(mutex);
        rendering -= rendered;
        return true;
    };
    for (const char* name : {"a", "b", "c", "d", "e", "f"})
        gallery.add({"figures/" + std::string(name) + ".png", name},
                    [&](const fs::path& png, std::string&) { return draw(png, false); });
    for (const char* name : {"view", "close", "section"})
        gallery.add_rendered({"figures/" + std::string(name) + ".png", name},
                             [&](const fs::path& png, std::string&) { return draw(png, true); });
    std::vector<std::string> warnings;
    const auto drawn = gallery.draw(2, warnings);
    REQUIRE(drawn.size() == 9);
    CHECK(drawn.front().caption == "a");  // in the order in which they were added
    REQUIRE(begun.size() == 9);
    CHECK((begun[0] == "view" || begun[1] == "view"));
    CHECK(most_rendering == 1);
    CHECK(warnings.empty());
}

TEST_CASE("a gallery without pictures says nothing but its warnings", "[gallery]") {
    const FreshFolder folder;
    Gallery gallery(folder.path());
    gallery.warn("no terrain");
    std::vector<std::string> warnings;
    CHECK(gallery.draw(2, warnings, [](std::size_t, std::size_t) { FAIL("there is nothing to draw"); }).empty());
    CHECK(warnings == std::vector<std::string>{"no terrain"});
}
