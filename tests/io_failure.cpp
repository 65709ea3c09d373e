// What an exception means for who called the program: the same code, word and sentence for people and for other programs.
#include <filesystem>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>

#include "apps/frana_failure.h"
#include "apps/frana_progress_lines.h"
#include "base/error.h"
#include "catch.h"

using namespace frana;
using Catch::Contains;

namespace {

template <class Error>
Failure of(const Error& error) {
    return failure_of(std::make_exception_ptr(error));
}

/// The last line of --progress json of a command that throws.
template <class Error>
nlohmann::json last_line(const Error& error) {
    std::ostringstream said;
    std::streambuf* const before = std::cout.rdbuf(said.rdbuf());
    ProgressLines lines("json", "run");
    CHECK_THROWS_AS(lines.around([&]() -> int { throw error; }), Error);
    std::cout.rdbuf(before);
    const std::string text = said.str(), end = text.substr(text.rfind('\n', text.size() - 2) + 1);
    return nlohmann::json::parse(end);
}

}  // namespace

TEST_CASE("A shortage of the system is no mistake of the program, for people and for other programs", "[programs]") {
    const std::system_error threads(std::make_error_code(std::errc::resource_unavailable_try_again), "thread");
    const std::runtime_error tbb("tbb: Cannot allocate memory"), other("of another kind");
    CHECK(of(threads).code == 2);
    CHECK(of(tbb).code == 2);
    CHECK(of(std::bad_alloc()).code == 2);
    CHECK_THAT(of(std::bad_alloc()).text, Contains("memory: found too little"));
    const std::filesystem::filesystem_error full("write", std::make_error_code(std::errc::no_space_on_device));
    CHECK(of(full).code == 2);
    CHECK(of(other).code == 1);
    CHECK_THAT(of(other).text, Contains("a mistake of the program"));
    CHECK(of(std::system_error(std::make_error_code(std::errc::bad_address), "x")).code == 1);
    CHECK(of(UserError(std::vector<std::string>{"a", "b"})).problems == 2);
    CHECK(of(NumericsError("n")).code == 3);
    CHECK(of(Interrupted("i")).code == 130);

    const auto told = last_line(threads);
    CHECK(told["exit_code"] == 2);
    CHECK(told["exit_reason"] == "refused");
    CHECK(told["error"] == of(threads).text);
    CHECK(last_line(other)["exit_code"] == 1);
    CHECK(last_line(NumericsError("n"))["exit_reason"] == "numerics");
}
