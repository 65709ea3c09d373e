#include "frana_failure.h"

#include <fmt/core.h>

#include <filesystem>
#include <new>
#include <system_error>

#include "base/error.h"

namespace frana {
namespace {

/// Threads, memory or file handles that the system will not give.
bool is_shortage(const std::error_code& code) {
    return code == std::errc::resource_unavailable_try_again || code == std::errc::not_enough_memory ||
           code == std::errc::too_many_files_open || code == std::errc::too_many_files_open_in_system;
}

/// TBB, which VTK may work with, tells of a shortage by an error without code. It ends with the system's words for it.
bool tells_of_shortage(const std::exception& error) {
    const std::string text = error.what();
    for (const std::errc code : {std::errc::resource_unavailable_try_again, std::errc::not_enough_memory}) {
        const std::string words = std::make_error_code(code).message();
        if (text.size() >= words.size() && text.compare(text.size() - words.size(), words.size(), words) == 0)
            return true;
    }
    return false;
}

Failure refused(const std::string& text) { return {2, "refused", text}; }

Failure short_of(const std::exception& error) {
    return refused(
        fmt::format("{}; expected a system with memory, threads and file handles to spare; free some, or raise "
                    "the limits of the process",
                    error.what()));
}

Failure mistake(const std::exception& error) {
    return {1, "failed", fmt::format("{} (a mistake of the program; please report it with the case)", error.what())};
}

}  // namespace

Failure failure_of(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const UserError& error) {
        return {2, "refused", error.what(), error.problems().size()};
    } catch (const NumericsError& error) {
        return {3, "numerics", error.what()};
    } catch (const Interrupted& error) {
        return {130, "interrupted", error.what()};
    } catch (const std::filesystem::filesystem_error& error) {
        return refused(fmt::format("{}; check the folder, its permissions and free space", error.what()));
    } catch (const std::bad_alloc&) {
        return refused(
            "memory: found too little; expected what `frana check` tells of the case; use fewer particles or points, "
            "or a larger grid.cell");
    } catch (const std::system_error& error) {
        return is_shortage(error.code()) ? short_of(error) : mistake(error);
    } catch (const std::exception& error) {
        return tells_of_shortage(error) ? short_of(error) : mistake(error);
    } catch (...) {
        return {1, "failed", "an exception without words (a mistake of the program; please report it with the case)"};
    }
}

}  // namespace frana
