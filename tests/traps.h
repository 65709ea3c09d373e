#pragma once
// Floating-point traps while tests run (FRANA_TRAPS): what makes an infinity or a NaN ends the test there and then.
#include <cfenv>
#include <string>

#if __has_include(<catch2/catch_all.hpp>)
using ListenerBase = Catch::EventListenerBase;
#else
using ListenerBase = Catch::TestEventListenerBase;
#endif

/// Overflow traps in all tests. Where the solver takes steps, invalid operations and divisions by zero do not: its kernels
/// compute both sides of a choice, for four nodes at once, and a node at rest divides by its speed in the side not taken.
/// Nor where a test has what is no number ([nan]): nodata is NaN, and to compare with it, always false, is invalid. With
/// clang they trap nowhere: it computes both sides of any choice.
struct Traps : ListenerBase {
    using ListenerBase::ListenerBase;
    void testCaseStarting(const Catch::TestCaseInfo& info) override {
        ListenerBase::testCaseStarting(info);
        const std::string tags = info.tagsAsString();
#ifdef __clang__
        bool excused = true;
#else
        bool excused = false;
#endif
        for (const char* tag : {"[bench]", "[conserve]", "[insitu]", "[lake]", "[nan]", "[nodes]", "[precision]",
                                "[resume]", "[rest]", "[solid]", "[solver]", "[speed]", "[fuzz]", "[verify]"})
            excused = excused || tags.find(tag) != std::string::npos;
        feclearexcept(FE_ALL_EXCEPT);
        feenableexcept(FE_OVERFLOW);
        if (!excused) feenableexcept(FE_INVALID | FE_DIVBYZERO);
    }
    void testCaseEnded(const Catch::TestCaseStats& stats) override {
        fedisableexcept(FE_ALL_EXCEPT);
        ListenerBase::testCaseEnded(stats);
    }
};
CATCH_REGISTER_LISTENER(Traps)
