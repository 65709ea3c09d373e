#include "observe/sections.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace frana {
namespace {

/// The positive sense across a piece.
Vec2 across(const Vec2& piece, bool to_right) {
    const Vec2 right(piece.y(), -piece.x());
    return to_right ? right : Vec2(-right);
}

}  // namespace

double discharge_through(const SectionLine& section, double spacing, const Probe& probe) {
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < section.line.size(); ++k) {
        const Vec2 piece = section.line[k + 1] - section.line[k], normal = across(piece, section.to_right);
        const auto parts = static_cast<Index>(std::ceil(piece.norm() / spacing - 1e-9));
        for (Index part = 0; part < parts; ++part) {
            const double share = (static_cast<double>(part) + 0.5) / static_cast<double>(parts);
            const Vec2 place = section.line[k] + share * piece;
            if (!section.covers(place)) continue;
            const Sample flow = probe.at(place);
            sum += flow.depth * flow.velocity.dot(normal) / static_cast<double>(parts);
        }
    }
    return sum;
}

Sections::Sections(const std::filesystem::path& run_dir, std::vector<SectionLine> lines, double spacing,
                   std::vector<SectionSummary>& summaries)
    : lines_(std::move(lines)), spacing_(spacing), summaries_(summaries), discharge_(lines_.size(), 0.0) {
    summaries_.resize(lines_.size());
    for (std::size_t n = 0; n < lines_.size(); ++n) {
        summaries_[n].name = lines_[n].name;
        summaries_[n].towards = across(lines_[n].line.back() - lines_[n].line.front(), lines_[n].to_right).normalized();
        tables_.emplace_back(run_dir / "sections" / (lines_[n].name + ".csv"),
                             std::vector<std::string>{"t [s]", "discharge [m3/s]", "volume [m3]", "sediment [m3]"});
    }
}

void Sections::step(const Status& now, const Probe& probe) {
    const std::vector<double> passed = probe.passed();
    for (std::size_t n = 0; n < lines_.size(); ++n) {
        SectionSummary& summary = summaries_[n];
        const double discharge = discharge_through(lines_[n], spacing_, probe);
        summary.integral += 0.5 * (discharge_[n] + discharge) * (now.time - time_);
        discharge_[n] = discharge;
        if (discharge > summary.peak) summary.peak = discharge, summary.peak_time = now.time;
        summary.volume = n < passed.size() ? passed[n] : TableWriter::empty;
        summary.sediment = lines_[n].solid_share * summary.volume;
        tables_[n].add({now.time, discharge, summary.volume, summary.sediment});
    }
    time_ = now.time;
}

void Sections::observe(const Frame&) {
    for (TableWriter& table : tables_) table.flush();
}

void Sections::serialize(Archive& archive) {
    archive.number("time", time_);
    archive.array("discharge", discharge_);
    for (std::size_t n = 0; n < summaries_.size(); ++n) {
        const Archive::Part part(archive, fmt::format("section_{}", n));
        SectionSummary& s = summaries_[n];
        archive.numbers("summary", {&s.volume, &s.integral, &s.peak, &s.peak_time});
        s.sediment = lines_[n].solid_share * s.volume;
    }
    serialize_all(archive, tables_);
}

}  // namespace frana
