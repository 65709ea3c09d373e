#pragma once
// What a reader may answer to bytes from anywhere.
#include <stdexcept>
#include <string>

#include "base/error.h"

namespace frana::fuzz {

/// Calls `read`; a UserError must be sentences without a line break, none of them empty.
template <class Read>
void refused_fairly(Read&& read) {
    try {
        read();
    } catch (const UserError& error) {
        if (error.problems().empty()) throw std::logic_error("refused without a reason");
        for (const std::string& problem : error.problems())
            if (problem.empty() || problem.find('\n') != std::string::npos)
                throw std::logic_error("not one sentence: \"" + problem + "\"");
    }
}

}  // namespace frana::fuzz
