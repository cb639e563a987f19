// Part programs read, corrected, and run by the machine of the workshop.
#include <map>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "modules/controllers/corrected_program.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/part_deviations.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/workshop_machines.hpp"

namespace ecs::controllers {
namespace {

/// Compensation as a formula of the place.
template <class Formula>
CompensationAt by(Formula formula) {
  return [formula](const std::vector<ProgramPlace>& places) {
    std::vector<std::optional<Vector3>> found;
    for (const ProgramPlace& place : places) found.push_back(formula(place));
    return found;
  };
}
const CompensationAt kNone = by([](const ProgramPlace&) { return Vector3{}; });
/// X grows by 20 um a 100 mm of X, and by 10 um a 100 mm of Z.
const CompensationAt kSlope = by([](const ProgramPlace& place) {
  return Vector3{0.2 * place.machine.position_mm[0] + 0.1 * place.machine.position_mm[2], 0.0, 0.0};
});
/// Arriving in reverse, X needs 8 um more.
const CompensationAt kReversal = by([](const ProgramPlace& place) {
  return Vector3{place.machine.approach[0] == Approach::reverse ? 8.0 : 0.0, 0.0, 0.0};
});

ProgramSettings at_start(const Vector3& start_mm = {}) {
  ProgramSettings settings;
  for (std::size_t a = 0; a < kAxes; ++a) {
    settings.start_mm[a] = start_mm[a];
    settings.deadband_mm[a] = 0.005;
  }
  return settings;
}

Result<CorrectedProgram> corrected(const std::string& text, const CompensationAt& compensation,
                                   const ProgramSettings& settings = at_start(), const std::string& comment = {}) {
  const PartProgram program = must(parse_part_program(text, "p.nc"));
  return corrected_program(program, settings, compensation, comment);
}
std::string text_of(const std::string& text, const CompensationAt& compensation,
                    const ProgramSettings& settings = at_start()) {
  return must(corrected(text, compensation, settings)).text;
}
std::string refused(const std::string& text) { return to_text(must_fail(corrected(text, kSlope))); }
std::string unread(const std::string& text) { return to_text(must_fail(parse_part_program(text, "p.nc"))); }

/// Where a program of G0, G1, G20, G21, G90, G91 and axis words sends the machine, block by block: a reader of its own.
std::vector<Vector3> points_of(const std::string& text) {
  std::vector<Vector3> points;
  Vector3 at_mm{};
  double unit_mm = 1.0;
  bool incremental = false;
  for (const std::string_view line : lines_of(text)) {
    bool moves = false;
    for (const std::string_view word : blank_words(line)) {
      const double value = std::stod(std::string(word.substr(1)));
      if (word == "G20" || word == "G21") unit_mm = word == "G20" ? 25.4 : 1.0;
      if (word == "G90" || word == "G91") incremental = word == "G91";
      if (word[0] < 'X' || word[0] > 'Z') continue;
      double& axis_mm = at_mm[static_cast<std::size_t>(word[0] - 'X')];
      axis_mm = (incremental ? axis_mm : 0.0) + value * unit_mm;
      moves = true;
    }
    if (moves) points.push_back(at_mm);
  }
  return points;
}

TEST_CASE("a program without compensation stays byte for byte, but for the comment") {
  const std::string text =
      "%\r\nO1234 (PART)\r\nN10 G21 G90 G17 G40 (metric)\r\nN20 T1 M6\r\nN30 G0 X-1.50 Y+.25 Z5. S1200 M3\r\n"
      "N40 G1 Z-1 F100\r\nN50 G2 X8.5 Y.25 I5. J0 M8\r\nN60 g3 x-1.5 r5.0\r\nN70 G91 G1 X.1\r\nX.1\r\nX.1 Y-0\r\n"
      "N80 G90 G81 X10 Y10 Z-5 R2 F50\r\nX20.\r\nG80\r\nG4 X2.5\r\nN90 G53 G0 Z0\r\n/M1\r\nM30\r\n%";
  const std::string made = must(corrected(text, kNone, at_start(), "corrected by us")).text;
  const std::string comment = "(corrected by us)\r\n";
  const std::size_t at = made.find(comment);
  REQUIRE(at == text.find("N10"));
  CHECK(made.substr(0, at) + made.substr(at + comment.size()) == text);
}

TEST_CASE("a coordinate is shifted by the compensation at its place, in the digits that are asked for") {
  CHECK(text_of("G0 X100\n", kSlope) == "G0 X100.0200\n");  // +20 um at 100 mm
  auto settings = at_start();
  settings.decimals = 3;
  CHECK(text_of("G0 X-100.\n", kSlope, settings) == "G0 X-100.020\n");
  CHECK(text_of("G0X100.12345Y5\n", kSlope) == "G0X100.14347Y5\n");
}

TEST_CASE("the work offset and the tool length say where the machine is") {
  auto settings = at_start();
  settings.work_offset_mm = {{54, {100.0, 0.0, 0.0}}, {55, {-100.0, 0.0, 0.0}}};
  settings.tool_length_mm = {{3, 100.0}};
  CHECK(text_of("G0 X0\nG55 X0\n", kSlope, settings) == "G0 X0.0200\nG55 X-0.0200\n");
  CHECK(text_of("G54 G0 G43 H3 X0 Z0\n", kSlope, settings) == "G54 G0 G43 H3 X0.0300 Z0\n");  // Z at 100: 10 um more
  settings.zero_at_mm = Vector3{};
  CHECK(text_of("G0 X0\nX100\n", kSlope, settings) == "G0 X0\nX100.0200\n");
}

TEST_CASE("an axis that does not move gets a word where its compensation changes") {
  CHECK(text_of("G0 X0 Z0\nZ100\nZ100\n", kSlope) == "G0 X0 Z0\nZ100 X0.0100\nZ100\n");
}

TEST_CASE("incremental words are differences of the rounded ends and add nothing up") {
  std::string incremental = "G91\n", absolute = "G90\n";
  for (int i = 1; i <= 100; ++i) {
    incremental += "G1 X0.333 Y0.1 F100\n";
    absolute += "G1 X" + fixed_text(0.333 * i, 3) + " Y" + fixed_text(0.1 * i, 1) + " F100\n";
  }
  const auto one = points_of(text_of(incremental, kSlope));
  const auto other = points_of(text_of(absolute, kSlope));
  REQUIRE(one.size() == other.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    for (std::size_t a = 0; a < kAxes; ++a) CHECK(std::abs(one[i][a] - other[i][a]) < 1e-9);
  CHECK(one.back()[0] == Approx(33.3 * 1.0002).epsilon(2e-6));
}

TEST_CASE("a program in inches goes where the same program in mm goes, within its digits") {
  const auto inch = points_of(text_of("G20 G90\nG0 X2 Y1\nG1 X10. F10\nG91 X-1 Z0.5\n", kSlope));
  const auto mm = points_of(text_of("G21 G90\nG0 X50.8 Y25.4\nG1 X254. F254\nG91 X-25.4 Z12.7\n", kSlope));
  REQUIRE(inch.size() == mm.size());
  for (std::size_t i = 0; i < inch.size(); ++i)
    for (std::size_t a = 0; a < kAxes; ++a)
      CHECK(std::abs(inch[i][a] - mm[i][a]) < 0.00018);  // half of 1e-5 in, of 1e-4 mm
}

TEST_CASE("a move on which the compensation bends is divided there, and F, M and comments stay where they act") {
  const CompensationAt bend = by([](const ProgramPlace& place) {
    return Vector3{0.0, 10.0 - std::abs(place.machine.position_mm[0] - 50.0) / 5.0, 0.0};
  });
  const auto made = must(corrected("G0 X0 Y0\nN10 G1 X100 F500 M8 M5 (edge)\nY3\n", bend));
  CHECK(made.text == "G0 X0 Y0\nN10 G1 X50.0000 Y0.0100 F500 M8 (edge)\nX100.0000 Y0.0000 M5\nY3\n");
  CHECK(made.blocks_added == 1);
  CHECK(made.moves == 3);
  auto coarse = at_start();
  coarse.tolerance_um = 10.5;
  CHECK(text_of("G0 X0 Y0\nG1 X100 F500\n", bend, coarse) == "G0 X0 Y0\nG1 X100 F500\n");
  const auto whole = must(corrected("G0 X0 Y0\nG1 X100 F500 M77\n", bend));
  CHECK(only(whole.uncorrected).lines == std::vector<int>{2});
  CHECK(whole.blocks_added == 0);
}

TEST_CASE("the pieces of a move with inverse time take as long together") {
  const CompensationAt bend = by([](const ProgramPlace& place) {
    return Vector3{0.0, 10.0 - std::abs(place.machine.position_mm[0] - 25.0) / 5.0, 0.0};
  });
  CHECK(text_of("G0 X0 Y5\nG93 G1 X100 F2\n", bend) ==
        "G0 X0 Y5.0050\nG93 G1 X25.0000 Y5.0100 F8.000\nX100.0000 Y4.9950 F2.667\n");
}

TEST_CASE("the reversal is taken up where the unit senses it, behind the deadband") {
  const auto settings = at_start({-10.0, 0.0, 0.0});
  const auto made = must(corrected("G0 X0\nG1 X100 F100\nX50\nX49.999\nX50.003\nX60\n", kReversal, settings));
  CHECK(made.text ==
        "G0 X0\nG1 X100 F100\nX100.0030\nX50.0080\nX50.0070\nX50.0110\n"  // −5 um and +8 um; 4 um back are none
        "X50.0040\nX60.0000\n");
  CHECK(made.largest_um == Vector3{8.0, 0.0, 0.0});
}

TEST_CASE("an arc stays an arc where the compensation is the same along it, and is moved as a whole") {
  const CompensationAt constant = by([](const ProgramPlace&) { return Vector3{12.0, -7.0, 0.0}; });
  CHECK(text_of("G0 X0 Y0\nG1 X10 F100\nG2 X30 I10 J0\nG3 I-10\n", constant) ==
        "G0 X0.0120 Y-0.0070\nG1 X10.0120 F100\nG2 X30.0120 I10 J0\nG3 I-10\n");
  const auto made = must(corrected("G0 X10 Y0\nG3 X-10 R10 F100\n", constant));
  CHECK(made.arcs_kept == 1);
  CHECK(made.text == "G0 X10.0120 Y-0.0070\nG3 X-9.9880 R10 F100\n");
}

/// The largest distance of the points of a divided circle, and of the middles between them, from the one that is meant.
double off_circle_mm(const std::vector<Vector3>& points, double radius_mm, const CompensationAt& compensation) {
  double most_mm = 0.0;
  const auto radius_at = [&](const Vector3& p) {
    const auto c = must(compensation({{{p, {}}, p}})).front().value();
    return std::hypot(p[0] - 1e-3 * c[0], p[1] - 1e-3 * c[1]);
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3 middle{0.5 * (points[i][0] + points[i - 1][0]), 0.5 * (points[i][1] + points[i - 1][1]), 0.0};
    most_mm = std::max({most_mm, std::abs(radius_at(points[i]) - radius_mm), std::abs(radius_at(middle) - radius_mm)});
  }
  return most_mm;
}

TEST_CASE("an arc along which the compensation changes becomes lines within the tolerance") {
  const CompensationAt twist = by([](const ProgramPlace& place) {
    return Vector3{0.5 * place.machine.position_mm[1], 0.3 * place.machine.position_mm[0], 0.0};
  });
  for (const char* const circle : {"G2 I-50", "G3 I-50", "G2 X50 Y0 I-50", "G3 X-50 R50\nG3 X50 R50"}) {
    CAPTURE(circle);
    for (const double tolerance_um : {1.0, 20.0}) {
      auto settings = at_start();
      settings.tolerance_um = tolerance_um;
      const auto made = must(corrected("G0 X50 Y0\n" + std::string(circle) + " F200 M9\nG1 X51\n", twist, settings));
      CHECK(made.arcs_divided > 0);
      CHECK_FALSE(contains(made.text, "G2"));
      CHECK_FALSE(contains(made.text, "G3"));
      CHECK(contains(made.text, " M9\nG1 X51 Y0.0153\n"));
      const auto points = points_of(made.text.substr(0, made.text.rfind("G1")));
      CHECK(off_circle_mm(points, 50.0, twist) < 1.3e-3 * tolerance_um);
      CHECK(points.size() < static_cast<std::size_t>(300.0 * std::sqrt(20.0 / tolerance_um)));
    }
  }
}

TEST_CASE("after a divided arc the modal motion of the program is written again where it is needed") {
  const CompensationAt step = by([](const ProgramPlace& place) {
    return Vector3{place.machine.position_mm[0] > 1.0 ? 50.0 : 0.0, 0.0, 0.0};
  });
  const std::string made = text_of("G0 X-20 Y0\nG1 F100 X-20.5\nG2 X20 I20.25\nX10 R5\nG1 X30\n", step);
  CHECK(contains(made, "\nG1 X"));
  CHECK(contains(made, "\nG2 X10.0500 R5\nG1 X30.0500\n"));
}

TEST_CASE("helices and the other planes are divided in their own axes") {
  const CompensationAt along_z = by([](const ProgramPlace& place) {
    return Vector3{0.0, 0.0, 2.0 * place.machine.position_mm[2]};
  });
  const auto helix = points_of(text_of("G0 X10 Y0 Z0\nG2 X10 Y0 Z-10 I-10 F100\n", along_z));
  CHECK(helix.back() == Vector3{10.0, 0.0, -10.02});
  CHECK(helix.size() > 30);
  for (std::size_t i = 2; i < helix.size(); ++i) CHECK(helix[i][2] < helix[i - 1][2]);
  // From +Z, G18: clockwise is seen from +Y, so that G2 turns from Z to −X.
  const auto zx = points_of(text_of("G18 G0 X0 Z10\nG2 X-10 Z0 K-10 F100\n", along_z));
  CHECK(zx[zx.size() / 2][0] < -5.0);
  CHECK(zx[zx.size() / 2][2] > 5.0);
  const auto yz = points_of(text_of("G19 G0 Y10 Z0\nG3 Y0 Z10 J-10 F100\n", along_z));
  CHECK(yz[yz.size() / 2][1] > 5.0);
  CHECK(yz.back()[2] == Approx(10.02));
}

TEST_CASE("an arc of several turns is refused") {
  for (const char* turns : {"P3", "L3"})
    CHECK(contains(refused(fmt::format("G0 X10 Y0 Z0\nG2 X10 Y0 Z-10 I-10 {} F100\n", turns)),
                   "p.nc:2:1: G2: arcs of several turns are not supported"));
}

TEST_CASE("holes of a cycle are corrected in place and depth") {
  const CompensationAt tilt = by([](const ProgramPlace& place) {
    const Vector3& p = place.machine.position_mm;
    return Vector3{0.1 * p[2], 0.0, 0.2 * p[0]};
  });
  CHECK(text_of("G0 X0 Y0 Z50\nG98 G81 X100 Y10 Z-20 R2 F80\nY20\nX50\nG80\nG0 Z50\n", tilt) ==
        "G0 X0.0050 Y0 Z50\nG98 G81 X99.9980 Y10 Z-19.9800 R2 F80\nY20\nX49.9980 Z-19.9900\nG80\nG0 Z50.0100 "
        "X50.0050\n");
  // Cycles that follow each other return to one level: Z of the last line is that of the first, 50.
  CHECK(text_of("G0 X0 Y0 Z50\nG99 G81 X100 Y10 Z-20 R2 F80\nG98 G81 X100 Y20 Z-20 R2\nX50\nG80\nG0 X0\n", tilt) ==
        "G0 X0.0050 Y0 Z50\nG99 G81 X99.9980 Y10 Z-19.9800 R2 F80\nG98 G81 X99.9980 Y20 Z-19.9800 R2\n"
        "X49.9980 Z-19.9900\nG80\nG0 X0.0050\n");
  CHECK(contains(refused("G0 X0 Y0 Z5\nG91 G81 Z-5 R-2 F80\n"), "p.nc:2:5: G81: cycles with G91"));
  CHECK(contains(refused("G0 X0 Y0 Z5\nG81 Z-5 R2 L3\n"), "p.nc:2:1: G81: repeated holes"));
}

TEST_CASE("a move is kept until every axis is known, and behind G28 the machine is lost again") {
  ProgramSettings unknown;
  const auto made = must(corrected("G0 X100\nY0\nZ100\nG91 G28 Z0\nG90 X100\nZ0\n", kSlope, unknown));
  CHECK(made.text == "G0 X100\nY0\nZ100 X100.0300\nG91 G28 Z0\nG90 X100\nZ0 X100.0200\n");
  REQUIRE(made.uncorrected.size() == 3);
  CHECK(made.uncorrected[0].lines == std::vector<int>{1});
  CHECK(contains(made.uncorrected[0].why, "position of Y"));
  CHECK(made.uncorrected[1].lines == std::vector<int>{2, 5});
  CHECK(contains(made.uncorrected[1].why, "position of Z"));
  CHECK(contains(to_text(must_fail(corrected("G91 G1 X5 F100\n", kSlope, unknown))),
                 "p.nc:1:8: X5: the position of X before this incremental word is not known"));
}

TEST_CASE("machine coordinates are kept and known") {
  auto settings = at_start();
  settings.work_offset_mm = {{54, {10.0, 0.0, 0.0}}};
  CHECK(text_of("G53 G0 X110\nX90\n", kSlope, settings) == "G53 G0 X110\nX90.0200\n");
  CHECK(text_of("G53 M3\nG0 X90\n", kSlope, settings) == "G53 M3\nG0 X90.0200\n");
}

TEST_CASE("what would spoil a part is refused, every line with its column") {
  CHECK(refused("G0 X0\nG41 D1 X5\nG92 X0\n") ==
        "p.nc:2:1: G41: tool radius compensation cannot be corrected, because the control computes the path; output "
        "the path of the tool centre\np.nc:3:1: G92: it changes the zero point of the program; use G54 to G59");
  for (const auto& [text, words] : std::map<std::string, std::string>{
           {"G55 X1", "p.nc:1:1: G55: its zero point is not given"},
           {"G43 Z5", "p.nc:1:1: G43: expected the number H"},
           {"G0 G43 H7 Z5", "p.nc:1:4: G43: the length of tool H7 is not given"},
           {"G1 X5 A10", "p.nc:1:7: A10: rotary and secondary axes"},
           {"G33 Z-5 K1", "p.nc:1:1: G33: threads"},
           {"G68 X0 Y0 R30", "p.nc:1:1: G68: polar coordinates, rotation"},
           {"G52 X5", "p.nc:1:1: G52: it changes the zero point"},
           {"G65 P9010", "p.nc:1:1: G65: macros"},
           {"M98 P100", "p.nc:1:1: M98: subprograms"},
           {"G77 X5", "p.nc:1:1: G77: not known here"},
           {"X5", "p.nc:1:1: X5: expected G0, G1, G2, G3 or a cycle"},
           {"G1 X1 X2 F1", "p.nc:1:7: X2: a second X in one block"},
           {"/G0 X5", "p.nc:1:2: G0: an optional block"},
           {"G2 X5", "p.nc:1:1: G2: expected the centre of the arc"},
           {"G2 X10 I3", "p.nc:1:1: G2: the start of the arc is 3.0000 mm from its centre, its end 7.0000 mm"},
           {"G2 X10 R3", "p.nc:1:1: G2: a radius of 3 mm cannot span 10 mm"},
           {"G2 I0.0001", "p.nc:1:1: G2: the start of the arc"},
           {"M30\nG0 X5", "p.nc:2:1: G0: expected nothing behind the end of the program in line 1"}}) {
    CAPTURE(text);
    CHECK(refused(text).find(words) == 0);
  }
}

TEST_CASE("lines that are no words of a part program are refused with their place") {
  CHECK(unread("G0 X5\nG1 X#1 F5\nN5 CALL SUB\nR1=5\nG1 X1.2.3\nG0 (open\n\nG0 X") ==
        "p.nc:2:4: X: expected a number such as -50.0 behind it, found \"#1 F5\"\n"
        "p.nc:3:4: expected a letter and its number, found the command \"CALL\": variables, formulas, loops, jumps and "
        "calls cannot be corrected; write the moves one by one (CAM systems have such an option)\n"
        "p.nc:4:3: expected a letter and its number, found \"=\": variables, formulas, loops, jumps and calls cannot "
        "be corrected; write the moves one by one (CAM systems have such an option)\n"
        "p.nc:5:4: X: expected a number such as -50.0 behind it, found \"1.2.3\"\n"
        "p.nc:6:4: comment: expected a \")\" before the end of the line, found none\n"
        "p.nc:8:4: X: expected a number such as -50.0 behind it, found nothing");
  CHECK(contains(unread("0 BEGIN PGM 12 MM\n1 L X+5 R0 FMAX\n"), "p.nc:1:3: expected a part program of ISO 6983"));
  std::string letter;
  for (int k = 0; k < 12; ++k) letter += "Dear colleague, this is no program.\n\n";
  CHECK(unread(letter) ==
        "p.nc: expected a part program of ISO 6983 or DIN 66025, but 12 of 12 lines are not blocks of such a program");
  CHECK(contains(unread("%\n(only words)\n"), "p.nc: expected a part program, found no block"));
  const auto twice = must_fail(parse_part_program("%\n(Corrected by ecs export program for m.csv)\nG0 X1\n", "p.nc"));
  CHECK(twice.kind == ProblemKind::refused);
  CHECK(twice.line == 2);
}

TEST_CASE(
    "deviations between measured points are a weighted mean, exact at the points and unknown beyond their reach") {
  const auto found =
      must(parse_part_deviations("x_mm,y_mm,z_mm,dx_um,dy_um,dz_um\n0,0,0,10,0,-3\n10,0,0,20,4,-3\n", "d.csv"));
  const auto along_x_um = [&](double x_mm) { return must(found.at({x_mm, 0.0, 0.0}, 20.0))[0]; };
  CHECK(along_x_um(10.0) == 20.0);
  CHECK(along_x_um(5.0) == Approx(15.0));
  CHECK(along_x_um(-19.0) == Approx(10.0));
  CHECK(along_x_um(-10.0) == Approx(10.0));  // the other point is as far as it reaches
  CHECK_FALSE(found.at({-20.0, 0.0, 0.0}, 20.0));
  const auto measured = must(parse_part_deviations(
      "x_mm;y_mm;z_mm;measured_x_mm;measured_y_mm;measured_z_mm\n0;0;0;0,010;0;-0,003\n", "d.csv"));
  CHECK(measured.points.front().deviation_um[0] == Approx(10.0));
  const auto set = must(
      parse_part_deviations("axis,sense,reading,x_mm,y_mm,z_mm\nX,EX,9,1,2,3\nX,EX,11,1,2,3\nY,EY,4,1,2,3\n", "d.csv"));
  CHECK(only(set.points).deviation_um == Vector3{10.0, 4.0, 0.0});
  CHECK(set.notes.size() == 1);
}

TEST_CASE("bad deviations are refused with line and column") {
  const auto why = [](const std::string& text) { return to_text(must_fail(parse_part_deviations(text, "d.csv"))); };
  const std::string head = "x_mm,y_mm,z_mm,dx_um,dy_um,dz_um\n";
  CHECK(contains(why(head + "0,0,0,1,2,3\n0,0,zero,1,2,3\n0,0,0,1,2,3\n"), "d.csv:3:5: z_mm: expected"));
  CHECK(contains(why(head + "0,0,0,1,2,3\n0,0,zero,1,2,3\n0,0,0,1,2,3\n"), "d.csv:4:1: the same place as in line 2"));
  CHECK(contains(why(head + "0,0,0,1,2,3e7\n"), "d.csv:2:11: dz_um: expected"));
  CHECK(contains(why("x_mm,y_mm,z_mm,dx_um\n0,0,0,1\n"), "d.csv:1: expected the columns dx_um"));
  CHECK(contains(why("axis,sense,reading,x_mm,y_mm,z_mm\nX,EA,9,1,2,3\n"), "d.csv:2: sense: expected EX, EY or EZ"));
}

TEST_CASE("a move beyond the reach of the measured points is kept and listed") {
  const auto near = by([](const ProgramPlace& place) {
    return std::abs(place.program_mm[0]) < 20.0 ? std::optional(Vector3{5.0, 0.0, 0.0}) : std::nullopt;
  });
  const auto made = must(corrected("G0 X0\nG1 X10 F100\nX100\nX90\n", near));
  CHECK(made.text == "G0 X0.0050\nG1 X10.0050 F100\nX100\nX90\n");
  CHECK(only(made.uncorrected).lines == std::vector<int>{3, 4});
}

// --- the machine of the workshop cuts

using namespace ecs::emulator;
using namespace ecs::emulator::test;

constexpr const char* kErrors =
    "[squareness]\nC0Y = 60.0\n"
    "[[contribution]]\ncomponent = \"EXX\"\nformula = \"-0.08*p + 4*sin(p/15) + 2*d\"\n"
    "[[contribution]]\ncomponent = \"EYY\"\nformula = \"0.05*p + 1.5*d\"\n"
    "[[contribution]]\ncomponent = \"EYX\"\nformula = \"0.0005*p*p\"\n"
    "[[contribution]]\ncomponent = \"ECX\"\nformula = \"0.2*p\"\n";

std::string machine_text() {
  std::string text = ecs::emulator::test::small_machine();
  for (const char axis : {'X', 'Y', 'Z'})
    text += fmt::format("[emulator.axis.{}]\ndrive = \"ideal\"\nkv_per_s = 100\n", axis);
  return text;
}

/// The map of these errors, as a perfect measurement gives it: compensation = −error.
ExportSource map_of_errors() {
  ExportSource source;
  source.parameters.C0Y_um_per_m = 60.0;
  const auto add = [&](Component component, const auto& error) {
    std::vector<double> p, forward, reverse;
    for (double at = -500.0; at <= 0.0; at += 5.0) {
      p.push_back(at);
      forward.push_back(-error(at, 1.0));
      reverse.push_back(-error(at, -1.0));
    }
    add_table(source, component, p, forward, reverse);
  };
  add(Component::EXX, [](double p, double d) { return -0.08 * p + 4.0 * std::sin(p / 15.0) + 2.0 * d; });
  add(Component::EYY, [](double p, double d) { return 0.05 * p + 1.5 * d; });
  add(Component::EYX, [](double p, double) { return 0.0005 * p * p; });
  add(Component::ECX, [](double p, double) { return 0.2 * p; });
  return source;
}

constexpr Vector3 kZero_mm{-250.0, -200.0, -100.0};  // of the program
constexpr double kRadius_mm = 40.0, kEdge_mm = 60.0;

/// A circle and a square round it, in the words of the workshop; what cuts has a comment.
std::string part() {
  const auto at = [](double x, double y) { return fmt::format("X{:.1f} Y{:.1f}", kZero_mm[0] + x, kZero_mm[1] + y); };
  std::string text = fmt::format("G90 G0 {} Z-100\nG1 F300 {}\nG4 H1\nG3 {} I-40 J0 (ring)\nG4 H1\nG0 {}\nG4 H1\n",
                                 at(40, -5), at(40, 0), at(40, 0), at(60, 60));
  for (const std::string& corner : {at(-60, 60), at(-60, -60), at(60, -60), at(60, 60)})
    text += fmt::format("G1 {} (edge)\nG4 H1\n", corner);
  return text;
}

/// Lines, from 1, that cut: from one with a comment to the next dwell.
std::vector<bool> cutting_lines(const std::string& program) {
  std::vector<bool> cuts{false};
  bool cutting = false;
  for (const std::string_view line : lines_of(program)) {
    cutting = (cutting || contains(line, "(ring)") || contains(line, "(edge)")) && !contains(line, "G4");
    cuts.push_back(cutting);
  }
  return cuts;
}

Simulation workshop() { return simulation_of(kErrors, machine_text()); }

/// Where the tool was on the part while it cut.
std::vector<Vector3> track_of(const std::string& program) {
  auto simulation = workshop();
  const Folder folder;
  ProgramOrder order;
  order.trace = folder / "trace.csv";
  order.trace_period_s = 0.02;
  (void)must(run_program(simulation, must(parse_program(program, "p.nc")), order));
  const std::string text = must(read_file(order.trace));
  const auto cuts = cutting_lines(program);
  std::vector<Vector3> track;
  for (const std::string_view row : lines_of(text)) {
    const auto cells = split(row, ',');
    if (cells.size() < 14 || !number_in(cells[0])) continue;
    const auto value = [&](std::size_t i) { return number_in(cells[i]).value(); };
    if (cuts.at(static_cast<std::size_t>(value(1))))
      track.push_back({value(2) + value(11) / 1e3 - kZero_mm[0], value(5) + value(12) / 1e3 - kZero_mm[1], 0.0});
  }
  return track;
}

/// Distances of a track from the circle, or from the edges of the square.
struct Distances {
  double largest_um = 0.0, squares = 0.0;
  int places = 0;
  void add(double off_mm) {
    largest_um = std::max(largest_um, 1e3 * std::abs(off_mm));
    squares += 1e6 * off_mm * off_mm;
    ++places;
  }
  [[nodiscard]] double rms_um() const { return std::sqrt(squares / places); }
};
struct PartError {
  Distances circle, edges;
};
PartError error_of(const std::vector<Vector3>& track) {
  PartError error;
  for (const Vector3& p : track) {
    const double radius = std::hypot(p[0], p[1]);
    if (std::abs(radius - kRadius_mm) < 0.5) error.circle.add(radius - kRadius_mm);
    for (std::size_t a = 0; a < 2; ++a)
      if (std::abs(std::abs(p[a]) - kEdge_mm) < 0.5 && std::abs(p[1 - a]) < 59.0)
        error.edges.add(std::abs(p[a]) - kEdge_mm);
  }
  return error;
}

CompensationAt compensation_by(const ExportSource& source) {
  return [errors = errors_of_map(source)](const std::vector<ProgramPlace>& places) {
    std::vector<MachinePlace> at;
    for (const ProgramPlace& place : places) at.push_back(place.machine);
    std::vector<std::optional<Vector3>> found;
    for (const Vector3& e : must(errors(at))) found.push_back(Vector3{-e[0], -e[1], -e[2]});
    return found;
  };
}

TEST_CASE("the machine of the workshop cuts the corrected program truer than the programmed one") {
  const ExportSource source = map_of_errors();
  auto settings = at_start(workshop().machine().command_mm());
  settings.sample_mm = 2.5;
  settings.deadband_mm = {1e-5, 1e-5, 1e-5};  // drives without friction turn at once
  const auto made = must(corrected(part(), compensation_by(source), settings));
  CHECK(made.arcs_divided == 1);
  const PartError before = error_of(track_of(part()));
  const PartError after = error_of(track_of(made.text));
  MESSAGE("circle ", before.circle.largest_um, " / ", before.circle.rms_um(), " -> ", after.circle.largest_um, " / ",
          after.circle.rms_um(), " um, edges ", before.edges.largest_um, " / ", before.edges.rms_um(), " -> ",
          after.edges.largest_um, " / ", after.edges.rms_um());
  CHECK(before.circle.rms_um() > 10.0);
  CHECK(before.edges.rms_um() > 10.0);
  CHECK(after.circle.rms_um() < 0.8);
  CHECK(after.edges.rms_um() < 0.8);
  // Where an axis turns, the machine follows a little earlier or later: off by its reversal of 4 um there, no more.
  CHECK(after.circle.largest_um < 4.1);
  CHECK(after.edges.largest_um < 4.1);
}

TEST_CASE("a part that was cut and measured corrects the next one") {
  const auto first = track_of(part());
  PartDeviations deviations;  // as a coordinate measuring machine finds them: across the surface
  for (std::size_t i = 0; i < first.size(); i += 25) {
    const Vector3& p = first[i];
    const double radius = std::hypot(p[0], p[1]);
    if (std::abs(radius - kRadius_mm) > 0.5) continue;
    const Vector3 normal{p[0] / radius, p[1] / radius, 0.0};
    const double off_um = 1e3 * (radius - kRadius_mm);
    deviations.points.push_back({{kRadius_mm * normal[0] + kZero_mm[0], kRadius_mm * normal[1] + kZero_mm[1], -100.0},
                                 {off_um * normal[0], off_um * normal[1], 0.0}});
  }
  std::sort(deviations.points.begin(), deviations.points.end(),
            [](const MeasuredPoint& a, const MeasuredPoint& b) { return a.nominal_mm < b.nominal_mm; });
  REQUIRE(deviations.points.size() > 100);
  const auto by_part = by([&](const ProgramPlace& place) {
    auto found = deviations.at(place.program_mm, 5.0);
    if (found)
      for (double& value : *found) value = -value;
    return found;
  });
  const auto made = must(corrected(part(), by_part, at_start(workshop().machine().command_mm())));
  const PartError before = error_of(first);
  const PartError after = error_of(track_of(made.text));
  MESSAGE("circle ", before.circle.largest_um, " / ", before.circle.rms_um(), " -> ", after.circle.largest_um, " / ",
          after.circle.rms_um(), " um");
  CHECK(after.circle.largest_um < 0.15 * before.circle.largest_um);
  CHECK(after.circle.rms_um() < 0.1 * before.circle.rms_um());
}

}  // namespace
}  // namespace ecs::controllers
