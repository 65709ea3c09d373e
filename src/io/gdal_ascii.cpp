#include "io/gdal_ascii.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "base/error.h"

namespace frana::gdal {
namespace {

struct CloseFile {
    void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

std::string lower_case(std::string_view word) {
    std::string lower(word);
    for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return lower;
}

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

/// "-12.5", "3,25" (GDAL takes the comma for a point), "1e-3".
bool is_number(std::string_view word) {
    std::size_t at = word[0] == '-' || word[0] == '+' ? 1 : 0;
    const auto digits = [&] {
        const std::size_t from = at;
        while (at < word.size() && is_digit(word[at])) ++at;
        return at - from;
    };
    std::size_t count = digits();
    if (at < word.size() && (word[at] == '.' || word[at] == ',')) ++at, count += digits();
    if (count == 0) return false;
    if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
        ++at;
        if (at < word.size() && (word[at] == '-' || word[at] == '+')) ++at;
        if (digits() == 0) return false;
    }
    return at == word.size();
}

/// What GDAL takes for no number or no data, and not for 0; "1.#QNAN" is how Windows writes it.
bool stands_for_no_number(std::string_view word) {
    constexpr std::array<std::string_view, 4> kWords = {"nan", "inf", "infinity", "null"};
    std::string lower = lower_case(word);
    if (lower[0] == '-' || lower[0] == '+') lower.erase(0, 1);
    return lower.rfind("1.#", 0) == 0 || std::find(kWords.begin(), kWords.end(), lower) != kWords.end();
}

/// "ncols 30" and "north: 500" come before the numbers.
bool begins_header(std::string_view word) {
    constexpr std::array<std::string_view, 19> kKeys = {
        "ncols", "nrows", "xllcorner", "xllcenter",    "yllcorner", "yllcenter", "cellsize",
        "dx",    "dy",    "north",     "nodata_value", "south",     "east",      "west",
        "rows",  "cols",  "null",      "type",         "multiplier"};
    std::string key = lower_case(word);
    if (!key.empty() && key.back() == ':') key.pop_back();
    return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

class Scan {
public:
    Scan(const std::filesystem::path& file, const std::string& driver)
        : file_(file),
          points_(driver == "XYZ"),
          between_(points_ ? " \t\r,;" : " \t\r"),
          star_(driver == "GRASSASCIIGrid") {}

    void take(std::string_view line) {
        ++line_;
        for (std::size_t from = 0; (from = line.find_first_not_of(between_, from)) != line.npos;) {
            const std::size_t end = std::min(line.find_first_of(between_, from), line.size());
            const std::string_view word = line.substr(from, end - from);
            if (header_ && is_header(word)) return;
            header_ = false;
            if (!is_number(word) && !stands_for_no_number(word) && !(star_ && word == "*")) refuse(word);
            from = end;
        }
    }

private:
    bool is_header(std::string_view word) const {
        return points_ ? line_ == 1 && !is_number(word) : begins_header(word);  // the names of the columns
    }
    [[noreturn]] void refuse(std::string_view word) const {
        throw UserError(
            fmt::format("{}:{}: found \"{}\"; expected numbers only; put a number there, or the file's "
                        "nodata value where none is known",
                        file_.string(), line_, word.substr(0, 40)));
    }
    const std::filesystem::path& file_;
    bool points_;  ///< a line for each
    const char* between_;
    bool star_;  ///< stands for no data
    bool header_ = true;
    long long line_ = 0;
};

}  // namespace

void require_numbers(const std::filesystem::path& file, GDALDataset& dataset) {
    const GDALDriver* const of = dataset.GetDriver();
    const std::string driver = of ? of->GetDescription() : "";
    if (driver != "AAIGrid" && driver != "GRASSASCIIGrid" && driver != "XYZ") return;
    const Messages quiet;
    const std::unique_ptr<VSILFILE, CloseFile> stream(VSIFOpenL(file.c_str(), "rb"));
    if (!stream) return;  // a name that only GDAL understands
    Scan scan(file, driver);
    std::string rest;
    std::vector<char> piece(1 << 20);
    for (std::size_t bytes; (bytes = VSIFReadL(piece.data(), 1, piece.size(), stream.get())) > 0;) {
        rest.append(piece.data(), bytes);
        std::size_t from = 0;
        for (std::size_t end; (end = rest.find('\n', from)) != rest.npos; from = end + 1)
            scan.take(std::string_view(rest).substr(from, end - from));
        rest.erase(0, from);
    }
    scan.take(rest);
}

}  // namespace frana::gdal
