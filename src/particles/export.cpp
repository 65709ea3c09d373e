#include "particles/export.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "particles/bed_points.h"

namespace frana {

namespace {

/// Text written piece by piece through a buffer, to appear as a whole.
class TextFile {
public:
    explicit TextFile(const std::filesystem::path& target)
        : target_(target), file_(target), stream_(file_.path(), std::ios::binary) {}

    template <class... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(buffer_), format, std::forward<Values>(values)...);
        if (buffer_.size() > std::size_t{1} << 20) flush();
    }
    void commit() {
        flush();
        stream_.close();
        if (!stream_)
            throw UserError(fmt::format(
                "{}: cannot be written; check that the folder exists, its permissions and free space",
                target_.string()));
        file_.commit();
    }

private:
    void flush() {
        stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        buffer_.clear();
    }
    std::filesystem::path target_;
    AtomicFile file_;
    std::ofstream stream_;
    fmt::memory_buffer buffer_;
};

std::string json_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            quoted += {'\\', c};
        else if (static_cast<unsigned char>(c) < 0x20)
            quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            quoted += c;
    }
    return quoted + '"';
}

std::vector<double> interleaved(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> pairs(2 * a.size());
    for (std::size_t p = 0; p < a.size(); ++p) {
        pairs[2 * p] = a[p];
        pairs[2 * p + 1] = b[p];
    }
    return pairs;
}

std::vector<double> masses(const SeedsExport& data) {
    std::vector<double> mass(data.seeds.volume);
    for (double& m : mass) m *= data.density;
    return mass;
}

}  // namespace

SeedsExport make_seeds_export(const Seeds& seeds, double density, const Raster& bed) {
    SeedsExport data{seeds, density, bed.crs_wkt, {}};
    data.elevation.reserve(seeds.x.size());
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        data.elevation.push_back(bed_elevation(bed, seeds.x[p], seeds.y[p]));
        if (!std::isfinite(data.elevation.back()))
            throw UserError(fmt::format(
                "particle {} at x = {:.2f}, y = {:.2f} stands outside the elevation model {} or on "
                "its nodata; move the release",
                p, seeds.x[p], seeds.y[p], bed.source));
    }
    return data;
}

std::vector<SeedsColumn> seeds_columns(const SeedsExport& data) {
    const Seeds& seeds = data.seeds;
    std::vector<SeedsColumn> columns{
        {"position", "m", 2, interleaved(seeds.x, seeds.y)},
        {"velocity", "m/s", 2, interleaved(seeds.vx, seeds.vy)},
        {"elevation", "m", 1, data.elevation},
        {"depth", "m", 1, seeds.depth},
        {"size", "m", 1, seeds.size},
        {"volume", "m3", 1, seeds.volume},
        {"mass", "kg", 1, masses(data)},
    };
    for (const SeedsColumn& column : columns) {
        expect(column.values.size() == column.components * seeds.x.size(), "seed columns have equal lengths");
        for (const double value : column.values) expect(std::isfinite(value), "seeds are finite numbers");
    }
    return columns;
}

void write_seeds_csv(const std::filesystem::path& file, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    const auto value = [&](std::size_t c, std::size_t k) { return columns[c].values[k]; };
    TextFile text(file);
    text.put("id,x,y,elevation,depth,size,vx,vy,volume,mass\n");
    for (std::size_t p = 0; p < data.seeds.x.size(); ++p)
        text.put("{},{},{},{},{},{},{},{},{},{}\n", p, value(0, 2 * p), value(0, 2 * p + 1), value(2, p),
                 value(3, p), value(4, p), value(1, 2 * p), value(1, 2 * p + 1), value(5, p), value(6, p));
    text.commit();
}

void write_seeds_json(const std::filesystem::path& file, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    const std::size_t count = data.seeds.x.size();
    TextFile text(file);
    text.put("{{\n\"format\": \"frana particles 1\",\n\"count\": {},\n\"density\": {},\n\"crs_wkt\": {},\n",
             count, data.density, json_text(data.crs_wkt));
    text.put("\"units\": {{\"density\": \"kg/m3\"");
    for (const SeedsColumn& column : columns) text.put(", \"{}\": \"{}\"", column.name, column.unit);
    text.put("}},\n\"id\": [");
    for (std::size_t p = 0; p < count; ++p) text.put("{}{}", p ? "," : "", p);
    text.put("]");
    for (const SeedsColumn& column : columns) {
        text.put(",\n\"{}\": [", column.name);
        for (std::size_t p = 0; p < count; ++p)
            if (column.components == 2)
                text.put("{}[{},{}]", p ? "," : "", column.values[2 * p], column.values[2 * p + 1]);
            else
                text.put("{}{}", p ? "," : "", column.values[p]);
        text.put("]");
    }
    text.put("\n}}\n");
    text.commit();
}

}  // namespace frana
