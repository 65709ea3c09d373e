// The ranges of the table for people: lines of `frana describe`, and the page cases/PARAMETERS.md.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/number_text.h"
#include "scene/mud_table.h"
#include "scene/parameter_priors.h"
#include "scene/parameter_ranges.h"
#include "scene/parameters.h"
#include "scene/salm_table.h"

namespace frana {
namespace {

std::string unit_of(const std::string& key) {
    const Parameter* parameter = find_parameter(key);
    expect(parameter != nullptr, key.c_str());
    return after_number(parameter->unit);
}

std::string source_of(const ParameterRange& row) { return *row.source ? row.source : "a common range"; }

/// `scale` turns the table's value into the key's.
std::string range_text(double low, double high, double (*scale)(double)) {
    const double a = scale(low), b = scale(high);
    return low == high ? fmt::format("{:.4g}", a) : fmt::format("{:.4g} to {:.4g}", a, b);
}

double same(double value) { return value; }

std::string range_row(const ParameterRange& row) {
    return fmt::format("| `{}` | {} | {}{} | {} | {} |\n", row.key, row.law, range_text(row.low, row.high, same),
                       unit_of(row.key), row.what, source_of(row));
}

std::string ranges_of(const std::string& kind, const char* title) {
    std::string text =
        fmt::format("\n### {}\n\n| Key | Bed law | Values | Of | Source |\n|---|---|---|---|---|\n", title);
    for (const ParameterRange& row : parameter_ranges())
        if (row.kind == kind) text += range_row(row);
    return text;
}

std::string kinds_table() {
    std::string text = "| `case.kind` | Mass | Density without `material.density` [kg/m3] |\n|---|---|---|\n";
    for (const MassKind& kind : mass_kinds())
        text += fmt::format("| `{}` | {} | {:g} |\n", kind.name, kind.meaning, kind.density);
    return text;
}

std::string xi_cell(const salm::Altitudes& xi) { return fmt::format("{:g}/{:g}/{:g}", xi[0], xi[1], xi[2]); }

/// ".170/.150/.140"
std::string mu_cell(const salm::Altitudes& mu) {
    std::string text;
    for (const double value : mu) text += (text.empty() ? "" : "/") + fmt::format("{:.3f}", value).substr(1);
    return text;
}

std::string salm_header() {
    std::string text;
    for (const char* ground : salm::ground_names) text += fmt::format(" {} |", ground);
    return text + "\n|---|---|---|---|---|";
}

/// Largest avalanches and longest return periods first, as in the source.
std::string salm_tables() {
    std::string text = "| xi [m/s2] |" + salm_header() + "\n";
    for (std::size_t size = salm::xi.size(); size-- > 0;) {
        text += fmt::format("| {} |", salm::size_names[size]);
        for (const salm::Altitudes& xi : salm::xi[size]) text += " " + xi_cell(xi) + " |";
        text += "\n";
    }
    text += "\n| size | return period [years] |" + salm_header() + "---|\n";
    for (std::size_t size = salm::mu.size(); size-- > 0;)
        for (std::size_t period = salm::return_periods.size(); period-- > 0;) {
            const bool first = period + 1 == salm::return_periods.size();
            text += fmt::format("| {}| {:g} |", first ? salm::size_names[size] + std::string(" ") : "",
                                salm::return_periods[period]);
            for (std::size_t ground = 0; ground < salm::ground_names.size(); ++ground) {
                const bool between = size == salm::tiny && period == salm::hundred_years && ground == salm::channelled;
                const char* const mark = between ? "*" : "";
                text += fmt::format(" {0}{1}{0} |", mark, mu_cell(salm::mu[size][period][ground]));
            }
            text += "\n";
        }
    return text;
}

std::string mud_table() {
    std::string text =
        "| Sample | a1 [Pa] | b1 | a2 [Pa s] | b2 | tau_y at Cv 0.30 / 0.40 [Pa] | eta at 0.30 / 0.40 [Pa s] |\n"
        "|---|---|---|---|---|---|---|\n";
    for (const mud::Sample& s : mud::samples) {
        const auto at = [](double a, double b, double share) { return fmt::format("{:.3g}", a * std::exp(b * share)); };
        text += fmt::format("| {} | {} | {} | {} | {} | {} / {} | {} / {} |\n", s.name, s.a1, s.b1, s.a2, s.b2,
                            at(s.a1, s.b1, 0.3), at(s.a1, s.b1, 0.4), at(s.a2, s.b2, 0.3), at(s.a2, s.b2, 0.4));
    }
    return text;
}

std::string priors_table() {
    std::string text =
        "\n## Priors of ensembles\n\nWhere `[[ensemble.vary]]` gives a key and no range, and the case its "
        "`case.kind`, these are taken; without a row,\nall values of the kind's range are as likely. It is printed. "
        "No source was read for them: they are wide, and a place to begin.\n\n| `case.kind` | Key | Bed law | "
        "Prior |\n|---|---|---|---|\n";
    for (const ParameterPrior& row : parameter_priors())
        text += fmt::format("| `{}` | `{}` | {} | {} |\n", row.kind, row.key, row.law, words_of(row, unit_of(row.key)));
    return text;
}

constexpr const char* introduction =
    R"(# Friction parameters, with their sources

Written by `frana describe --parameters`; the program reads the same tables.

**A parameter belongs to the model that it was fitted with:** how depth is measured, curvature, entrainment, numerics. What
stands here is where to begin, never a truth. Back-analyse events of your own region before you judge with them
(`frana compare`). Rows with a source were read there. A common range is what circulates in the literature. It is no
citation; look it up at its source.

`mu` is the tangent of the dry friction angle at the bed. `xi` [m/s2] is the turbulence coefficient; codes that write the drag
with `k` use k = g/xi.

## Kinds of mass

`[case] kind = "snow"` says what moves. Values outside of the kind's ranges are then remarked upon, and the density has a
default, which is remarked upon too. An ensemble has its priors. Nothing else follows from it: friction has no default. Each
key's limits are the lowest and the highest of its rows for that bed law. A single value is no limit.

)";

constexpr const char* water_notes =
    R"(
Free water is judged by these rows whatever `case.kind` is. Small streams at low stages have more: Manning's n of 0.047 to 7.95
and f of 0.29 to 12 700, in five streams of British Columbia (Reid and Hickin 2008, Earth Surf. Process. Landforms 33, 2211;
its abstract was read).
)";

constexpr const char* snow =
    R"(
## Snow: Voellmy-Salm classes

As in the raster tool of the Norwegian Geotechnical Institute (norwegian-geotechnical-institute/Avaframe-Workshop, MIT licence).
It has mu and k; xi here is 9.81/k, rounded to 50. Three values in a cell are for altitudes below 1000 m, 1000 to 1500 m, and
above 1500 m, in Switzerland; shift them to the local tree line. Volumes: tiny below 5 000, small below 25 000, medium below
60 000 m3, large above. xi does not depend on the return period.

)";

constexpr const char* snow_notes =
    R"(
mu must fall with the return period and the altitude, and xi grow with the altitude. That order showed two slips of the copy.
Tiny, 100 years, channelled is below its value for 300 years there; here it is interpolated between 30 and 300 years.
Medium, channelled, has the xi of the two higher classes exchanged for 10 and 300 years; the table has those of 30 and 100
years.

Martinelli, Lang and Mears 1980 give mu = 5/v, v in m/s, with xi of 700 to 800 m/s2.

Naaim et al. 2013, J. Glaciol. 59, 771, back-analysed 735 avalanches of the Chamonix valley. mu grows with temperature and
density, and falls with liquid water and snow depth. xi shows no trend. RAMMS recommends a cohesion of 0 to 100 Pa for dry
and 100 to 300 Pa for wet snow (ramms.ch, friction parameters); frana has no such term.

## Mud: Bingham

Yield stress and viscosity grow with the volume concentration of solids: tau_y = a1 exp(b1 Cv), eta = a2 exp(b2 Cv) (O'Brien and
Julien 1988, J. Hydraul. Eng. 114, table 2). Fitted for Cv of 0.10 to 0.45; do not go beyond.

)";

constexpr const char* mud_notes =
    R"(
The paper's table is in dyn/cm2 and poise; it is divided by 10 here. **Taking the old units as SI is a factor of 10.**

A quick check: a deposit on a slope S stops at h = tau_y / (rho g S). With 400 Pa, 1800 kg/m3 and S of 0.05 that is 0.45 m.
)";

constexpr const char* forest =
    R"(
## Forest

`forest.detrainment` is the K of Feistl et al. 2014 (J. Glaciol. 60, 124): the flow loses K/u in each second on each square metre.
10 to 150 Pa circulate, by stand; look the classes up there. com1DFA takes 5 Pa by default. Forest that brakes has friction of its
own (`[[material.zone]]`): mu + 0.02 to 0.03 and xi = 400 m/s2 are a habit of practice. Of these figures only com1DFA's was read at
its source.
)";

}  // namespace

std::string ranges_in_words(const std::string& key) {
    const RangeKey known = range_key(key);
    std::string text;
    for (const ParameterRange& row : parameter_ranges()) {
        if (row.key != known.key) continue;
        const std::string law = *row.law ? fmt::format(" with {}", row.law) : "";
        text += fmt::format("    {}{}: {}{}, {}; {}\n", *row.kind ? row.kind : "laboratory", law,
                            range_text(row.low, row.high, known.scale), unit_of(key), row.what, source_of(row));
    }
    return text.empty() ? "" : text + "    where to begin, never a truth: see cases/PARAMETERS.md\n";
}

std::string ranges_in_markdown() {
    std::string text = introduction + kinds_table();
    for (const MassKind& kind : mass_kinds()) text += ranges_of(kind.name, kind.name);
    text += ranges_of(kFreeWater, "Free water") + water_notes + ranges_of("", "Grains in the laboratory");
    text += priors_table();
    return text + snow + salm_tables() + snow_notes + mud_table() + mud_notes + forest;
}

}  // namespace frana
