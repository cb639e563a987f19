#include <map>
#include <sstream>

#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

/// The lines of a file as `name[index]` → value, without our reader.
std::map<std::string, std::string> assignments(const std::string& text) {
  std::map<std::string, std::string> all;
  std::istringstream file(text);
  for (std::string line; std::getline(file, line);)
    if (const auto equals = line.find('='); line.starts_with('$') && equals != std::string::npos)
      all[line.substr(0, equals)] = line.substr(equals + 1);
  return all;
}

/// What a SINUMERIK adds to an axis [um], worked out from the text: minus the sum of the values, each joined by lines,
/// end values held; encoder tables by the axis itself, cross tables by their input axis and its direction.
double added_um(const ControllerExport& made, Axis output, const Vector3& at, int direction) {
  const std::string ax = "(AX" + std::to_string(index_of(output) + 1) + ")";
  const auto value = [](const std::map<std::string, std::string>& all, const std::string& step_min_max_index,
                        const std::string& variable, const std::string& first, const std::string& last, double p) {
    const double min = std::stod(all.at(variable + "_MIN[" + step_min_max_index + "]"));
    const double max = std::stod(all.at(variable + "_MAX[" + step_min_max_index + "]"));
    const double step = std::stod(all.at(variable + "_STEP[" + step_min_max_index + "]"));
    const double cell = (std::min(std::max(p, min), max) - min) / step;
    const auto k = static_cast<long>(std::floor(cell + 1e-9));
    const auto point = [&](long n) {
      return std::stod(all.at(variable + "[" + first + std::to_string(n) + last + "]"));
    };
    const double part = cell - static_cast<double>(k);
    return part < 1e-6 ? point(k) : point(k) + part * (point(k + 1) - point(k));
  };
  double sum = 0.0;
  for (const ExportFile& file : made.files) {
    const auto all = assignments(file.content);
    if (file.name == "AX_EEC.INI") {
      const std::string axis = ax.substr(1, ax.size() - 2);
      if (all.contains("$AA_ENC_COMP_MIN[0," + axis + "]"))
        sum += value(all, "0," + axis, "$AA_ENC_COMP", "0,", "," + axis, at[index_of(output)]);
      continue;
    }
    for (int t = 0; all.contains("$AN_CEC_MIN[" + std::to_string(t) + "]"); ++t) {
      const std::string index = std::to_string(t);
      const int only = std::stoi(all.at("$AN_CEC_DIRECTION[" + index + "]"));
      if (all.at("$AN_CEC_OUTPUT_AXIS[" + index + "]") != ax || (only != 0 && only != direction)) continue;
      const auto input = static_cast<std::size_t>(all.at("$AN_CEC_INPUT_AXIS[" + index + "]")[3] - '1');
      sum += value(all, index, "$AN_CEC", index + ",", "", at[input]);
    }
  }
  return -sum * 1000.0;
}

TEST_CASE("a positive error makes a positive value, and the value at the reference position is zero") {
  ExportSource source = small_machine();
  source.parameters.C0Y_um_per_m = source.parameters.B0Z_um_per_m = source.parameters.A0Z_um_per_m = 0.0;
  source.parameters.axes[0].datum.reference_position_mm = 100.0;
  // compensation −5, −7, −9: errors +5, +7, +9 um
  source.map.tables.push_back({Component::EXX, Approach::unknown, {0, 50, 100}, {-5, -7, -9}});
  const auto made = must(siemens_export(source, {}));
  const auto all = assignments(file_named(made, "AX_EEC.INI").content);
  CHECK(all.at("$AA_ENC_COMP_STEP[0,AX1]") == "50.000000");
  CHECK(all.at("$AA_ENC_COMP_MIN[0,AX1]") == "0.000000");
  CHECK(all.at("$AA_ENC_COMP_MAX[0,AX1]") == "100.000000");
  CHECK(all.at("$AA_ENC_COMP[0,0,AX1]") == "-0.004000");
  CHECK(all.at("$AA_ENC_COMP[0,1,AX1]") == "-0.002000");
  CHECK(all.at("$AA_ENC_COMP[0,2,AX1]") == "0.000000");
  CHECK(made.tables[0].shift == Approx(-9.0));
  CHECK(made.files.size() == 1);
  CHECK(file_named(made, "AX_EEC.INI").content.starts_with("%_N_AX_EEC_INI\n"));
  CHECK(file_named(made, "AX_EEC.INI").content.ends_with("M17\n"));
}

TEST_CASE("reversal becomes two one-direction tables with the axis as input and output") {
  ExportSource source = small_machine();
  source.parameters.C0Y_um_per_m = source.parameters.B0Z_um_per_m = source.parameters.A0Z_um_per_m = 0.0;
  add_table(source, Component::EYY, {0, 100}, {3, 5}, {-3, 1});  // means 0 and 3, halves 3 and 2
  const auto made = must(siemens_export(source, {}));
  const auto all = assignments(file_named(made, "NC_CEC.INI").content);
  CHECK(all.at("$AN_CEC_INPUT_AXIS[0]") == "(AX2)");
  CHECK(all.at("$AN_CEC_OUTPUT_AXIS[0]") == "(AX2)");
  CHECK(all.at("$AN_CEC_DIRECTION[0]") == "1");
  CHECK(all.at("$AN_CEC_DIRECTION[1]") == "-1");
  CHECK(all.at("$AN_CEC[0,0]") == "-0.003000");
  CHECK(all.at("$AN_CEC[0,1]") == "-0.002000");
  CHECK(all.at("$AN_CEC[1,0]") == "0.003000");
  CHECK(added_um(made, Axis::Y, {0, 100, 0}, 1) == Approx(5.0));
  CHECK(added_um(made, Axis::Y, {0, 100, 0}, -1) == Approx(1.0));
}

TEST_CASE("squareness is a line: Y leaning away from X pulls X back by the position of Y") {
  ExportSource source = small_machine();  // C0Y +30 um/m: E_X = −C0Y·Y
  source.map.tables.push_back({Component::EXX, Approach::unknown, {0, 200}, {0, 0}});
  const auto made = must(siemens_export(source, {}));
  CHECK(added_um(made, Axis::X, {0, 200, 0}, 1) == Approx(+6.0));   // error −6 um at Y 200
  CHECK(added_um(made, Axis::X, {0, 0, 200}, 1) == Approx(+4.0));   // B0Z −20: E_X = B0Z·Z = −4
  CHECK(added_um(made, Axis::Y, {0, 0, 200}, -1) == Approx(+2.0));  // A0Z +10: E_Y = −A0Z·Z = −2
}

TEST_CASE("the written files do what the map says at every place, without our reader") {
  const ExportSource source = whole_machine();
  const auto made = must(siemens_export(source, {}));
  for (const int direction : {1, -1})
    for (const double p : {-20.0, 0.0, 13.0, 50.0, 77.0, 100.0, 150.0, 200.0, 230.0})
      for (const Axis output : kAllAxes) {
        double wanted = 0.0, shift = 0.0;
        for (const Axis input : kAllAxes) {
          const Component component = curve_of(static_cast<Sense>(output), input);
          const laser::MapTable& own = *table_of(source.map, component, static_cast<Approach>(direction));
          wanted += compensation_at(own, p);
          for (const ExportedTable& table : made.tables)
            if (table.component == name_of(component)) shift += table.shift;
        }
        const double held = std::min(std::max(p, 0.0), 200.0) / 1000.0;
        if (output == Axis::X) wanted += 30.0 * held + 20.0 * held;
        if (output == Axis::Y) wanted += 10.0 * held;
        CHECK(added_um(made, output, {p, p, p}, direction) == Approx(wanted - shift).epsilon(1e-3));
      }
}

TEST_CASE("a line of two points that is taken as squareness is named in a note") {
  const auto read = must(
      parse_siemens("$AN_CEC_INPUT_AXIS[0]=(AX2)\n$AN_CEC_OUTPUT_AXIS[0]=(AX1)\n$AN_CEC_STEP[0]=100\n$AN_CEC_MIN[0]=0\n"
                    "$AN_CEC_MAX[0]=100\n$AN_CEC_DIRECTION[0]=0\n$AN_CEC[0,0]=0.001\n$AN_CEC[0,1]=0.004\n",
                    "c", {}));
  const ReadMap map = map_of(read);
  CHECK(map.squareness[index_of(Component::C0Y)] == Approx(-30.0));
  CHECK(laser::says(map.notes, "squareness C0Y"));
}

TEST_CASE("what was written comes back as the same compensation and the same squareness") {
  const ExportSource source = whole_machine();
  for (const bool adds : {false, true}) {
    SiemensOptions options;
    options.cec_adds = adds;
    const auto made = must(siemens_export(source, options));
    ControllerTables all;
    for (const ExportFile& file : made.files)
      REQUIRE(append(all, *parse_siemens(file.content, file.name, options), false));
    const ReadMap back = map_of(all);
    CHECK(back.squareness[index_of(Component::C0Y)] == Approx(30.0));
    CHECK(back.squareness[index_of(Component::B0Z)] == Approx(-20.0));
    CHECK(back.squareness[index_of(Component::A0Z)] == Approx(10.0));
    for (std::size_t c = 0; c < kCurves; ++c) {
      const auto component = static_cast<Component>(c);
      if (is_angular(component)) continue;
      double shift = 0.0;
      for (const ExportedTable& table : made.tables)
        if (table.component == name_of(component)) shift += table.shift;
      for (const Approach approach : {Approach::forward, Approach::reverse})
        for (const double p : {0.0, 50.0, 100.0, 200.0})
          CHECK(compensation_at(*table_of(back.map, component, approach), p) + shift ==
                Approx(compensation_at(*table_of(source.map, component, approach), p)).epsilon(2e-3));
    }
  }
}

TEST_CASE("too few tables: what is left out is reported") {
  SiemensOptions options;
  options.most_tables = 8;
  const auto made = must(siemens_export(whole_machine(), options));
  std::size_t tables = 0;
  const auto all = assignments(file_named(made, "NC_CEC.INI").content);
  while (all.contains("$AN_CEC_MIN[" + std::to_string(tables) + "]")) ++tables;
  CHECK(tables <= 8);
  CHECK(tables >= 7);
  CHECK(leaves(made, "half the reversal of EXX"));
  options.most_tables = 0;
  const auto none = must(siemens_export(whole_machine(), options));
  CHECK(none.files.size() == 1);
  CHECK(leaves(none, "EYX"));
  CHECK(leaves(none, "C0Y"));
}

TEST_CASE("few tables still carry every straightness and squareness by their means, and spend the rest on reversal") {
  ExportSource source = whole_machine();
  for (laser::MapTable& table : source.map.tables)  // the reversal of EYZ is 10 um, of the others 1 um
    if (table.component == Component::EYZ)
      for (double& value : table.compensation) value += table.approach == Approach::forward ? 4.5 : -4.5;
  SiemensOptions options;
  options.most_tables = 7;
  const auto made = must(siemens_export(source, options));
  for (const double p : {0.0, 50.0, 77.0, 100.0, 200.0})
    for (const Axis output : kAllAxes) {
      double wanted = 0.0, shift = 0.0;
      for (const Axis input : kAllAxes) {
        const Component component = curve_of(static_cast<Sense>(output), input);
        for (const Approach approach : {Approach::forward, Approach::reverse})
          wanted += 0.5 * compensation_at(*table_of(source.map, component, approach), p);
        for (const ExportedTable& table : made.tables)
          if (table.component == name_of(component)) shift += table.shift;
      }
      if (output == Axis::X) wanted += 50.0 * p / 1000.0;
      if (output == Axis::Y) wanted += 10.0 * p / 1000.0;
      const double forward = added_um(made, output, {p, p, p}, 1), reverse = added_um(made, output, {p, p, p}, -1);
      CHECK(0.5 * (forward + reverse) == Approx(wanted - shift).epsilon(1e-3));
      CHECK(forward - reverse == Approx(output == Axis::Y ? 10.0 : 0.0).epsilon(1e-3));
    }
  CHECK_FALSE(leaves(made, "C0Y"));
  CHECK_FALSE(leaves(made, "half the reversal of EYZ"));
  CHECK(leaves(made, "half the reversal of EZX"));
}

TEST_CASE("a limit of points is met, and the deviation is reported") {
  SiemensOptions options;
  options.most_points = 3;  // the map needs 5 even ones
  const auto made = must(siemens_export(whole_machine(), options));
  for (const ExportedTable& table : made.tables) CHECK(table.points <= 3);
  CHECK(made.tables[0].deviation > 0.0);
  bool set = false;
  for (const std::string& line : made.settings) set = set || line == "MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,AX1] = 3";
  CHECK(set);
}

const char* const kFromABackup = R"(%_N_NC_CEC_INI
;$PATH=/_N_NC_ACT
N5 $MN_MM_CEC_MAX_POINTS[0]=2
N10 $an_cec [0.0] = -2.5EX-3   ; as a manual prints it
N20 $AN_CEC[0,1]  0.002
$AN_CEC_INPUT_AXIS[0]="X1"
$AN_CEC_OUTPUT_AXIS[0]=(Y1)
$AN_CEC_STEP[0] 10
$AN_CEC_MIN[0] = 0
$AN_CEC_MAX[0]=10.0
$AN_CEC_DIRECTION[0]=-1
$AN_CEC_MULT_BY_TABLE[0]=0
$AN_CEC_STEP[1]=0
$AN_CEC[1,0]=0
$AA_ENC_COMP[0,0,C1]=0
$AA_ENC_COMP[0,1,C1]=0
$AA_ENC_COMP_STEP[0,C1]=10
$AA_ENC_COMP_MIN[0,C1]=0
$AA_ENC_COMP_MAX[0,C1]=10
$AA_ENC_COMP_IS_MODULO[0,C1]=1
m0
m30
)";

TEST_CASE("files from the field are read: blanks for =, points for commas, EX, numbers, m0, m30") {
  const auto read = must(parse_siemens(kFromABackup, "NC_CEC.INI", {}));
  CHECK(only(read.tables).component == Component::EYX);
  CHECK(read.tables[0].approach == Approach::reverse);
  CHECK(read.tables[0].compensation[0] == Approx(2.5));
  CHECK(read.tables[0].compensation[1] == Approx(-2.0));
  CHECK(laser::says(read.notes, "$AN_CEC[1]: no points"));
  CHECK(laser::says(read.notes, "all zero"));
}

TEST_CASE("the example of the manual's page: a step of 100 mm, values 0, 1.4 and 3.6 um") {
  const auto read = must(parse_siemens(
      "CHANDATA(1)\r\n$AA_ENC_COMP_STEP[0,AX1]=100.0\r\n$AA_ENC_COMP_MIN[0,AX1]=0.0\r\n$AA_ENC_COMP_MAX[0,AX1]=200."
      "0\r\n"
      "$AA_ENC_COMP_IS_MODULO[0,AX1]=0\r\n$AA_ENC_COMP[0,0,AX1]=0.0000\r\n$AA_ENC_COMP[0,1,AX1]=0.0014\r\n"
      "$AA_ENC_COMP[0,2,AX1]=0.0036\r\nM17\r\n",
      "AX_EEC.INI", {}));
  CHECK(read.tables[0].component == Component::EXX);
  CHECK(read.tables[0].position_mm == std::vector<double>{0, 100, 200});
  CHECK(read.tables[0].compensation[2] == Approx(-3.6));
}

TEST_CASE("what is wrong is named with its line, all at once") {
  const std::string said = to_text(must_fail(
      parse_siemens("CHANDATA(1)\n$AN_CEC[0,0]=0,5\nG1 X10\n$AN_CEC_DIRECTION[0]=2\n$AN_CEC[0]=1\n", "c", {})));
  check_holds(said, {"c:2:14: expected a number with a point, found \"0,5\"", "c:3:1: expected $AA_ENC_COMP",
                     "c:4:22: expected a direction", "c:5:1: expected [table,point]"});
}

TEST_CASE("half tables, products of tables and unknown axes are refused") {
  const std::string head =
      "$AN_CEC_INPUT_AXIS[0]=(AX1)\n$AN_CEC_OUTPUT_AXIS[0]=(AX2)\n$AN_CEC_STEP[0]=10\n$AN_CEC_MIN[0]=0\n";
  const auto refused = [](const std::string& text) { return to_text(must_fail(parse_siemens(text, "c", {}))); };
  CHECK(contains(refused(head + "$AN_CEC_MAX[0]=20\n$AN_CEC[0,0]=1\n$AN_CEC[0,2]=1\n"), "point 1 of 3 is missing"));
  CHECK(contains(refused(head + "$AN_CEC[0,0]=1\n"), "MAX"));
  CHECK(contains(refused(head + "$AN_CEC_MAX[0]=0\n$AN_CEC[0,0]=1\n$AN_CEC_MULT_BY_TABLE[0]=2\n"), "multiplied"));
  CHECK(refused("$AA_ENC_COMP[0,0,SP1]=1\n$AA_ENC_COMP_STEP[0,SP1]=1\n$AA_ENC_COMP_MIN[0,SP1]=0\n"
                "$AA_ENC_COMP_MAX[0,SP1]=0\n")
            .find("--axes") != std::string::npos);
  CHECK(contains(refused(""), "no compensation table"));
}

TEST_CASE("options give other axis names and the second measuring system") {
  SiemensOptions options{.axis_name = {"MX", "MY", "MZ"}, .encoder = 1};
  const std::string text =
      "$AA_ENC_COMP[1,0,MZ]=0.001\n$AA_ENC_COMP_STEP[1,MZ]=1\n$AA_ENC_COMP_MIN[1,MZ]=5\n"
      "$AA_ENC_COMP_MAX[1,MZ]=5\n";
  CHECK(must(parse_siemens(text, "c", options)).tables[0].component == Component::EZZ);
  options.encoder = 0;
  CHECK_FALSE(parse_siemens(text, "c", options));
}

}  // namespace

TEST_CASE("text after the end of a program, and a point given twice, are refused with their lines") {
  const std::string begin =
      "CHANDATA(1)\n$AA_ENC_COMP_STEP[0,AX1]=100.0\n$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=100.0\n"
      "$AA_ENC_COMP[0,0,AX1]=0.0\n$AA_ENC_COMP[0,1,AX1]=0.0014\n";
  CHECK(parse_siemens(begin + "M17\n", "x.ini", {}));
  CHECK(must_fail(parse_siemens(begin + "M17\n$AA_ENC_COMP[0,1,AX1]=0.9\n", "x.ini", {})).line == 8);
  CHECK(must_fail(parse_siemens(begin + "$AA_ENC_COMP[0,1,AX1]=0.9\nM17\n", "x.ini", {})).line == 7);
}

}  // namespace ecs::controllers
