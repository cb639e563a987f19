// Nominal and measured positions: the six freedoms of the set-up are found, told and taken out.
#include "laser/import/set_up.hpp"

#include <fmt/format.h>
#include <rapidcheck.h>

#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// Turned by small angles [rad] about X, Y, Z, then shifted [mm].
Vector3 moved(const Vector3& p, const Vector3& turn, const Vector3& shift) {
  return {p[0] + turn[1] * p[2] - turn[2] * p[1] + shift[0], p[1] + turn[2] * p[0] - turn[0] * p[2] + shift[1],
          p[2] + turn[0] * p[1] - turn[1] * p[0] + shift[2]};
}

std::vector<Vector3> cube() {
  std::vector<Vector3> points;
  for (const double x : {0.0, 100.0, 300.0})
    for (const double y : {0.0, 200.0})
      for (const double z : {0.0, 50.0, 150.0}) points.push_back({x, y, z});
  return points;
}

MeasurementSet scan_by(const std::string& text, const std::string& columns) {
  ImportOptions options = by_columns(columns, 1);
  options.mapping->values = TableValues::actual_positions;
  options.takes_rotary = true;
  return must(parse_any(text, "scan.csv", options)).set;
}

MeasurementSet scan_as_suggested(const std::string& text, const std::string& columns) {
  const Problem why = must_fail(parse_any(text, "scan.csv", {}));
  CHECK_MESSAGE(contains(why.message, "--columns \"" + columns + "\" --values actual --skip 1"), why.message);
  return scan_by(text, columns);
}

}  // namespace

TEST_CASE("shift and rotation of a rigid body are found") {
  const bool found = rc::check("small rotations and shifts of a cube", [] {
    const auto small = [] { return *rc::gen::inRange(-200, 200) * 1e-6; };
    const Vector3 turn{small(), small(), small()}, shift{small() * 1e4, small() * 1e4, small() * 1e4};
    std::vector<Vector3> measured;
    for (const Vector3& point : cube()) measured.push_back(moved(point, turn, shift));
    const auto set_up = rigid_set_up(cube(), measured);
    RC_ASSERT(set_up.has_value());
    for (std::size_t i = 0; i < 3; ++i) RC_ASSERT(std::abs(set_up->rotation_um_m[i] - turn[i] * 1e6) < 0.1);
    for (std::size_t k = 0; k < measured.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        RC_ASSERT(std::abs((measured[k][i] - cube()[k][i]) * 1000.0 - set_up_error_um(*set_up, cube()[k])[i]) < 0.05);
  });
  CHECK(found);
}

TEST_CASE("points in a plane, on a line and at one place tell what they can") {
  const Vector3 turn{0.0, 0.0, 1e-4};
  std::vector<Vector3> plane, turned, line, turned_line;
  for (const double x : {0.0, 100.0, 200.0}) {
    line.push_back({x, 0.0, 0.0});
    turned_line.push_back(moved(line.back(), turn, {}));
    for (const double y : {0.0, 50.0}) {
      plane.push_back({x, y, 0.0});
      turned.push_back(moved(plane.back(), turn, {}));
    }
  }
  CHECK(rigid_set_up(plane, turned)->rotation_um_m[2] == Approx(100.0).epsilon(1e-4));
  CHECK(rigid_set_up(line, turned_line)->rotation_um_m[2] == Approx(100.0).epsilon(1e-4));
  CHECK(rigid_set_up(line, turned_line)->rotations == 2);
  CHECK(rigid_set_up({{1, 2, 3}, {1, 2, 3}}, {{1, 2, 4}, {1, 2, 4}})->rotations == 0);
  CHECK_FALSE(rigid_set_up({{1, 2, 3}}, {{1, 2, 4}}).has_value());
}

TEST_CASE("a table of nominal and measured positions comes in without its set-up, and with it if asked") {
  std::string text = "x,y,z,mx,my,mz\n";
  for (const Vector3& point : cube()) {
    Vector3 at = moved(point, {1e-4, -2e-4, 3e-4}, {0.05, -0.02, 0.01});
    at[0] += 10e-6 * point[0];  // scale of X: 10 um/m
    text += fmt::format("{},{},{},{:.7f},{:.7f},{:.7f}\n", point[0], point[1], point[2], at[0], at[1], at[2]);
  }
  ImportOptions options = by_columns("x_mm=x,y_mm=y,z_mm=z,measured_x_mm=mx,measured_y_mm=my,measured_z_mm=mz");
  const auto read = must(parse_any(text, "cmm.csv", options));
  REQUIRE(read.set.readings.size() == 54);
  CHECK(says(read.set.notes, "set-up removed: shift X"));
  double largest = 0.0;
  for (const Reading& one : read.set.readings) largest = std::max(largest, std::abs(one.error));
  CHECK(largest < 2.0);  // of a scale of 3 um
  CHECK(largest > 1.0);
  options.keep_set_up = true;
  CHECK(must(parse_any(text, "cmm.csv", options)).set.readings[0].error == Approx(50.0));
  const auto lacks = parse_any(text, "cmm.csv", by_columns("x_mm=x,measured_y_mm=my"));
  CHECK(contains(lacks.error().message, "measured_y_mm needs y_mm"));
}

TEST_CASE(
    "centres of a ball that the control saw are errors against their mean, opposite in sign, at the tool centre "
    "point") {
  const std::string text =
      "b_deg,c_deg,center_x_mm,center_y_mm,center_z_mm\n0,0,100.01,50,-20\n90,0,99.99,50,-20\n90,180,100.00,50.03,-"
      "20\n";
  const Problem why = must_fail(parse_any(text, "ball.csv", {}));
  const std::string columns = "b_deg=1[deg],c_deg=2[deg],tip_x_mm=3[mm],tip_y_mm=4[mm],tip_z_mm=5[mm]";
  CHECK_MESSAGE(contains(why.message, "--columns \"" + columns + "\" --skip 1 reads column 3, 4 and 5"), why.message);
  ImportOptions options = by_columns(columns, 1);
  options.takes_rotary = true;
  const auto set = must(parse_any(text, "ball.csv", options)).set;
  REQUIRE(set.readings.size() == 9);
  CHECK(set.readings[0].error == Approx(-10.0));  // the tool is 10 um short of where the control takes it to be
  CHECK(set.readings[3].error == Approx(10.0));
  CHECK(set.readings[7].error == Approx(-20.0));
  CHECK(set.readings[0].position_mm[0] == Approx(100.0));
  CHECK(set.readings[0].extras.at("at_tip") == 1.0);
  CHECK(set.readings[3].axis == Axis::Y);  // B moved
  CHECK(set.readings[6].axis == Axis::Z);  // C moved
  CHECK(set.readings[6].rotary);
  CHECK(contains(to_text(must_fail(parse_any(text, "ball.csv", by_columns("b_deg=1,tip_x_mm=3", 1)))), "no tip_y_mm"));
}

TEST_CASE(
    "names of the sessions of a ball are offered as its set-ups, numbered, and a column of other names is named") {
  const std::string text =
      "set,b_deg,c_deg,center_x_mm,center_y_mm,center_z_mm,who\nmay,0,0,100.01,50,-20,AB\nmay,90,0,99.99,50,-20,AB\n"
      "august,0,0,100.00,50.03,-20,CD\naugust,90,0,100.00,50.03,-20,CD\n";
  const Problem why = must_fail(parse_any(text, "ball.csv", {}));
  CHECK_MESSAGE(contains(why.message, "tip_z_mm=6[mm],set_up=1\""), why.message);
  CHECK_MESSAGE(contains(why.message, "This column is not read: 7 \"who\""), why.message);
  ImportOptions options =
      by_columns("b_deg=2[deg],c_deg=3[deg],tip_x_mm=4[mm],tip_y_mm=5[mm],tip_z_mm=6[mm],set_up=1", 1);
  options.takes_rotary = true;
  const auto set = must(parse_any(text, "ball.csv", options)).set;
  CHECK(set.readings.front().extras.at("set_up") == 1.0);
  CHECK(set.readings.back().extras.at("set_up") == 2.0);
  CHECK(set.readings.back().text_extras.empty());
  CHECK(std::ranges::find(set.notes, "set-ups are numbered in the order of the readings: 1 \"may\", 2 \"august\"") !=
        set.notes.end());
}

TEST_CASE("points that are visited again and again are errors against the mean of each point, a visit is a run") {
  const std::string text = "1, 10.00, 0.0, 5.0\n2, 90.00, 0.0, 5.0\n1, 10.02, 0.0, 5.0\n2, 90.04, 0.0, 5.0\n";
  const Problem why = must_fail(parse_any(text, "points.txt", {}));
  const std::string columns = "point=1,measured_x_mm=2[mm],measured_y_mm=3[mm],measured_z_mm=4[mm]";
  CHECK_MESSAGE(contains(why.message, "--columns \"" + columns + "\" reads column 1"), why.message);
  const auto set = must(parse_any(text, "points.txt", by_columns(columns))).set;
  REQUIRE(set.readings.size() == 12);
  CHECK(set.readings[0].error == Approx(-10.0));
  CHECK(set.readings[9].error == Approx(20.0));
  CHECK(set.readings[9].position_mm[0] == Approx(90.02));
  CHECK(set.readings[0].run == 1);
  CHECK(set.readings[9].run == 2);
}

TEST_CASE("points with names stay apart as those with numbers do") {
  const std::string text = "P1, 10.00, 0.0, 5.0\nP2, 90.00, 0.0, 5.0\nP1, 10.02, 0.0, 5.0\nP2, 90.04, 0.0, 5.0\n";
  const auto set =
      must(parse_any(text, "points.txt", by_columns("point=1,measured_x_mm=2,measured_y_mm=3,measured_z_mm=4"))).set;
  REQUIRE(set.readings.size() == 12);
  CHECK(set.readings[0].error == Approx(-10.0));
  CHECK(set.readings[9].position_mm[0] == Approx(90.02));
  CHECK(set.readings[9].run == 2);
  CHECK(set.readings[9].text_extras.at("point") == "P2");
}

TEST_CASE("a scan of a poor encoder over one turn is suggested in degrees, and rests are left out of it") {
  std::string text = "stamp;set;velocity;actual\n";
  std::size_t moving = 0;
  const auto add = [&](double at, double speed) {
    text += fmt::format("132900081483250000;{};{};{:.5f}\n", at, speed, at + 8.0 * std::sin(4.0 * at / 57.29578));
    moving += speed == 0.0 ? 0 : 1;
  };
  for (int i = 0; i < 30; ++i) add(0.0, 0.0);
  for (int i = 1; i <= 90; ++i) add(4.0 * i, 40.0);
  for (int i = 0; i < 30; ++i) add(360.0, 0.0);
  for (int i = 89; i >= 0; --i) add(4.0 * i, -40.0);
  const auto set = scan_as_suggested(text, "c_deg=2[deg],reading=4[deg],approach=motion,run=motion,rows=in_motion");
  CHECK(set.readings.size() == moving);
  CHECK(says(set.notes, "60 readings at rest or below half the usual speed are ignored"));
  CHECK(set.readings.front().approach == Approach::forward);
  CHECK(set.readings.back().approach == Approach::reverse);
  CHECK(set.readings.back().run == 1);
}

TEST_CASE("of a scan with times slower readings are kept too, each with the speed of the axis") {
  std::string text = "stamp;set;actual\n";
  const double steps[] = {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0};  // deg in 100 ms: the axis starts
  double at = 0.0;
  long long stamp = 132900081483250000;
  const auto add = [&](double step) {
    at += step;
    text += fmt::format("{};{};{:.5f}\n", stamp += 1000000, at, at + 8.0 * std::sin(4.0 * at / 57.29578));
  };
  for (int i = 0; i < 30; ++i) add(0.0);
  for (const double step : steps) add(step);
  for (int i = 0; i < 88; ++i) add(4.0);
  for (int i = 0; i < 30; ++i) add(0.4 * static_cast<double>(i == 0));
  const auto set = scan_as_suggested(text, "c_deg=2[deg],reading=3[deg],rows=in_motion,time_s=1*1e-7-13290008148.425");
  // the first 3.7 deg, in which lost motion is taken up, and the last readings, for the axis stops within an interval
  CHECK(set.readings.size() == 5 + 86);
  CHECK(says(set.notes,
             "readings at rest, below a twentieth of the usual speed, at an abrupt start or stop, or just behind a "
             "reversal are ignored"));
  CHECK(set.readings[0].angle_deg[2] == Approx(5.0));
  CHECK(set.readings[0].extras.at("speed_deg_min") == Approx(0.5 * (2.0 + 2.5) * 600.0));
  CHECK(set.readings[20].extras.at("speed_deg_min") == Approx(2400.0));
}

TEST_CASE("the slope of a reading is that of the wave up to both ends of a stroke, whatever is lost at the reversal") {
  const auto angle_deg = [](int i) { return 0.5 * (i <= 360 ? i : 720 - i); };
  std::string text = "stamp;set;actual\n";
  for (int i = 0; i <= 720; ++i) {
    const double seen = angle_deg(i) + (i <= 360 ? 0.6 : -0.6);
    text += fmt::format("{};{};{:.7f}\n", 132900081483250000 + 200000LL * i, angle_deg(i),
                        seen + 8.0 * std::sin(4.0 * seen / 57.29578));
  }
  const auto set = scan_by(
      text, "c_deg=2[deg],reading=3[deg],approach=motion,run=motion,rows=in_motion,time_s=1*1e-7-13290008148.325");
  REQUIRE(set.readings.size() > 700);
  for (const Reading& r : set.readings) {
    const double seen = r.angle_deg[2] + (r.approach == Approach::forward ? 0.6 : -0.6);
    CHECK(std::abs(r.extras.at("reading_slope") - (1.0 + 8.0 * 4.0 / 57.29578 * std::cos(4.0 * seen / 57.29578))) <
          0.01);
  }
}

TEST_CASE("a column that counts the readings of each run is suggested in place of a time") {
  std::string text = "run,sample,spindle_C,disp_um\n";
  for (int run = 1; run <= 3; ++run)
    for (int i = 0; i < 5; ++i) text += fmt::format("{},{},{:.1f},{:.2f}\n", run, i, 20.0 + i, 1.5 * i + run);
  const Problem why = must_fail(parse_any(text, "days.csv", {}));
  CHECK_MESSAGE(contains(why.message, "reading=4[um],run=1,t_spindle_degC=3[degC],time_s=2[min]"), why.message);
  CHECK_MESSAGE(contains(why.message,
                         "Column 2 counts the readings of each run, and the file does not state their "
                         "interval. It is assumed to be 1 min, because with a shorter unit"),
                why.message);
}

TEST_CASE(
    "readings that are counted are a second apart where no temperature changes fast, whatever its sensor scatters") {
  std::string text = "run,sample,spindle_C,disp_um\n";
  for (int run = 1; run <= 3; ++run)
    for (int i = 0; i < 100; ++i)
      text += fmt::format("{},{},{:.1f},{:.2f}\n", run, i, 20.0 + 0.01 * i + (i % 2 == 0 ? 0.1 : 0.0), 0.1 * i + run);
  const Problem why = must_fail(parse_any(text, "seconds.csv", {}));
  CHECK_MESSAGE(contains(why.message, "time_s=2[s]"), why.message);
  CHECK_MESSAGE(contains(why.message, "It is assumed to be 1 s. Write time_s=2*30 if it is 30 s"), why.message);
}
