#pragma once
// A Kratos .mdpa body read back as Kratos reads it: blocks of words, comments dropped, hexahedra to centroids and
// volumes.
#include <array>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "catch.h"
#include "fresh_folder.h"

namespace test {

struct Mdpa {
    std::map<long, std::array<double, 3>> nodes;
    std::map<long, std::array<long, 8>> elements;
    std::map<long, std::array<double, 3>> velocities;
    std::string element_name, part;
    std::vector<long> part_nodes, part_elements;

    /// Corner c of an element.
    const std::array<double, 3>& corner(long element, std::size_t c) const { return nodes.at(elements.at(element)[c]); }
    std::array<double, 3> centroid(long element) const {
        std::array<double, 3> middle{};
        for (std::size_t c = 0; c < 8; ++c)
            for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += corner(element, c)[axis] / 8.0;
        return middle;
    }
    /// Eight times the Jacobian at the middle, as one Gauss point has it; negative when the corners go the wrong way.
    double volume(long element) const {
        const double signs[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                    {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
        double j[3][3] = {};
        for (std::size_t c = 0; c < 8; ++c)
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) j[a][b] += signs[c][b] * corner(element, c)[a] / 8.0;
        return 8.0 *
               (j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
                j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]));
    }
};

/// Lines of a block up to its "End NAME".
inline std::vector<std::string> mdpa_block(std::istream& in, const std::string& name) {
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string first, second;
        words >> first >> second;
        if (first == "End") {
            REQUIRE(second == name);
            return lines;
        }
        lines.push_back(line);
    }
    FAIL("block " << name << " does not end");
    return lines;
}

inline void read_mdpa_part(std::istream& in, Mdpa& mdpa) {
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string first, name;
        words >> first >> name;
        if (first == "End") return;
        for (const std::string& id : mdpa_block(in, name))
            (name == "SubModelPartNodes" ? mdpa.part_nodes : mdpa.part_elements).push_back(std::stol(id));
    }
}

inline Mdpa read_mdpa(const std::filesystem::path& file) {
    Mdpa mdpa;
    std::istringstream in(text_of(file));
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line.rfind("//", 0) == 0) continue;
        std::istringstream words(line);
        std::string begin, name, rest;
        words >> begin >> name >> rest;
        REQUIRE(begin == "Begin");
        if (name == "SubModelPart") {
            mdpa.part = rest;
            read_mdpa_part(in, mdpa);
            continue;
        }
        if (name == "Elements") mdpa.element_name = rest;
        for (const std::string& text : mdpa_block(in, name)) {
            std::istringstream values(text);
            long id = 0, property = 0;
            values >> id;
            if (name == "Nodes") {
                for (double& x : mdpa.nodes[id]) REQUIRE(values >> x);
            } else if (name == "Elements") {
                REQUIRE(values >> property);
                for (long& node : mdpa.elements[id]) REQUIRE(values >> node);
            } else if (name == "ElementalData") {
                REQUIRE(rest == "MP_VELOCITY");
                auto& v = mdpa.velocities[id];
                REQUIRE(std::sscanf(text.c_str(), "%ld [3] (%lf,%lf,%lf)", &id, &v[0], &v[1], &v[2]) == 4);
            }
        }
    }
    return mdpa;
}

}  // namespace test
