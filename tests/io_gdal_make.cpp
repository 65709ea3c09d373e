#include "io_gdal_make.h"

#include <gdal_utils.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "catch.h"
#include "fresh_folder.h"

namespace {

void fill(GDALDataset& dataset, const RasterSpec& spec) {
    std::vector<double> values;
    std::vector<GByte> mask;
    for (int row = 0; row < spec.rows; ++row)
        for (int column = 0; column < spec.columns; ++column) {
            values.push_back(spec.value(column, row));
            mask.push_back(!spec.valid || spec.valid(column, row) ? 255 : 0);
        }
    const auto write = [&](GDALRasterBand& band, void* data, GDALDataType type) {
        REQUIRE(band.RasterIO(GF_Write, 0, 0, spec.columns, spec.rows, data, spec.columns, spec.rows, type, 0, 0,
                              nullptr) == CE_None);
    };
    for (int b = 1; b <= spec.bands; ++b) {
        GDALRasterBand& band = *dataset.GetRasterBand(b);
        if (spec.nodata) band.SetNoDataValue(*spec.nodata);
        if (spec.scale != 1.0 || spec.offset != 0.0) {
            band.SetScale(spec.scale);
            band.SetOffset(spec.offset);
        }
        if (!spec.unit.empty()) band.SetUnitType(spec.unit.c_str());
        if (spec.alpha && b == spec.bands) {
            band.SetColorInterpretation(GCI_AlphaBand);
            write(band, mask.data(), GDT_Byte);
        } else {
            write(band, values.data(), GDT_Float64);
        }
    }
    if (spec.valid && !spec.alpha) {
        REQUIRE(dataset.CreateMaskBand(GMF_PER_DATASET) == CE_None);
        write(*dataset.GetRasterBand(1)->GetMaskBand(), mask.data(), GDT_Byte);
    }
}

CPLStringList list_of(const std::vector<std::string>& words) {
    CPLStringList list;
    for (const std::string& word : words) list.AddString(word.c_str());
    return list;
}

void run_command(const std::vector<std::string>& words) {
    const std::string program = words.front();
    std::string source = words[words.size() - 2], target = words.back();
    if (program == "gdalbuildvrt") std::swap(source, target);
    const CPLStringList arguments = list_of({words.begin() + 1, words.end() - 2});
    GDALDatasetH input = GDALOpenEx(source.c_str(), GDAL_OF_RASTER, nullptr, nullptr, nullptr);
    REQUIRE(input != nullptr);
    GDALDatasetH output = nullptr;
    char** argv = const_cast<CPLStringList&>(arguments).List();
    if (program == "gdalwarp") {
        GDALWarpAppOptions* options = GDALWarpAppOptionsNew(argv, nullptr);
        REQUIRE(options != nullptr);
        output = GDALWarp(target.c_str(), nullptr, 1, &input, options, nullptr);
        GDALWarpAppOptionsFree(options);
    } else if (program == "gdal_translate") {
        GDALTranslateOptions* options = GDALTranslateOptionsNew(argv, nullptr);
        REQUIRE(options != nullptr);
        output = GDALTranslate(target.c_str(), input, options, nullptr);
        GDALTranslateOptionsFree(options);
    } else {
        REQUIRE(program == "gdalbuildvrt");
        GDALBuildVRTOptions* options = GDALBuildVRTOptionsNew(argv, nullptr);
        REQUIRE(options != nullptr);
        const char* names[] = {source.c_str()};
        output = GDALBuildVRT(target.c_str(), 1, nullptr, names, options, nullptr);
        GDALBuildVRTOptionsFree(options);
    }
    REQUIRE(output != nullptr);
    GDALClose(output);
    GDALClose(input);
}

}  // namespace

std::string wkt_of(const char* code) {
    OGRSpatialReference crs;
    REQUIRE(crs.SetFromUserInput(code) == OGRERR_NONE);
    char* text = nullptr;
    crs.exportToWkt(&text);
    std::string wkt(text);
    CPLFree(text);
    return wkt;
}

void make_raster(const std::filesystem::path& file, const RasterSpec& spec) {
    GDALAllRegister();
    GDALDriver* wanted = GetGDALDriverManager()->GetDriverByName(spec.driver.c_str());
    REQUIRE(wanted != nullptr);
    const bool creates = wanted->GetMetadataItem(GDAL_DCAP_CREATE) != nullptr;
    GDALDriver* maker = creates ? wanted : GetGDALDriverManager()->GetDriverByName("MEM");
    CPLStringList options = list_of(spec.options), none;
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    GDALDataset* made = maker->Create(creates ? file.c_str() : "", spec.columns, spec.rows, spec.bands, spec.type,
                                      creates ? options.List() : none.List());
    REQUIRE(made != nullptr);
    std::array<double, 6> transform = spec.transform;
    if (transform[1] != 0.0) made->SetGeoTransform(transform.data());
    if (!spec.crs.empty()) {
        OGRSpatialReference crs;
        REQUIRE(crs.SetFromUserInput(spec.crs.c_str()) == OGRERR_NONE);
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        made->SetSpatialRef(&crs);
    }
    fill(*made, spec);
    if (!creates) {
        GDALDataset* copy = wanted->CreateCopy(file.c_str(), made, FALSE, options.List(), nullptr, nullptr);
        REQUIRE(copy != nullptr);
        GDALClose(copy);
    }
    GDALClose(made);
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
}

void run_gdal_line(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) {
        if (word != "&&") {
            words.push_back(word);
            continue;
        }
        run_command(words);
        words.clear();
    }
    run_command(words);
}

std::string cure_in(const std::string& message) {
    const auto start = message.rfind("run: gdal");
    REQUIRE(start != std::string::npos);
    const std::string line = message.substr(start + 5);
    return line.substr(0, line.find(" ("));
}

std::string user_error(const std::function<void()>& act) {
    try {
        act();
    } catch (const frana::UserError& error) {
        return error.what();
    }
    FAIL("nothing was refused");
    return {};
}

std::string heard_on_stderr(const std::function<void()>& act) {
    const FreshFolder folder;
    const std::filesystem::path file = folder.path() / "stderr.txt";
    std::fflush(stderr);
    const int saved = ::dup(2);
    std::FILE* caught = std::fopen(file.c_str(), "w");
    REQUIRE(caught != nullptr);
    ::dup2(::fileno(caught), 2);
    act();
    std::fflush(stderr);
    ::dup2(saved, 2);
    ::close(saved);
    std::fclose(caught);
    return text_of(file);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool any_contains(const std::vector<std::string>& lines, const std::string& part) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) { return contains(line, part); });
}
