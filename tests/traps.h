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
struct Traps : ListenerBase {
    using ListenerBase::ListenerBase;
    void testCaseStarting(const Catch::TestCaseInfo& info) override {
        ListenerBase::testCaseStarting(info);
        const std::string tags = info.tagsAsString();
        bool steps = false;
        for (const char* tag : {"[conserve]"}) steps = steps || tags.find(tag) != std::string::npos;
        feclearexcept(FE_ALL_EXCEPT);
        feenableexcept(FE_OVERFLOW);
        if (!steps) feenableexcept(FE_INVALID | FE_DIVBYZERO);
    }
    void testCaseEnded(const Catch::TestCaseStats& stats) override {
        fedisableexcept(FE_ALL_EXCEPT);
        ListenerBase::testCaseEnded(stats);
    }
};
CATCH_REGISTER_LISTENER(Traps)
