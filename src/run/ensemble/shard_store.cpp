#include "run/ensemble/shard_store.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/pattern.h"
#include "base/version.h"
#include "ensemble/sample_table.h"
#include "io/hdf5_peaks.h"
#include "run/ensemble/kept_rows.h"
#include "run/folder/input_sums.h"
#include "scene/case_file.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kAtOnce = 64;            ///< runs in a file, when they are quick
constexpr std::chrono::seconds kPatience{10};  ///< and when they are slow
constexpr const char* kColumns =
    "sample,reason,time_s,steps,seconds,volume_m3,runout_m,reach_m,footprint_area_m2,max_depth_m,max_speed_m_s,"
    "eroded_m3,deposited_m3,left_share,mass_error,iou,boundary_m,still_moves,peaks,inputs,message,remarks";
constexpr std::size_t kColumnCount = 22;
constexpr std::size_t kGaugeColumns = 3;  ///< of each gauge, behind those

std::string columns_of(const std::vector<Gauge>& gauges) {
    std::string columns = kColumns;
    for (const Gauge& gauge : gauges) columns += fmt::format(",{0}_depth_m,{0}_speed_m_s,{0}_arrival_s", gauge.name);
    return columns;
}

/// Of what was refused before its first step there are no gauges: their fields are empty too.
/// `inputs`: a sum of the files that the sample's values name.
std::string row_of(const SampleResult& r, const std::string& peaks, const std::string& inputs, std::size_t gauges) {
    std::string row =
        fmt::format("{},{},{},{},{:.3f},{},{},{},{},{},{},{},{},{},{},{},{},{:d},{},{},{},{}", r.sample, r.reason,
                    r.time, r.steps, r.seconds, r.volume, r.runout, r.reach, r.footprint_area, r.max_depth, r.max_speed,
                    r.eroded, r.deposited, r.left_share, r.mass_error, text_of_known(r.iou), text_of_known(r.boundary),
                    r.still_moves, peaks, inputs, plain_field(r.message), remarks_field(r.remarks));
    for (std::size_t k = 0; k < gauges; ++k) {
        const GaugePeak peak = k < r.gauges.size() ? r.gauges[k] : GaugePeak();
        row +=
            fmt::format(",{},{},{}", text_of_known(peak.depth), text_of_known(peak.speed), text_of_known(peak.arrival));
    }
    return row + "\n";
}

/// A row as it was stored.
struct KeptRow {
    SampleResult result;
    std::string peaks, inputs;  ///< the file of its peaks, and the sum of the files that its values name
};

KeptRow result_of(const fs::path& file, const std::string& line, std::size_t gauges) {
    const std::vector<std::string> f = comma_fields(line);
    if (f.size() != kColumnCount + kGaugeColumns * gauges) throw broken_row(file, line);
    SampleResult r;
    try {
        r.sample = std::stoll(f[0]), r.reason = f[1], r.time = kept_number(f[2]), r.steps = std::stoll(f[3]);
        double* const numbers[] = {&r.seconds,        &r.volume,     &r.runout,    &r.reach,
                                   &r.footprint_area, &r.max_depth,  &r.max_speed, &r.eroded,
                                   &r.deposited,      &r.left_share, &r.mass_error};
        for (std::size_t k = 0; k < std::size(numbers); ++k) *numbers[k] = kept_number(f[4 + k]);
        const auto known = [&](std::size_t k) {
            return f[k].empty() ? std::nullopt : std::optional<double>(kept_number(f[k]));
        };
        r.iou = known(15), r.boundary = known(16);
        r.still_moves = kept_number(f[17]) != 0.0, r.message = f[20], r.remarks = remarks_of_field(f[21]);
        for (std::size_t k = kColumnCount; k < f.size(); k += kGaugeColumns)
            r.gauges.push_back({known(k), known(k + 1), known(k + 2)});
    } catch (const std::logic_error&) {  // what the conversions say of text that is no number
        throw broken_row(file, line);
    }
    return {std::move(r), f[18], f[19]};
}

RowsOf rows_of(const EnsemblePlan& plan, const EnsembleBase& base) {
    return {"ensemble", mark_of(plan), columns_of(base.gauges)};
}

/// Runs under one name must be runs of one file.
void require_same_inputs(const fs::path& file, Index sample, const std::string& inputs, const ValueSums& now) {
    if (inputs == now.of(sample)) return;
    throw UserError(fmt::format(
        "{}: found sample {} made with another content of {}; expected runs of the same ensemble; choose another "
        "folder with --out, or give the files back that these runs were made with",
        file.string(), sample, now.values_of(sample)));
}

/// Only of methods that can be prolonged: of others the number of samples decides all of them.
void require_no_more(const fs::path& dir, std::size_t runs, Index last, const EnsemblePlan& plan) {
    if (last < plan.samples) return;
    throw UserError(
        fmt::format("{}: found {} runs, the last of them sample {}, where samples is {}; expected no fewer samples "
                    "than there were; "
                    "give samples = {}, or choose another folder with --out",
                    (dir / "shards").string(), runs, last, plan.samples, last + 1));
}

std::vector<fs::path> row_files(const fs::path& dir) {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(dir / "shards", none))
        if (fs::is_regular_file(entry.path() / "runs.csv")) files.push_back(entry.path() / "runs.csv");
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

void remove_leftovers(const fs::path& folder) {
    static const Pattern half_written(
        "\\.(peaks|runs|probability|quantile|mean|first_order|total|hazard|terrain|maps|reached|report|ensemble|"
        "view|runout|gauges|convergence|scatter|samples|calibrate|posterior|predict).*\\.tmp\\d+(\\..*)?");
    std::vector<fs::path> found;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
        if (half_written.matches(entry.path().filename().string())) found.push_back(entry.path());
    for (const fs::path& file : found) fs::remove(file, ignored);
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return quoted + "\"";
}

std::string text_of_known(const std::optional<double>& number) { return number ? fmt::format("{}", *number) : ""; }

Shard read_shard(const std::string& text) {
    Shard shard;
    int past = 0;
    long long number = 0, of = 0;
    const bool read =
        std::sscanf(text.c_str(), "%lld/%lld%n", &number, &of, &past) == 2 && past == static_cast<int>(text.size());
    if (!read || number < 0 || of < 1 || number >= of)
        throw UserError(
            fmt::format("--shard: found \"{}\"; expected I/N with I from 0 to N - 1; write it like 0/4", text));
    shard.number = number, shard.of = of;
    return shard;
}

fs::path shard_folder(const fs::path& dir, const Shard& shard) {
    return dir / "shards" / fmt::format("{}_of_{}", shard.number, shard.of);
}

/// Sobol's and random samples stay when there are more of them.
std::string mark_of(const EnsemblePlan& plan) {
    std::string decides = plan.method_name + plan.table_text;
    for (const std::string& field : plan.fields) decides += " " + field;
    for (const Vary& vary : plan.vary) {
        const Distribution& of = vary.distribution;
        decides += fmt::format(" {} {} {} {} {} {} {} {} {}", vary.key, static_cast<int>(of.kind), of.low, of.high,
                               of.middle, of.spread, of.alpha, of.beta, vary.levels);
        for (std::size_t k = 0; k < of.values.size(); ++k)
            decides += fmt::format(" {} {}", of.values[k], of.weights[k]);
    }
    const bool prolongs = plan.method == Method::sobol || plan.method == Method::random;
    return fmt::format("# frana {},seed {},samples {},keys {:016x},case {:016x}", FRANA_VERSION, plan.seed,
                       prolongs ? "any" : std::to_string(plan.samples), sum_of(decides),
                       sum_of(mark_of_inputs(CaseFile::read(plan.case_file))));
}

bool has_runs_of(const fs::path& dir, const EnsemblePlan& plan) {
    const std::vector<fs::path> files = row_files(dir);
    for (const fs::path& file : files) require_rows_of(file, {"ensemble", mark_of(plan), ""});
    return !files.empty();
}

ShardStore::ShardStore(fs::path folder, const EnsemblePlan& plan, const EnsembleBase& base)
    : folder_(std::move(folder)), plan_(plan), base_(base), sums_(plan), rows_(text_in(folder_ / "runs.csv")) {
    if (rows_.empty()) rows_ = rows_of(plan, base).head();
}

void ShardStore::add(SampleResult result) {
    const std::lock_guard<std::mutex> alone(mutex_);
    if (broken_) return;
    waiting_.push_back(std::move(result));
    if (waiting_.size() >= kAtOnce || std::chrono::steady_clock::now() - written_ > kPatience) write();
}

void ShardStore::flush() {
    const std::lock_guard<std::mutex> alone(mutex_);
    if (!waiting_.empty() && !broken_) write();
}

void ShardStore::write() {
    broken_ = true;  // until all is written: what one thread could not write, another must not try
    std::sort(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) { return a.sample < b.sample; });
    PeakBlock block;
    block.grid = base_.whole, block.fields = plan_.fields;
    for (SampleResult& result : waiting_)
        if (result.ended()) block.samples.push_back(result.sample), block.peaks.push_back(std::move(result.peaks));
    const std::string peaks = block.samples.empty() ? "" : new_peaks_file(block.samples.front());
    if (!block.samples.empty()) write_peaks(folder_ / peaks, block);
    for (const SampleResult& result : waiting_)
        rows_ += row_of(result, result.ended() ? peaks : "", sums_.of(result.sample), base_.gauges.size());
    write_text(folder_ / "runs.csv", rows_);
    waiting_.clear();
    broken_ = false;
    written_ = std::chrono::steady_clock::now();
}

/// Of its first run that ended: one that was refused is tried again and has no file. What is there holds others' peaks.
std::string ShardStore::new_peaks_file(Index first) const {
    std::string name = fmt::format("peaks_{:07}.h5", first);
    for (int k = 2; fs::exists(folder_ / name); ++k) name = fmt::format("peaks_{:07}_{}.h5", first, k);
    return name;
}

KeptResults read_results(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base) {
    std::map<Index, std::pair<SampleResult, fs::path>> by_sample;
    const RowsOf of = rows_of(plan, base);
    const ValueSums sums(plan);
    for (const fs::path& file : row_files(dir)) {
        for_each_row(file, of, [&](const std::string& line) {
            auto [result, name, inputs] = result_of(file, line, base.gauges.size());
            const Index sample = result.sample;
            if (sample < 0 || result.ended() == name.empty()) throw broken_row(file, line);
            if (sample < plan.samples && result.ended()) require_same_inputs(file, sample, inputs, sums);
            std::pair row{std::move(result), name.empty() ? fs::path() : file.parent_path() / name};
            const auto before = by_sample.find(sample);
            if (before == by_sample.end())
                by_sample.emplace(sample, std::move(row));
            else if (before->second.first.reason == "refused")  // and tried again
                before->second = std::move(row);
        });
    }
    require_no_more(dir, by_sample.size(), by_sample.empty() ? -1 : by_sample.rbegin()->first, plan);
    KeptResults kept;
    for (auto& [sample, row] : by_sample)
        kept.results.push_back(std::move(row.first)), kept.peaks_files.push_back(std::move(row.second));
    return kept;
}

}  // namespace frana
