// `frana convert` as a person calls it: every format read back by libraries that are not ours, and every refusal.
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>

#include <nlohmann/json.hpp>

#include "catch.h"
#include "convert_run.h"
#include "read_mdpa.h"
#include "read_polydata.h"

namespace fs = std::filesystem;
using Catch::Contains;
using namespace convert_run;

namespace {

Numbers numbers_of(vtkDataArray* array) {
    REQUIRE(array);
    Numbers numbers;
    for (vtkIdType k = 0; k < array->GetNumberOfTuples(); ++k)
        for (int c = 0; c < array->GetNumberOfComponents(); ++c) numbers.push_back(array->GetComponent(k, c));
    return numbers;
}

/// The run's own particles of a frame, as VTK reads them.
Numbers run_particles(int frame, const char* name) {
    const auto cloud =
        test::polydata(finished_run().folder() / fmt::format("out/particles/particles_{:06d}.vtp", frame));
    return numbers_of(std::string(name) == "position" ? cloud->GetPoints()->GetData()
                                                      : cloud->GetPointData()->GetArray(name));
}

}  // namespace

TEST_CASE("HDF5 holds the points that the run's particles make, with pressure, stress and conservation", "[convert]") {
    const fs::path file = convert("points.h5", "--time 1 --spacing 0.25 --profile parabolic");
    const Numbers x = run_particles(2, "position"), h = run_particles(2, "depth"), v = run_particles(2, "velocity");
    const Numbers m = run_particles(2, "mass"), p = run_particles(2, "pressure"), s = run_particles(2, "stress");
    const Numbers position = hdf5_numbers(file, "position"), velocity = hdf5_numbers(file, "velocity");
    const Numbers mass = hdf5_numbers(file, "mass"), pressure = hdf5_numbers(file, "pressure");
    const Numbers stress = hdf5_numbers(file, "stress"), column = hdf5_numbers(file, "column");
    std::size_t k = 0;
    for (std::size_t c = 0; c < h.size(); ++c) {
        const auto layers = static_cast<std::size_t>(std::max(1.0, std::floor(h[c] / 0.25 * (1 + 1e-7))));
        double mean = 0.0;
        for (std::size_t i = 0; i < layers; ++i) {
            const double height = (static_cast<double>(i) + 0.5) / static_cast<double>(layers);
            mean += 1.5 * height * (2.0 - height) / static_cast<double>(layers);
        }
        for (std::size_t i = 0; i < layers; ++i, ++k) {
            REQUIRE(k < mass.size());
            const double height = (static_cast<double>(i) + 0.5) / static_cast<double>(layers);
            const double speed = 1.5 * height * (2.0 - height) / mean;
            CHECK(position[3 * k] == x[3 * c]);
            CHECK(position[3 * k + 1] == x[3 * c + 1]);
            CHECK(position[3 * k + 2] == Approx(x[3 * c + 2] - h[c] * (1.0 - height)).epsilon(1e-14));
            CHECK(velocity[3 * k] == Approx(v[3 * c] * speed).epsilon(1e-13));
            CHECK(velocity[3 * k + 1] == Approx(v[3 * c + 1] * speed).epsilon(1e-13));
            // The plane falls 0.1; its elevations near 100 m are floats of 7.6e-6 m, 5 m apart.
            CHECK(velocity[3 * k + 2] == Approx(-0.1 * v[3 * c] * speed).margin(4e-6 * std::abs(v[3 * c]) + 1e-12));
            CHECK(mass[k] == Approx(m[c] / static_cast<double>(layers)).epsilon(1e-14));
            CHECK(pressure[k] == Approx(p[c] * (1.0 - height)).epsilon(1e-13).margin(1e-12));
            CHECK(stress[6 * k] == Approx(s[3 * c] - pressure[k]).margin(1e-9));
            CHECK(stress[6 * k + 3] == s[3 * c + 2]);
            CHECK(stress[6 * k] + stress[6 * k + 1] + stress[6 * k + 2] == Approx(-3.0 * pressure[k]).margin(1e-9));
            CHECK(column[k] == run_particles(2, "id")[c]);
        }
    }
    CHECK(k == mass.size());
    CHECK(k > 2 * h.size());
    CHECK(hdf5_numbers(file, "time", true) == Numbers{1.0});
    CHECK(hdf5_numbers(file, "spacing", true) == Numbers{0.25});

    const auto record = nlohmann::json::parse(text_of(finished_run().folder() / "points.h5.conservation.json"));
    for (const char* name : {"mass", "volume", "momentum_x", "momentum_y"}) {
        CHECK(record["conservation"][name]["relative_error"].get<double>() <= 1e-12);
        CHECK(record["conservation"][name]["worst_column"].get<double>() <= 1e-12);
    }
    CHECK(record["conservation"]["mass"]["columns"].get<double>() == Approx(sum(m)).epsilon(1e-12));
    CHECK(record["conservation"]["points"] == k);
    CHECK(record["conservation"]["kinetic_energy"]["exact_factor"] == 1.2);
    CHECK(record["profile"] == "parabolic");
}

TEST_CASE("VTP, JSON and CSV hold the same numbers as HDF5, to the last bit", "[convert]") {
    const fs::path h5 = convert("same.h5");
    const auto cloud = test::polydata(convert("same.vtp"));
    const auto json = nlohmann::json::parse(text_of(convert("same.json")));
    const Numbers position = hdf5_numbers(h5, "position");
    CHECK(numbers_of(cloud->GetPoints()->GetData()) == position);
    CHECK(cloud->GetNumberOfVerts() * 3 == static_cast<vtkIdType>(position.size()));
    const std::map<const char*, const char*> units{{"velocity", "m/s"}, {"mass", "kg"},   {"volume", "m3"},
                                                   {"pressure", "Pa"},  {"stress", "Pa"}, {"height", "m"},
                                                   {"column", "1"}};
    for (const auto& [name, unit] : units) {
        INFO(name);
        const Numbers numbers = hdf5_numbers(h5, name);
        CHECK(numbers_of(cloud->GetPointData()->GetArray(name)) == numbers);
        CHECK(json["units"][name] == unit);
        auto* text = vtkStringArray::SafeDownCast(
            cloud->GetFieldData()->GetAbstractArray((std::string(name) + "_unit").c_str()));
        REQUIRE(text);
        CHECK(text->GetValue(0) == unit);
        Numbers flat;
        for (const auto& row : json[name])
            if (row.is_array())
                for (const auto& number : row) flat.push_back(number.get<double>());
            else
                flat.push_back(row.get<double>());
        CHECK(flat == numbers);
    }
    std::istringstream csv(text_of(convert("same.csv")));
    std::string line;
    std::getline(csv, line);
    CHECK(line == "id,x,y,z,vx,vy,vz,mass,volume,pressure,sxx,syy,szz,sxy,syz,sxz,height,column");
    const Numbers stress = hdf5_numbers(h5, "stress");
    std::size_t k = 0;
    for (; std::getline(csv, line); ++k) {
        Numbers row;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::strtod(cell.c_str(), nullptr));
        REQUIRE(row.size() == 18);
        CHECK(row[0] == static_cast<double>(k));
        CHECK(row[3] == position[3 * k + 2]);
        CHECK(row[10] == stress[6 * k]);
    }
    CHECK(3 * k == position.size());
}

TEST_CASE("A Kratos body of a run has its volume, and the material its density and viscosity", "[convert]") {
    const fs::path file = convert("flow_Body.mdpa");
    const test::Mdpa body = test::read_mdpa(file);
    double volume = 0.0;
    for (const auto& element : body.elements) volume += body.volume(element.first);
    CHECK(volume == Approx(sum(run_particles(2, "volume"))).epsilon(1e-11));  // coordinates of 100 m
    const auto json = nlohmann::json::parse(text_of(finished_run().folder() / "ParticleMaterials.json"));
    const auto& variables = json["properties"][0]["Material"]["Variables"];
    CHECK(variables["DENSITY"].get<double>() == Approx(1300.0).epsilon(1e-12));
    CHECK(variables["DYNAMIC_VISCOSITY"] == 40.0);
    CHECK(variables["BULK_MODULUS"].get<double>() >= 1300.0 * 100.0 * 9.81);  // a metre of depth at least
    CHECK(fs::exists(finished_run().folder() / "flow_Body.mdpa.conservation.json"));
}

TEST_CASE("A run without VTK files, and one that has not ended, give the same points from run.h5", "[convert]") {
    const std::string of_vtk = text_of(convert("vtk.csv"));
    fs::copy(finished_run().folder() / "out", finished_run().folder() / "only_h5", fs::copy_options::recursive);
    for (const char* name : {"particles.pvd", "terrain.vti", "grid.pvd", "run.json", "report.md", "rasters"})
        fs::remove_all(finished_run().folder() / "only_h5" / name);
    const Outcome outcome = finished_run().frana("convert only_h5 --time 1 --spacing 0.25 --out h5.csv");
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(text_of(finished_run().folder() / "h5.csv") == of_vtk);
    CHECK(
        refused("only_h5 --time 7 --spacing 0.25 --out h5.csv").err ==
        "--time 7: is past the last frame of only_h5/run.h5; expected 0 to 2 s; give a time of the run, or let the run "
        "go further\n");
}

TEST_CASE("The nearest frame is taken, and said; a window takes its particles only", "[convert]") {
    const Outcome near = finished_run().frana("convert out --time 1.3 --spacing 0.5 --out near.csv");
    CHECK(near.code == 0);
    CHECK_THAT(near.out, Contains("no frame at 1.3 s; the nearest, at 1.5 s, is taken\n") && Contains("mass [kg]"));
    const Outcome there = finished_run().frana("convert out --time 1.5 --spacing 0.5 --out there.csv");
    CHECK_THAT(there.out, !Contains("nearest"));
    CHECK(text_of(finished_run().folder() / "near.csv") == text_of(finished_run().folder() / "there.csv"));

    const Numbers x = run_particles(0, "position");
    int inside = 0;
    for (std::size_t k = 0; k < x.size(); k += 3) inside += x[k] <= 40.0 && x[k + 1] >= 50.0;
    const Numbers column = hdf5_numbers(convert("w.h5", "--time 0 --spacing 9 --window -5,50,40,1e3"), "column");
    CHECK(inside > 0);
    CHECK(static_cast<int>(column.size()) == inside);  // one layer each
}

TEST_CASE("Without depth and mass in its frames a run is refused, and the fields are named", "[convert]") {
    const PlaneCase scene;
    scene.write("[output]\nfields = [\"velocity\", \"volume\", \"pressure\"]\nformats = [\"vtk\"]\n");
    REQUIRE(scene.frana("run CASE --out out --quiet --until 0.1").code == 0);
    const Outcome outcome = scene.frana("convert out --time 0 --spacing 1 --out a.h5");
    CHECK(outcome.code == 2);
    CHECK(outcome.err ==
          "out/particles.pvd: its particles have no depth, mass; expected position, depth, velocity, mass, "
          "volume and pressure; add them to output.fields and run the case again\n");
    CHECK_FALSE(fs::exists(scene.folder() / "a.h5"));
}

TEST_CASE("What cannot be converted is refused with one sentence, and no file appears", "[convert]") {
    const std::string rest = " --time 1 --spacing 0.25 --out bad.h5";
    CHECK(refused("out --time 2.5 --spacing 0.25 --out bad.h5").err ==
          "--time 2.5: is past the last frame of out/particles.pvd; expected 0 to 2 s; give a time of the run, or let "
          "the "
          "run go further\n");
    CHECK(refused("out --time -1 --spacing 0.25 --out bad.h5").err ==
          "--time -1: lies before the first frame of out/particles.pvd; expected 0 to 2 s; give a time of the run\n");
    for (const std::string spacing : {"0", "-0.5"})
        CHECK(refused("out --time 1 --spacing " + spacing + " --out bad.h5").err ==
              "--spacing: found " + spacing +
                  "; expected a distance above 0 in metres; give the size of the 3D points\n");
    CHECK(refused("out --time 1 --spacing 0.25 --out bad.xyz").err ==
          "--out bad.xyz: found the extension \".xyz\"; expected .h5, .json, .csv, .vtp or .mdpa; name the file after "
          "the "
          "format you want\n");
    CHECK(refused("out --window 500,500,600,600" + rest).err ==
          "--window 500,500,600,600: lies outside the terrain; expected a part of 0,0,150,100; give map coordinates of "
          "the "
          "run\n");
    CHECK(
        refused("out --window 100,0,150,20" + rest).err ==
        "--window 100,0,150,20: holds no material at 1 s; expected particles of the flow in it; give another window or "
        "time\n");
    CHECK(refused("out --window 40,0,30,20" + rest).err ==
          "--window 40,0,30,20: is empty; expected xmin,ymin,xmax,ymax with xmin < xmax and ymin < ymax; give the "
          "corners "
          "in that order\n");
    CHECK_THAT(refused("out --window 40,0,30" + rest).err, Contains("--window"));
    CHECK_THAT(refused("out --profile cubic" + rest).err, Contains("bagnold"));
    CHECK(refused("." + rest).err ==
          ".: holds neither particles.pvd nor run.h5; expected the folder of a run with \"vtk\" "
          "or \"xdmf\" in output.formats, such as the one after --out of frana run\n");
    // Metres in slices of a nanometre: known before any memory is asked for.
    const Outcome many = refused("out --time 0 --spacing 1e-9 --out bad.h5");
    const std::string number = fmt::format("{:.3g} points, about {:.3g} GB; ", sum(run_particles(0, "depth")) * 1e9,
                                           sum(run_particles(0, "depth")) * 144.0);  // bytes a point
    CHECK_THAT(many.err, Contains("--spacing 1e-09: makes " + number) &&
                             Contains(" GB that are free; give a larger spacing or a --window\n"));
    for (const char* name : {"bad.h5", "bad.xyz", "bad.conservation.json"})
        CHECK_FALSE(fs::exists(finished_run().folder() / name));
}

TEST_CASE("A damaged frame is named, and nothing is written", "[convert]") {
    fs::copy(finished_run().folder() / "out", finished_run().folder() / "damaged", fs::copy_options::recursive);
    frana::write_text(finished_run().folder() / "damaged/particles/particles_000002.vtp", "not VTK");
    CHECK_THAT(refused("damaged --time 1 --spacing 1 --out d.csv").err,
               Contains("damaged/particles/particles_000002.vtp: cannot be read as a VTK file"));
    fs::remove(finished_run().folder() / "damaged/particles.pvd");
    frana::write_text(finished_run().folder() / "damaged/run.h5", "not HDF5");
    CHECK_THAT(refused("damaged --time 1 --spacing 1 --out d.csv").err, Contains("damaged/run.h5: cannot be read: "));
    CHECK_FALSE(fs::exists(finished_run().folder() / "d.csv"));
}

TEST_CASE("With free water the points are of the grains alone, and the water left out is told", "[convert]") {
    const PlaneCase scene;
    scene.write(
        "[material]\ndensity = 2650\n[material.structure]\nlaw = \"drucker_prager\"\ncohesion = 0\nfraction = 0\n"
        "friction_angle_deg = 30\nyoung_modulus = 1e6\n[water]\nmodel = \"free\"\nlevel = 88\n"
        "[boundary]\nsides = \"wall\"\n[output]\nevery = 2\nformats = [\"vtk\"]\n");
    const Outcome run = scene.frana("run CASE --out out --quiet --threads 1");
    INFO(run.err);
    REQUIRE(run.code == 0);
    double volume = 0.0;  // below 88 m lie the last columns of nodes, from the 25th on
    for (int column = 25; column < 30; ++column) volume += 20 * 25.0 * (88.0 - (100.0 - 0.5 * column));
    const Outcome outcome = scene.frana("convert out --time 0 --spacing 1 --out points.csv");
    CHECK(outcome.code == 0);
    CHECK_THAT(outcome.out, Contains(fmt::format("free water of the run is left out, the points are of the particles "
                                                 "alone: {:.6g} m3 on the whole terrain\n",
                                                 volume)));
}
