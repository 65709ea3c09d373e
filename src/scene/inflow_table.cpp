#include "scene/inflow_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/number_text.h"
#include "base/text_file.h"

namespace frana {
namespace {

/// A way from volume to peak discharge, a V^b (Mizuyama et al. 1992, granular and muddy flows; Rickenmann 1999).
struct Formula {
    const char* name;
    double factor, exponent;
};
constexpr Formula kFormulas[] = {
    {"mizuyama-granular", 0.135, 0.780}, {"mizuyama-muddy", 0.0188, 0.790}, {"rickenmann", 0.1, 0.833}};

constexpr double kRise = 0.1;  ///< of a triangle's time, until it is highest

const char* const kHeader =
    "expected a header such as \"t [s], discharge [m3/s]\" or \"t_min, discharge [m3/s], velocity [m/s]\"";

std::string without_quotes(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\"");
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r\"") + 1 - begin);
}

/// Cells of a line; blanks part them only where no comma or semicolon does. Behind a last mark stands an empty one.
std::vector<std::string> cells_of(const std::string& line) {
    const char mark = line.find(';') != std::string::npos ? ';' : line.find(',') != std::string::npos ? ',' : ' ';
    std::vector<std::string> cells;
    std::istringstream stream(line);
    std::string cell;
    while (mark == ' ' ? bool(stream >> cell) : bool(std::getline(stream, cell, mark)))
        cells.push_back(without_quotes(cell));
    if (mark != ' ' && !line.empty() && line[line.find_last_not_of(" \t\r")] == mark) cells.emplace_back();
    return cells;
}

/// Headings of a line whose cells blanks part have their units behind them: "t [s] discharge [m3/s]".
std::vector<std::string> headings_of(const std::string& line) {
    std::vector<std::string> cells = cells_of(line), joined;
    for (const std::string& cell : cells)
        if (!joined.empty() && cell.rfind('[', 0) == 0)
            joined.back() += " " + cell;
        else
            joined.push_back(cell);
    return joined;
}

/// A column: what it holds, and how much of the unit of this program one of its own is.
struct Column {
    enum class What { time, discharge, velocity } what;
    double unit;
};

Column column_of(const std::string& heading, const std::string& source) {
    const std::size_t bracket = heading.find('[');
    const std::string name = without_quotes(heading.substr(0, bracket));
    const std::string unit = bracket == std::string::npos
                                 ? ""
                                 : without_quotes(heading.substr(bracket + 1, heading.find(']') - bracket - 1));
    const bool time = name == "t" || name == "time";
    if (name == "t_min" || (time && unit == "min")) return {Column::What::time, 60.0};
    if (name == "t_h" || (time && unit == "h")) return {Column::What::time, 3600.0};
    if (name == "t_s" || (time && unit == "s")) return {Column::What::time, 1.0};
    const bool cubic = unit == "m3/s" || unit == "m^3/s";
    if ((name == "discharge" || name == "Q" || name == "q") && cubic) return {Column::What::discharge, 1.0};
    if ((name == "velocity" || name == "speed" || name == "v") && unit == "m/s") return {Column::What::velocity, 1.0};
    throw UserError(fmt::format("{}: found the column \"{}\"; {}; name column and unit in the first line", source,
                                heading, kHeader));
}

bool is_number(const std::string& cell) { return number_in(cell).has_value(); }

/// t, Q, v, Q, v, ... without a unit: numbers already, or their names.
bool is_of_avaflow(const std::vector<std::string>& cells) {
    if (cells.size() % 2 == 0 || cells.size() < 3 || cells.size() > 7) return false;
    if (std::all_of(cells.begin(), cells.end(), is_number)) return true;
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const char wanted = k == 0 ? 't' : k % 2 == 1 ? 'q' : 'v';
        const bool named = cells[k].find_first_not_of("tTqQvV123") == std::string::npos && !cells[k].empty();
        if (!named || std::tolower(static_cast<unsigned char>(cells[k][0])) != wanted) return false;
    }
    return true;
}

double number_of(const std::string& cell, const std::string& source, Index line) {
    const std::optional<double> value = number_in(cell);
    if (cell.empty())
        throw UserError(fmt::format("{}:{}: found a gap; expected a number in each column; fill it, or remove the row",
                                    source, line));
    if (!value || !std::isfinite(*value))
        throw UserError(
            fmt::format("{}:{}: found \"{}\"; expected a number in each column; fill the gap", source, line, cell));
    return *value;
}

void require_valid(const Hydrograph& table, const std::string& source) {
    const auto line = [&](std::size_t n) {
        return fmt::format("{}: row {} (t = {:.6g} s)", source, n + 1, table.time[n]);
    };
    if (table.time.size() < 2)
        throw UserError(
            fmt::format("{}: found {} row{}; expected two or more, since discharge is linear between them; add rows",
                        source, table.time.size(), table.time.size() == 1 ? "" : "s"));
    for (std::size_t n = 0; n < table.time.size(); ++n) {
        if (table.time[n] < 0.0)
            throw UserError(line(n) +
                            ": found a time before 0; expected times of the run, which begins at 0; shift them");
        if (n > 0 && !(table.time[n] > table.time[n - 1]))
            throw UserError(
                fmt::format("{}: found a time that is not later than {:.6g} s of the row above; expected times that "
                            "grow; sort the rows",
                            line(n), table.time[n - 1]));
        if (table.discharge[n] < 0.0)
            throw UserError(
                fmt::format("{}: found a discharge of {:.6g} m3/s; expected 0 or more; nothing can flow back "
                            "through an inflow",
                            line(n), table.discharge[n]));
        if (!table.velocity.empty() &&
            (table.velocity[n] < 0.0 || (table.velocity[n] == 0.0 && table.discharge[n] > 0.0)))
            throw UserError(
                fmt::format("{}: found a velocity of {:.6g} m/s with {:.6g} m3/s; expected one above 0 where "
                            "something flows; correct it",
                            line(n), table.velocity[n], table.discharge[n]));
    }
    if (!(table.volume() > 0.0))
        throw UserError(source + ": found no discharge above 0; expected some; correct the table");
}

/// The lines of a text that say something.
class Lines {
public:
    explicit Lines(const std::string& text) : stream_(text) {}
    bool next() {
        while (std::getline(stream_, line_)) {
            ++number_;
            if (!without_quotes(line_).empty() && without_quotes(line_)[0] != '#') return true;
        }
        return false;
    }
    const std::string& line() const { return line_; }
    Index number() const { return number_; }
    /// As many cells as there are columns.
    std::vector<std::string> cells(std::size_t columns, const std::string& source) const {
        std::vector<std::string> cells = cells_of(line_);
        if (cells.size() == columns) return cells;
        const bool gap = cells.size() < columns;
        throw UserError(fmt::format("{}:{}: found {}, \"{}\"; expected {} columns as in the first line; {}", source,
                                    number_, gap ? "a gap" : fmt::format("{} columns", cells.size()),
                                    without_quotes(line_), columns,
                                    gap ? "fill it, or remove the row" : "correct the row"));
    }

private:
    std::istringstream stream_;
    std::string line_;
    Index number_ = 0;
};

/// A row of r.avaflow: what flows together, at the mean of its speed.
void add_phases(const std::vector<double>& row, Hydrograph& table) {
    double sum = 0.0, product = 0.0, fastest = 0.0;
    for (std::size_t k = 1; k + 1 < row.size(); k += 2) {
        sum += row[k], product += row[k] * row[k + 1];
        fastest = std::max(fastest, row[k + 1]);
    }
    table.time.push_back(row[0]);
    table.discharge.push_back(sum);
    table.velocity.push_back(sum > 0.0 ? product / sum : fastest);
}

/// All rows, from the first line on.
Hydrograph rows_of_avaflow(Lines& lines, const std::string& source) {
    const std::size_t columns = cells_of(lines.line()).size();
    Hydrograph table;
    for (bool more = is_number(cells_of(lines.line())[0]) || lines.next(); more; more = lines.next()) {
        std::vector<double> row;
        for (const std::string& cell : lines.cells(columns, source))
            row.push_back(number_of(cell, source, lines.number()));
        for (std::size_t k = 1; k < columns; k += 2)
            if (row[k] < 0.0 || row[k + 1] < 0.0)
                throw UserError(
                    fmt::format("{}:{}: found {:.6g}; expected discharges and velocities of 0 or more; nothing can "
                                "flow back through an inflow",
                                source, lines.number(), std::min(row[k], row[k + 1])));
        add_phases(row, table);
    }
    table.remark = fmt::format("{}: taken for rows of r.avaflow, t [s] and Q [m3/s], v [m/s] of {} phase{}", source,
                               columns / 2, columns > 3 ? "s, which come in as one: their discharges are summed" : "");
    return table;
}

/// The rows behind a header that names columns and units.
Hydrograph rows_with_units(Lines& lines, const std::string& source) {
    std::vector<Column> columns;
    std::array<int, 3> found{};
    for (const std::string& heading : headings_of(lines.line())) {
        columns.push_back(column_of(heading, source));
        ++found[static_cast<std::size_t>(columns.back().what)];
    }
    if (found[0] != 1 || found[1] != 1 || found[2] > 1)
        throw UserError(
            fmt::format("{}: found {} columns of time, {} of discharge and {} of velocity; {}; correct the header",
                        source, found[0], found[1], found[2], kHeader));
    Hydrograph table;
    while (lines.next()) {
        const std::vector<std::string> cells = lines.cells(columns.size(), source);
        for (std::size_t k = 0; k < cells.size(); ++k) {
            const double value = columns[k].unit * number_of(cells[k], source, lines.number());
            (columns[k].what == Column::What::time        ? table.time
             : columns[k].what == Column::What::discharge ? table.discharge
                                                          : table.velocity)
                .push_back(value);
        }
    }
    return table;
}

}  // namespace

double Hydrograph::volume() const {
    double sum = 0.0;
    for (std::size_t n = 0; n + 1 < time.size(); ++n)
        sum += 0.5 * (time[n + 1] - time[n]) * (discharge[n] + discharge[n + 1]);
    return sum;
}

Hydrograph parse_hydrograph(const std::string& text, const std::string& source) {
    Lines lines(text);
    if (!lines.next()) throw UserError(fmt::format("{}: found an empty file; {}; fill it", source, kHeader));
    const bool avaflow = is_of_avaflow(cells_of(lines.line()));
    Hydrograph table = avaflow ? rows_of_avaflow(lines, source) : rows_with_units(lines, source);
    require_valid(table, source);
    return table;
}

Hydrograph read_hydrograph(const std::filesystem::path& file) {
    const std::optional<std::string> text = text_in_file(file);
    if (!text) throw UserError(file.string() + ": found no file that can be read; expected a table; check its name");
    return parse_hydrograph(*text, file.string());
}

const std::vector<std::string>& peak_formulas() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Formula& formula : kFormulas) all.emplace_back(formula.name);
        return all;
    }();
    return names;
}

double peak_discharge(const std::string& formula, double volume) {
    for (const Formula& known : kFormulas)
        if (formula == known.name) return known.factor * std::pow(volume, known.exponent);
    throw InternalError("unknown formula of a peak discharge");
}

Hydrograph triangle(double volume, double peak, double at, std::optional<double> rise) {
    const double whole = 2.0 * volume / peak;
    return {{at, at + rise.value_or(kRise * whole), at + whole}, {0.0, peak, 0.0}, {}};
}

}  // namespace frana
