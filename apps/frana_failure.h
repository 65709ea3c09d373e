#pragma once
// What an exception means for the caller of the program: exit code, word and sentence.
#include <cstddef>
#include <exception>
#include <string>

namespace frana {

struct Failure {
    int code = 1;                   ///< exit code
    std::string reason = "failed";  ///< as the last line of --progress json has it
    std::string text;
    std::size_t problems = 1;  ///< that the text tells of
};

/// Shortages of memory, threads, file handles and disk are no mistakes of the program: they end with 2.
Failure failure_of(const std::exception_ptr& thrown);

}  // namespace frana
