#include <map>
#include <numbers>
#include <sstream>

#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

/// Values by heading and position, without our reader: cells under their headings.
std::map<std::string, std::map<double, double>> com_values(const std::string& text) {
  std::map<std::string, std::map<double, double>> all;
  std::istringstream file(text);
  std::string line, heading;
  std::getline(file, line);
  std::getline(file, heading);
  while (std::getline(file, line) && line != "[END]") {
    const double p = std::stod(line.substr(heading.find("AXISPOS"), 14));
    std::istringstream names(heading);
    for (std::string name; names >> name;) {
      const std::size_t at = !contains(heading, " " + name + " ") ? 0 : heading.find(" " + name + " ") + 1;
      if (at > 0 && at < line.size() && line.substr(at, 14).find_first_not_of(' ') != std::string::npos)
        all[name][p] = std::stod(line.substr(at, 14));
    }
  }
  return all;
}

TEST_CASE("a table holds errors in mm, the reverse approach in BACKLASH, and angles in degrees") {
  ExportSource source = small_machine();
  source.parameters.measurement_lines_mm = {};
  source.parameters.C0Y_um_per_m = source.parameters.B0Z_um_per_m = source.parameters.A0Z_um_per_m = 0.0;
  add_table(source, Component::EXX, {0, 100}, {4, 10}, {2, 6});
  add_table(source, Component::EYX, {0, 100}, {-3, 5}, {-1, 7});
  add_table(source, Component::ECX, {0, 100}, {20, -40}, {20, -40});
  const auto made = must(heidenhain_export(source, {}));
  const std::string& text = file_named(made, "x.com").content;
  CHECK(text.starts_with("BEGIN X.COM MM\nNR   AXISPOS       BACKLASH      X             C2            C6"));
  const auto values = com_values(text);
  CHECK(values.at("X").at(0) == Approx(-0.004));
  CHECK(values.at("BACKLASH").at(100) == Approx(-0.006));
  CHECK(values.at("C2").at(0) == Approx(0.002));  // the mean of -3 and -1 um of compensation
  CHECK(values.at("C6").at(100) == Approx(40e-6 * 180 / std::numbers::pi).epsilon(1e-3));
  CHECK(leaves(made, "half the reversal of straightness"));
  CHECK(contains(file_named(made, "config.cma").content, "0    *       x.com"));
}

TEST_CASE("the kinematics entries stand above their axis and their number is given") {
  const auto made = must(heidenhain_export(whole_machine(), {}));
  REQUIRE(made.settings.size() == 4);
  check_holds(made.settings[1], {"above the line MachAxis Y: Trans X with C1 (EXY)", "Trans C with C6 (ECY)"});
  CHECK(made.settings[3].starts_with("15 entries in COMPTAB"));
}

/// Rotation about one axis, small angle, of a vector: v + w x v.
Vector3 turned(const Vector3& w, const Vector3& v) {
  return {v[0] + w[1] * v[2] - w[2] * v[1], v[1] + w[2] * v[0] - w[0] * v[2], v[2] + w[0] * v[1] - w[1] * v[0]};
}

double joined_by_lines(const std::map<double, double>& points, double p) {
  const auto above = points.lower_bound(p);
  if (above == points.begin()) return above->second;
  if (above == points.end()) return points.rbegin()->second;
  const auto below = std::prev(above);
  return below->second + (above->second - below->second) * (p - below->first) / (above->first - below->first);
}

TEST_CASE("a chain from the tool to the table with these entries moves the tool as the machine errs") {
  const ExportSource source = whole_machine();  // XYTZ: from the tool Z, the base, X, Y
  const auto made = must(heidenhain_export(source, {}));
  const Vector3 place{50.0, 100.0, 200.0};
  // from the tool: the entries above each axis, then its movement
  Vector3 actual{}, ideal{};
  for (const Axis axis : {Axis::Z, Axis::X, Axis::Y}) {
    const auto i = index_of(axis);
    const char letter = "xyz"[i];
    const auto values = com_values(file_named(made, std::string(1, letter) + ".com").content);
    const auto at = [&](const std::string& name) {
      return values.contains(name) ? joined_by_lines(values.at(name), place[i]) : 0.0;
    };
    const double to_rad = std::numbers::pi / 180.0;
    actual = turned({at("C4") * to_rad, at("C5") * to_rad, at("C6") * to_rad}, actual);
    for (std::size_t d = 0; d < 3; ++d) actual[d] += at("C" + std::to_string(d + 1));
    const std::string own(1, "XYZ"[i]);
    actual[i] += place[i] + (at(own) + at("BACKLASH")) / 2.0;
    ideal[i] += place[i];
  }
  const TermTable terms = *terms_of(*chain_of("XYTZ"), Convention::iso, CurveKind::measured);
  MachinePlace parked{place, {Approach::unknown, Approach::unknown, Approach::unknown}};
  const Vector3 compensation = compensation_by(made.applied, terms, parked, {}, {});
  for (std::size_t d = 0; d < 3; ++d) CHECK((actual[d] - ideal[d]) * 1000.0 == Approx(-compensation[d]).epsilon(0.001));
}

TEST_CASE("over the whole volume the control does what the unit does, but for reversal of straightness and angles") {
  const ExportSource source = whole_machine();
  const auto made = must(heidenhain_export(source, {}));
  const auto left = must(residuals(source, made.applied, {}, errors_of_map(source)));
  CHECK(left.back().before.largest_um[3] > 50.0);
  CHECK(left.back().control.largest_um[3] < 6.0);
}

TEST_CASE("plain tables carry straightness in the columns of the axes, and no rotation") {
  HeidenhainOptions plain;
  plain.kinematics = false;
  const auto made = must(heidenhain_export(whole_machine(), plain));
  const auto values = com_values(file_named(made, "y.com").content);
  CHECK(values.contains("Z"));
  CHECK_FALSE(values.contains("C4"));
  CHECK(leaves(made, "EAX"));
  CHECK_FALSE(leaves(made, "C0Y"));
  // C0Y = 30 um/m: at Y = 200 mm the error along X is -6 um beside EXY; of the map 4/3 um at 200, 0 at 0
  CHECK(values.at("X").at(200) - values.at("X").at(0) == Approx(-0.006 - (4.0 / 3.0) / 1000.0).epsilon(0.1));
  CHECK(made.settings.empty());
}

TEST_CASE("tables of more points than asked are thinned together") {
  ExportSource source = small_machine();
  std::vector<double> p, straight, wave;
  for (int i = 0; i <= 400; ++i) {
    p.push_back(0.5 * i);
    straight.push_back(0.1 * i);
    wave.push_back(10.0 * std::sin(0.05 * i));
  }
  add_table(source, Component::EXX, p, straight, straight);
  add_table(source, Component::EYX, p, wave, wave);
  HeidenhainOptions options;
  options.most_points = 40;
  const auto made = must(heidenhain_export(source, options));
  CHECK(com_values(file_named(made, "x.com").content).at("C2").size() <= 40);
  for (const ExportedTable& table : made.tables) CHECK(table.deviation < 0.5);
}

TEST_CASE("broken tables are refused with line and column") {
  const auto refused = [](const std::string& text) { return to_text(must_fail(parse_heidenhain(text, "x.com", {}))); };
  const std::string head = "BEGIN X.COM MM\nNR   AXISPOS       BACKLASH      X             C4\n";
  const std::string good = "0    +0.000000                   +0.0010       +0.000100\n";
  CHECK(contains(refused(head + good + "1    ten                         +0.0\n[END]\n"), "x.com:4:6"));
  CHECK(contains(refused(head + good + good + "[END]\n"), "expected a position above 0"));
  CHECK(
      contains(refused(head + good + "1    +10.000000                  +0.0010       +0.0001\n"), "was it truncated"));
  CHECK(contains(refused(head + good + "1    +10.000000                  +90.0\n[END]\n"), "implausibly"));
  CHECK(contains(refused("BEGIN X.COM INCH\n"), "found INCH"));
  CHECK(contains(refused("BEGIN AXIS-X.COM  DATUM:+0.0000 DISTANCE:+100.0000\nNR X\n"), "DATUM"));
  CHECK(contains(refused("BEGIN X.COM MM\nNR   X\n[END]\n"), "AXISPOS"));
  CHECK(
      contains(refused(head + "0    +0.0          +0.001\n1    +1.0          +0.002\n[END]\n"), "BACKLASH has values"));
  CHECK(
      parse_heidenhain("BEGIN CONFIG.CMA MM\nNR ACTIVE X\n0  *      x.com\n[END]\n", "config.cma", {})->notes.size() ==
      1);
}

TEST_CASE("the axis of a table is the last letter of its name, or the one given") {
  const std::string rows = "NR   AXISPOS       X\n0    +0.0          +0.001\n1    +10.0         +0.002\n[END]\n";
  CHECK(parse_heidenhain("BEGIN AXIS_Y.COM MM\n" + rows, "t.com", {})->tables.at(0).component == Component::EXY);
  CHECK_FALSE(parse_heidenhain("BEGIN TABLE.COM MM\n" + rows, "t.com", {}));
  HeidenhainOptions given{.holds_errors = false, .axis = Axis::Z};
  const auto read = parse_heidenhain("BEGIN TABLE.COM MM\n" + rows, "t.com", given);
  CHECK(read->tables.at(0).component == Component::EXZ);
  CHECK(read->tables.at(0).compensation.at(1) == Approx(2.0));
}

}  // namespace
}  // namespace ecs::controllers
