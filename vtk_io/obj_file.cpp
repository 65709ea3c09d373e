#include "vtk_io/obj_file.h"

#include <fmt/core.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/number_text.h"

namespace frana {
namespace {

/// Where a line stands, for messages.
struct Place {
    const std::filesystem::path& file;
    int line = 0;
    [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
        throw UserError(fmt::format("{}:{}: {}; expected {}: write the mesh again from the program that made it",
                                    file.string(), line, found, expected));
    }
};

/// "v 1.5 2 -3"
void add_point(const Place& place, std::istringstream& words, vtkPoints* points) {
    std::array<double, 3> x{};
    std::string word;
    for (double& coordinate : x) {
        if (!(words >> word)) place.refuse("found a point without three coordinates", "three numbers in metres");
        const auto number = number_in(word);
        if (!number) place.refuse(fmt::format("found \"{}\" in a point", word), "three numbers in metres");
        coordinate = *number;
    }
    points->InsertNextPoint(x.data());
}

/// "f 1 2 3" or "f 1/4/2 2/5/2 -1/6/2": of each corner the first number is its point, from 1. A number below zero
/// counts from the last one. Whether there is such a point is seen when all are read: files may give faces first.
void add_face(const Place& place, std::istringstream& words, vtkIdType points, vtkCellArray* faces) {
    std::vector<vtkIdType> corners;
    for (std::string word; words >> word;) {
        long long number = 0;
        const char* const end = word.data() + word.size();
        const auto [rest, fault] = std::from_chars(word.data(), end, number);
        if (fault != std::errc() || (rest != end && *rest != '/') || number == 0)
            place.refuse(fmt::format("found \"{}\" in a face", word), "numbers of points, from 1");
        corners.push_back(number > 0 ? number - 1 : points + number);
    }
    if (corners.size() < 3) place.refuse(fmt::format("found a face of {} points", corners.size()), "at least three");
    faces->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
}

}  // namespace

vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw UserError(file.string() + ": cannot be read; expected a mesh: check its permissions");
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> faces;
    Place place{file};
    for (std::string line, more; std::getline(stream, line);) {
        ++place.line;
        while (!line.empty() && line.back() == '\r') line.pop_back();
        for (; !line.empty() && line.back() == '\\' && std::getline(stream, more); ++place.line) {
            line.back() = ' ';
            line += more;
            while (!line.empty() && line.back() == '\r') line.pop_back();
        }
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") add_point(place, words, points);
        if (kind == "f") add_face(place, words, points->GetNumberOfPoints(), faces);
    }
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->SetPolys(faces);
    return mesh;
}

}  // namespace frana
