#include "scene/case_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/layer_name.h"
#include "scene/case_reader.h"

namespace frana {
namespace {

std::string read_whole(const std::filesystem::path& file) {
    if (std::filesystem::is_directory(file))
        throw UserError(fmt::format("{0}: found a folder; expected a case file; name the file, such as {0}/case.toml",
                                    file.string()));
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw UserError(
            fmt::format("{}: found no file that can be read; expected a case file in TOML; correct the "
                        "name, or see `frana describe` for what a case holds",
                        file.string()));
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

}  // namespace

/// The steps shared by read() and parse().
static CaseFile checked(CaseFile& result, const std::string& text, const std::vector<std::string>& sets,
                        bool look_for_files) {
    Problems problems;
    CaseReader reader(result, problems);
    if (reader.read_text(text)) {
        for (const std::string& set : sets) reader.apply_set(set);
        reader.check_rules();
        if (look_for_files) reader.check_files();
    }
    problems.throw_if_any();
    return std::move(result);
}

CaseFile CaseFile::read(const std::filesystem::path& file, const std::vector<std::string>& sets) {
    CaseFile result;
    result.file_ = file;
    result.text_ = read_whole(file);
    return checked(result, result.text_, sets, true);
}

CaseFile CaseFile::parse(const std::string& text, const std::filesystem::path& file,
                         const std::vector<std::string>& sets) {
    CaseFile result;
    result.file_ = file;
    result.text_ = text;
    return checked(result, text, sets, false);
}

std::string CaseFile::name() const {
    std::string stem = file_.stem().string();
    if (stem != "case" && stem != "resolved") return stem;
    const std::string folder = std::filesystem::absolute(file_).parent_path().filename().string();
    return folder.empty() ? stem : folder;
}

Index CaseFile::count(const std::string& table) const {
    const auto found = counts_.find(table);
    return found == counts_.end() ? 0 : found->second;
}

const Value* CaseFile::find(const std::string& key) const {
    const auto setting = settings_.find(key);
    if (setting != settings_.end()) return &setting->second.value;
    const Parameter* parameter = find_parameter(key);
    expect(parameter != nullptr, key.c_str());
    for (const OtherDefault& other : parameter->otherwise)
        if (has(other.when) && value(other.when) == other.is) return &other.value;
    return parameter->fallback ? &*parameter->fallback : nullptr;
}

const Value& CaseFile::value(const std::string& key) const {
    const Value* found = find(key);
    expect(found != nullptr, key.c_str());
    return *found;
}

double CaseFile::number(const std::string& key) const { return std::get<double>(value(key)); }
Index CaseFile::integer(const std::string& key) const { return static_cast<Index>(number(key)); }
bool CaseFile::flag(const std::string& key) const { return std::get<bool>(value(key)); }
const std::string& CaseFile::word(const std::string& key) const { return std::get<std::string>(value(key)); }
const std::vector<double>& CaseFile::numbers(const std::string& key) const {
    return std::get<std::vector<double>>(value(key));
}
const std::vector<std::string>& CaseFile::words(const std::string& key) const {
    return std::get<std::vector<std::string>>(value(key));
}
const std::vector<Vec2>& CaseFile::points(const std::string& key) const {
    return std::get<std::vector<Vec2>>(value(key));
}

bool CaseFile::is_text(const std::string& key) const {
    const Value& held = value(key);
    return std::holds_alternative<std::string>(held) || std::holds_alternative<std::vector<std::string>>(held);
}

std::filesystem::path CaseFile::path(const std::string& key) const { return resolve(word(key)); }

std::filesystem::path CaseFile::resolve(const std::string& path) const {
    const std::filesystem::path sibling = file_.parent_path() / path;
    const bool virtual_name = path.find(':') != std::string::npos && !std::filesystem::exists(sibling);
    return virtual_name ? std::filesystem::path(path) : sibling;
}

std::vector<std::pair<std::string, std::filesystem::path>> CaseFile::named_files() const {
    std::vector<std::pair<std::string, std::filesystem::path>> files;
    for (const auto& [key, setting] : settings_) {
        const Parameter* parameter = find_parameter(key);
        if (!parameter || !names_files(parameter->kind) || !is_text(key)) continue;
        if (const auto* one = std::get_if<std::string>(&setting.value))
            if (!names_field(*one)) files.emplace_back(key, resolve(split_layer(*one).file));
        if (const auto* several = std::get_if<std::vector<std::string>>(&setting.value))
            for (const std::string& name : *several) files.emplace_back(key, resolve(split_layer(name).file));
    }
    return files;
}

std::vector<std::filesystem::path> CaseFile::files_of_set(const std::string& set) const {
    CaseFile with = *this;
    with.settings_.clear();  // of tables there are as many as before
    Problems said_by_the_run;
    CaseReader(with, said_by_the_run).apply_set(set);
    std::vector<std::filesystem::path> files;
    for (const auto& [key, path] : with.named_files()) files.push_back(path);
    return files;
}

std::vector<std::filesystem::path> CaseFile::inputs() const {
    std::vector<std::filesystem::path> files = {file_};
    for (const auto& [key, path] : named_files()) files.push_back(path);
    return files;
}

std::string CaseFile::place(const std::string& key) const {
    const auto setting = settings_.find(key);
    if (setting != settings_.end()) return setting->second.place;
    const std::string table = table_place(key.substr(0, key.rfind('.')));
    return table + key.substr(key.rfind('.'));
}

std::string CaseFile::table_place(const std::string& table) const {
    const auto line = table_lines_.find(table);
    return fmt::format("{}:{}: {}", file_.string(), line == table_lines_.end() ? 1 : line->second, table);
}

}  // namespace frana
