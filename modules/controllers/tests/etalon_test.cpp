#include <iterator>
#include <map>
#include <sstream>

#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

/// Functions and values of a file, without our reader.
struct Plain {
  std::map<std::string, std::map<double, double>> function;
  std::map<std::string, double> value;
};
Plain plain(const std::string& text) {
  Plain all;
  std::istringstream file(text);
  std::string name;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("//") || line.starts_with("Grid") || line.starts_with("}")) continue;
    std::istringstream words(line);
    double p = 0.0, v = 0.0;
    if (line.starts_with("["))
      name = line.substr(1, 3);
    else if (line.starts_with("VALUE = "))
      all.value[name] = std::stod(line.substr(8));
    else if (words >> p >> v)
      all.function[name][p] = v;
  }
  return all;
}

TEST_CASE("the file holds errors: minus the compensation, mm and rad, the mean of both approaches") {
  ExportSource source = small_machine();
  source.parameters.measurement_lines_mm = {};
  add_table(source, Component::EXX, {0, 100}, {4, 10}, {2, 6});
  add_table(source, Component::ECY, {0, 200}, {20, -40}, {20, -40});
  const auto made = must(etalon_export(source, {}));
  const Plain file = plain(made.files.front().content);
  CHECK(file.function.at("EXX").at(0) == Approx(-0.003));
  CHECK(file.function.at("EXX").at(100) == Approx(-0.008));
  CHECK(file.function.at("ECY").at(200) == Approx(40e-6));
  CHECK(file.value.at("C0Y") == Approx(30e-6));
  CHECK(file.value.at("B0Z") == Approx(-20e-6));
  CHECK(leaves(made, "half the reversal"));
}

TEST_CASE("curves are brought from their lines to the machine zero, so that the same levers act") {
  ExportSource source = small_machine();  // lines of X: y = 50, z = 100
  // a rotation about Y while X moves: E_X = EBX·(Z − 100)
  add_table(source, Component::EXX, {0, 200}, {0, 0}, {0, 0});
  add_table(source, Component::EBX, {0, 200}, {100, 100}, {100, 100});  // error −100 um/m
  const auto made = must(etalon_export(source, {}));
  const Plain file = plain(made.files.front().content);
  // at Z = 0 the error is −100e-6·(0 − 100 mm) = +10 um, all of it in EXX now
  CHECK(file.function.at("EXX").at(0) == Approx(0.010));
  // at Z = 150 it is −100e-6·(150 − 100 mm) = −5 um
  CHECK(file.function.at("EXX").at(0) + file.function.at("EBX").at(0) * 150.0 == Approx(-0.005));
  const auto as_measured = must(etalon_export(source, {"e", false, 0}));
  CHECK(plain(as_measured.files.front().content).function.at("EXX").at(0) == Approx(0.0));
}

TEST_CASE("the control does over the whole volume what the unit does, but for the reversal") {
  const ExportSource source = whole_machine();
  const auto made = must(etalon_export(source, {}));
  const auto left = must(residuals(source, made.applied, {}, errors_of_map(source)));
  const ResidualRow& volume = left.back();
  CHECK(volume.where == "volume");
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    CHECK(volume.unit.largest_um[axis] == Approx(0.0));
    CHECK(volume.before.largest_um[axis] > 10.0);
    // three translations of half a um each, and 0.5 um/m over less than half a metre
    CHECK(volume.control.largest_um[axis] < 2.2);
    CHECK(volume.control.largest_um[axis] > 1.4);
  }
}

/// A function of the file by straight lines, end values held [um, um/m].
double at(const Plain& file, const std::string& name, double p, double unit) {
  const auto& points = file.function.at(name);
  const auto above = points.lower_bound(p);
  if (above == points.begin()) return above->second / unit;
  if (above == points.end()) return points.rbegin()->second / unit;
  const auto below = std::prev(above);
  return std::lerp(below->second, above->second, (p - below->first) / (above->first - below->first)) / unit;
}

TEST_CASE("the errors of a TXYZ machine, computed from the file by the rigid-body formulas, are those of the map") {
  ExportSource source = whole_machine();
  source.parameters.configuration = {'T', 'X', 'Y', 'Z', 0};
  const auto made = must(etalon_export(source, {}));
  const Plain file = plain(made.files.front().content);
  for (const Vector3& p : {Vector3{0, 0, 0}, Vector3{200, 0, 0}, Vector3{75, 130, 20}, Vector3{200, 200, 200}}) {
    const auto um = [&](const char* name, std::size_t axis) { return at(file, name, p[axis], 1e-3); };
    const auto um_per_mm = [&](const char* name, std::size_t axis) { return at(file, name, p[axis], 1e-3); };  // rad
    const auto square = [&](const char* name) { return file.value.at(name) * 1e3; };
    const double x = um("EXX", 0) + um("EXY", 1) + um("EXZ", 2) + um_per_mm("EBX", 0) * p[2] +
                     um_per_mm("EBY", 1) * p[2] - um_per_mm("ECX", 0) * p[1] - square("C0Y") * p[1] +
                     square("B0Z") * p[2];
    const double y = um("EYX", 0) + um("EYY", 1) + um("EYZ", 2) - um_per_mm("EAX", 0) * p[2] -
                     um_per_mm("EAY", 1) * p[2] - square("A0Z") * p[2];
    const double z = um("EZX", 0) + um("EZY", 1) + um("EZZ", 2) + um_per_mm("EAX", 0) * p[1];
    const PerAxis<Approach> parked{Approach::unknown, Approach::unknown, Approach::unknown};
    const auto error = must(errors_of_map(source)({{p, parked}}));
    CHECK(x == Approx(error[0][0]).epsilon(1e-4));
    CHECK(y == Approx(error[0][1]).epsilon(1e-4));
    CHECK(z == Approx(error[0][2]).epsilon(1e-4));
  }
}

TEST_CASE("what was written comes back: means of the map, squareness, on the lines of the parameters") {
  const ExportSource source = whole_machine();
  for (const bool zero : {true, false}) {
    const auto made = must(etalon_export(source, {"e.txt", zero, 0}));
    const auto read = must(parse_etalon(made.files.front().content, "e.txt"));
    CHECK(read.squareness[index_of(Component::A0Z)] == Approx(10.0));
    REQUIRE(read.levers_from_lines);
    CHECK(*read.levers_from_lines == !zero);
    const laser::ErrorMap back = at_measurement_lines(map_of(read).map, source.parameters, *read.levers_from_lines);
    for (std::size_t c = 0; c < kCurves; ++c)
      for (const double p : {0.0, 50.0, 75.0, 100.0, 200.0}) {
        const auto component = static_cast<Component>(c);
        const double mean = 0.5 * (compensation_at(*table_of(source.map, component, Approach::forward), p) +
                                   compensation_at(*table_of(source.map, component, Approach::reverse), p));
        CHECK(compensation_at(*table_of(back, component, Approach::forward), p) == Approx(mean).epsilon(1e-4));
      }
  }
}

TEST_CASE("a straightness of two points stays the straightness that it is, its constant part with it") {
  const auto read = must(parse_etalon(
      "[EXY]\nGridpoints = {\n 0 -0.004\n 200 -0.010\n}\n[C0Y]\nVALUE = 0.00003\n[EYZ]\nGridpoints = {\n 0 0.001\n 100 "
      "0.001\n}\n",
      "e"));
  CHECK_FALSE(read.levers_from_lines);
  const ReadMap map = map_of(read);
  REQUIRE(map.map.tables.size() == 2);
  CHECK(map.map.tables[0].component == Component::EXY);
  CHECK(map.map.tables[0].compensation[0] == Approx(4.0));
  CHECK(map.map.tables[0].compensation[1] == Approx(10.0));
  CHECK(map.map.tables[1].compensation[1] == Approx(-1.0));
  CHECK(map.squareness[index_of(Component::C0Y)] == Approx(30.0));
  CHECK(map.squareness[index_of(Component::A0Z)] == 0.0);
}

TEST_CASE("a file that says both of its lever arms is refused, and so are two files that say different things") {
  const std::string grid = "[EXX]\nGridpoints = { 0 0.001 }\n";
  const std::string zero = "// " + std::string(kLeversFromZero) + "\n";
  const std::string lines = "// " + std::string(kLeversFromLines) + "\n";
  CHECK_FALSE(parse_etalon(zero + lines + grid, "e"));
  auto all = must(parse_etalon(zero + grid, "e"));
  CHECK_FALSE(append(all, must(parse_etalon(lines + "[EYY]\nGridpoints = { 0 0.001 }\n", "f")), true));
}

TEST_CASE("points closer than a nanometre are merged, and the deviation is reported") {
  ExportSource source = small_machine();
  source.parameters.measurement_lines_mm = {};
  add_table(source, Component::EXX, {0, 1e-9, 100}, {0, 50, 2}, {0, 50, 2});
  const auto made = must(etalon_export(source, {}));
  CHECK(made.tables[0].points == 2);
  CHECK(made.tables[0].deviation == Approx(50.0));
}

TEST_CASE("positions and values that no machine has are refused by table and point") {
  for (const double far : {1e308, -1e308}) {
    ExportSource source = small_machine();
    add_table(source, Component::EXX, far < 0 ? std::vector{far, 0.0} : std::vector{0.0, far}, {0, 5}, {0, 5});
    const auto made = must_fail(etalon_export(source, {}));
    CHECK(made.kind == ProblemKind::refused);
    CHECK(made.file.empty());
    CHECK(contains(made.message, far < 0 ? "EXX forward, point 1 at -1e+308 mm" : "EXX forward, point 2 at 1e+308"));
  }
}

TEST_CASE("printed signs are refused: the format is ISO 230-1") {
  ExportSource source = whole_machine();
  source.parameters.convention = Convention::as_printed;
  CHECK(must_fail(etalon_export(source, {})).kind == ProblemKind::refused);
}

TEST_CASE("files of others are read: any case, braces on lines of their own, falling positions, rotary axes left out") {
  const auto read = parse_etalon(
      "// made elsewhere\r\n[eyx]\r\ngridpoints =\r\n{\r\n 100.0 0.0012 // end of travel\r\n 0.0\t0.0\r\n}  // end\r\n"
      "[A0B]\r\nVALUE = 0.0000476\r\n[EXC]\r\nGridpoints = { 0 0.001 }\r\n[C0Y]\r\nValue = 0.0000105\r\n",
      "e");
  REQUIRE(read);
  CHECK(only(read->tables).position_mm == std::vector<double>{0, 100});
  CHECK(read->tables[0].compensation[1] == Approx(-1.2));
  CHECK(read->squareness[index_of(Component::C0Y)] == Approx(10.5));
  CHECK(laser::says(read->notes, "A0B"));
  CHECK(laser::says(read->notes, "EXC"));
}

TEST_CASE("what is wrong is named with its line, all at once") {
  const std::string said = to_text(must_fail(
      parse_etalon("[EXX]\nGridpoints = {\n 0 0,5\n 10\n 20 0.1\n 20 0.1\n}\n[QQQ]\nVALUE = 1\nhello\n[C0Y]\nVALUE = "
                   "big\n[EYY]\nGridpoints = {\n 0 99\n",
                   "e")));
  check_holds(said,
              {"e:3:", "e:4:4: expected a value behind the position", "e:6: EXX: the positions do not rise",
               "e:8:1: expected a name such as EXX", "e:10:1: expected [NAME]",
               "e:12:9: expected a number, found \"big\"", "do not end with }", "99 at 0 is not a plausible error"});
}

TEST_CASE("an empty file has no errors") { CHECK_FALSE(parse_etalon("", "e")); }

}  // namespace
}  // namespace ecs::controllers
