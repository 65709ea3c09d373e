#include "base/point_table.h"

#include <cmath>

#include "base/error.h"
#include "base/text_file.h"

namespace frana {
namespace {

/// A point's numbers of a column, between commas.
void put_numbers(TextFile& text, const PointColumn& column, std::size_t point) {
    const double* values = column.values + point * column.components();
    for (std::size_t c = 0; c < column.components(); ++c) text.put("{}{}", c ? "," : "", values[c]);
}

}  // namespace

void require_finite(const PointTable& table) {
    for (const PointConstant& constant : table.constants)
        expect(std::isfinite(constant.value), "what is exported is finite numbers");
    for (const PointColumn& column : table.columns)
        for (std::size_t k = 0; k < table.count * column.components(); ++k)
            expect(std::isfinite(column.values[k]), "what is exported is finite numbers");
}

void write_points_csv(const std::filesystem::path& file, const PointTable& table) {
    require_finite(table);
    TextFile text(file);
    text.put("id");
    for (const PointColumn& column : table.columns)
        for (const std::string& head : column.heads) text.put(",{}", head);
    text.put("\n");
    for (std::size_t p = 0; p < table.count; ++p) {
        text.put("{}", p);
        for (const PointColumn& column : table.columns) {
            text.put(",");
            put_numbers(text, column, p);
        }
        text.put("\n");
    }
    text.commit();
}

void write_points_json(const std::filesystem::path& file, const PointTable& table) {
    require_finite(table);
    TextFile text(file);
    text.put("{{\n\"format\": {},\n\"count\": {},\n", json_text(table.format), table.count);
    for (const PointConstant& constant : table.constants) text.put("\"{}\": {},\n", constant.name, constant.value);
    text.put("\"crs_wkt\": {},\n", json_text(table.crs_wkt));
    for (const auto& [name, value] : table.texts) text.put("\"{}\": {},\n", name, json_text(value));
    text.put("\"units\": {{");
    const char* comma = "";
    for (const PointConstant& constant : table.constants) {
        text.put("{}\"{}\": \"{}\"", comma, constant.name, constant.unit);
        comma = ", ";
    }
    for (const PointColumn& column : table.columns) {
        text.put("{}\"{}\": \"{}\"", comma, column.name, column.unit);
        comma = ", ";
    }
    text.put("}},\n\"id\": [");
    for (std::size_t p = 0; p < table.count; ++p) text.put("{}{}", p ? "," : "", p);
    text.put("]");
    for (const PointColumn& column : table.columns) {
        const bool several = column.components() > 1;
        text.put(",\n\"{}\": [", column.name);
        for (std::size_t p = 0; p < table.count; ++p) {
            text.put("{}{}", p ? "," : "", several ? "[" : "");
            put_numbers(text, column, p);
            if (several) text.put("]");
        }
        text.put("]");
    }
    text.put("\n}}\n");
    text.commit();
}

}  // namespace frana
