#include "commissioning/maps/compare.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/answer_table.hpp"
#include "tests/support/test.hpp"

namespace ecs::test {
namespace {

using commissioning::change_between;
using commissioning::figures_of;
using commissioning::is_without_change;
using commissioning::MapChange;
using commissioning::rotary_change_cell;

using Curve = std::function<double(double position_mm, int sign)>;

/// Compensation against this error, with a table for each approach.
void put(laser::ErrorMap& map, Component component, double from_mm, double step_mm, int points, const Curve& error) {
  for (const Approach approach : {Approach::forward, Approach::reverse}) {
    laser::MapTable table{component, approach, {}, {}};
    for (int i = 0; i < points; ++i) {
      table.position_mm.push_back(from_mm + step_mm * i);
      table.compensation.push_back(-error(table.position_mm.back(), approach == Approach::forward ? 1 : -1));
    }
    map.tables.push_back(std::move(table));
  }
}

TEST_CASE("a scale and a lost motion that came since the first map are told apart, on different points") {
  laser::ErrorMap first, second;
  const Curve before = [](double p, int sign) { return 0.01 * p + 1.5 * sign; };
  put(first, Component::EXX, 0.0, 50.0, 11, before);
  put(second, Component::EXX, -20.0, 30.0, 20,
      [&](double p, int sign) { return before(p, sign) + 0.03 * p + 2.0 * sign - 1.0; });
  const MapChange change = change_between(first, second);
  REQUIRE(change.curves.size() == 1);
  CHECK(change.notes.empty());
  CHECK(change.curves[0].position_mm.front() == 0.0);
  CHECK(change.curves[0].position_mm.back() == 500.0);
  const auto f = figures_of(change.curves[0]);
  CHECK(f.slope_per_m == Approx(30.0));
  CHECK(f.reversal == Approx(4.0));
  CHECK(f.left_rms == Approx(0.0).epsilon(1e-9));
  CHECK(f.largest == Approx(16.0));
  CHECK(f.at_mm == 500.0);
  CHECK(f.approach == Approach::forward);
}

TEST_CASE("exchanged maps give the difference with the other sign, and what is neither slope nor reversal is left") {
  laser::ErrorMap first, second;
  put(first, Component::EYY, 0.0, 10.0, 41, [](double, int) { return 0.0; });
  put(second, Component::EYY, 0.0, 10.0, 41,
      [](double p, int) { return 3.0 * std::sin(p / 40.0 * 6.283185307179586); });
  const auto there = figures_of(change_between(first, second).curves.at(0));
  const auto back = figures_of(change_between(second, first).curves.at(0));
  CHECK(there.largest == Approx(-back.largest));
  CHECK(there.slope_per_m == Approx(-back.slope_per_m));
  CHECK(there.left_rms == Approx(back.left_rms));
  CHECK(there.left_rms == Approx(3.0 / std::sqrt(2.0)).epsilon(0.05));
  CHECK(there.reversal == 0.0);
}

TEST_CASE("a curve that is declared zero counts as zero; one that a map lacks is named and not compared") {
  laser::ErrorMap first, second;
  put(second, Component::EXX, 0.0, 50.0, 5, [](double, int) { return 2.0; });
  put(second, Component::EYX, 0.0, 50.0, 5, [](double, int) { return 1.0; });
  first.header.declared_zero = {{Component::EXX, "new scale"}};
  first.header.machine = "mill 1";
  second.header.machine = "mill 2";
  const MapChange change = change_between(first, second);
  REQUIRE(change.curves.size() == 1);
  CHECK(figures_of(change.curves[0]).mean == Approx(2.0));
  CHECK(change.notes ==
        std::vector<std::string>{"the files are of different machines: mill 1 and mill 2",
                                 "EYX is not in the first map, or for one approach only: not compared"});
}

TEST_CASE("maps that share no travel are not compared") {
  laser::ErrorMap first, second;
  put(first, Component::EXX, 0.0, 50.0, 5, [](double, int) { return 2.0; });
  put(second, Component::EXX, 300.0, 50.0, 5, [](double, int) { return 1.0; });
  const MapChange change = change_between(first, second);
  CHECK(change.curves.empty());
  CHECK(change.notes == std::vector<std::string>{"EXX: the maps have no travel in common: not compared",
                                                 "the maps have no curve in common"});
}

/// C with EXC = `size` cos c against the error, at each multiple of the increment.
laser::MapRotaryAxis turning_axis(double increment_deg, double size_um, double lost_um = 0.0) {
  laser::MapRotaryAxis one;
  one.axis.letter = 'C';
  one.increment_deg = increment_deg;
  for (std::size_t side = 0; side < 2; ++side)
    for (int i = 0; i * increment_deg < 360.0; ++i) {
      const double c_deg = i * increment_deg;
      for (auto& curve : one.compensation[side]) curve.push_back(0.0);
      one.compensation[side][0].back() =
          -size_um * std::cos(c_deg / 180.0 * 3.141592653589793) - (side == 1 ? lost_um : 0.0);
    }
  return one;
}

TEST_CASE("rotary axes are compared by location error and curve, on different points and over both approaches") {
  laser::ErrorMap first, second;
  first.header.rotary = {turning_axis(10.0, 3.0)};
  second.header.rotary = {turning_axis(5.0, 5.0, 0.5)};
  first.header.rotary[0].axis.location = {8.0, 0.0, 0.0, -4.0, 0.0, 0.0};
  second.header.rotary[0].axis.location = {6.5, 0.0, 0.0, -4.0, 0.0, 0.0};
  second.header.bending.of_machine[0] = 20.0;
  const MapChange change = change_between(first, second);
  REQUIRE(change.rotary.size() == 4);
  CHECK(change.rotary[0].name == "XOC");
  CHECK(change.rotary[0].largest == -1.5);
  CHECK(change.rotary[1].name == "AOC");
  CHECK(change.rotary[1].unit == "um/m");
  CHECK(change.rotary[1].largest == 0.0);
  CHECK(change.rotary[2].name == "EXC");
  // at 5 deg, where the first map is on the straight line between 0 and 10 deg
  CHECK(change.rotary[2].largest == Approx(5.5 - 0.5 * 3.0 - 0.5 * 3.0 * std::cos(10.0 / 180.0 * 3.141592653589793) -
                                           5.0 * (1.0 - std::cos(5.0 / 180.0 * 3.141592653589793))));
  CHECK(change.rotary[2].at_deg == 5.0);
  CHECK(change.rotary[2].approach == Approach::forward);
  CHECK_FALSE(is_without_change(change));
  CHECK(is_without_change(change_between(first, first)));
  check_holds(rotary_change_cell(change).text,
              {"XOC  um      -1.50", "EXC  um       2.50         5 forward", "machine_bending x_sin um      20.00"});
}

TEST_CASE("a rotary axis that one map lacks or that lies elsewhere is named") {
  laser::ErrorMap first, second;
  first.header.rotary = {turning_axis(10.0, 3.0)};
  second.header.rotary = first.header.rotary;
  second.header.rotary[0].axis.pivot_mm = {0.0, 0.0, 10.0};
  CHECK(change_between(first, second).notes.at(0) == "the maps have no curve in common");
  CHECK(contains(change_between(first, second).notes.at(1), "rotary axis C has another direction or pivot"));
  second.header.rotary.clear();
  CHECK(change_between(first, second).notes.at(1) == "the rotary axis C is not in the second map: not compared");
}

TEST_CASE("the measurement of a difference has each point with its approach, in the order of motion") {
  laser::ErrorMap first, second;
  put(first, Component::EZZ, 0.0, 50.0, 3, [](double, int) { return 0.0; });
  put(second, Component::EZZ, 0.0, 50.0, 3, [](double p, int sign) { return p + sign; });
  second.header.machine = "mill";
  const auto set = commissioning::measurement_of(change_between(first, second), "mill", {"a.csv", "b.csv"});
  REQUIRE(set.readings.size() == 6);
  CHECK(set.readings[2].position_mm[2] == 100.0);
  CHECK(set.readings[2].error == Approx(101.0));
  CHECK(set.readings[3].position_mm[2] == 100.0);
  CHECK(set.readings[3].approach == Approach::reverse);
  CHECK(set.readings[3].error == Approx(99.0));
  CHECK(laser::metadata_value(set, "machine") == "mill");
  CHECK(laser::metadata_value(set, "difference") == "errors of b.csv minus errors of a.csv");
}

/// Heights along X at three places of Y; `added` is the error on top of the form of the bed.
laser::MeasurementSet mesh_of(double step_mm, const std::function<double(double x_mm, double y_mm)>& added) {
  laser::MeasurementSet mesh;
  for (const double y_mm : {10.0, 60.0, 110.0})
    for (int i = 0; i * step_mm <= 200.0; ++i) {
      const double x_mm = i * step_mm;
      laser::Reading reading;
      reading.sense = Sense::EZ;
      reading.position_mm = {x_mm, y_mm, 0.0};
      reading.error = 0.2 * x_mm - 0.1 * y_mm + added(x_mm, y_mm);
      mesh.readings.push_back(reading);
    }
  return mesh;
}

TEST_CASE("two meshes of a bed differ by the tilt that came between them, line by line, without the form of the bed") {
  const auto before = mesh_of(25.0, [](double, double) { return 0.0; });
  const auto after = mesh_of(20.0, [](double x_mm, double y_mm) { return 0.05 * x_mm + 0.03 * y_mm; });
  const MapChange change = change_between(before, after);
  REQUIRE(change.curves.size() == 3);
  CHECK(change.notes.empty());
  for (const auto& curve : change.curves) {
    const auto f = figures_of(curve);
    CHECK(f.slope_per_m == Approx(50.0));
    CHECK(f.left_rms == Approx(0.0).epsilon(1e-9));
    CHECK(f.largest == Approx(0.05 * 200.0 + 0.03 * curve.parked_mm[1]));
  }
  const auto written = commissioning::measurement_of(change, "printer", {"before.csv", "after.csv"});
  REQUIRE(written.readings.size() == change.curves.size() * change.curves[0].position_mm.size());
  for (const laser::Reading& reading : written.readings)
    CHECK(reading.error == Approx(0.05 * reading.position_mm[0] + 0.03 * reading.position_mm[1]).epsilon(1e-9));
}

TEST_CASE("of two measurements only the lines, approaches and travels that both have are compared, and notes say so") {
  auto before = mesh_of(50.0, [](double, double) { return 0.0; });
  auto after = mesh_of(50.0, [](double, double) { return 1.0; });
  for (laser::Reading& reading : before.readings) {
    reading.approach = reading.position_mm[1] == 10.0 ? Approach::forward : Approach::reverse;
    if (reading.position_mm[1] == 110.0) reading.position_mm[1] = 120.0;
  }
  for (laser::Reading& reading : after.readings) reading.approach = Approach::forward;
  const MapChange change = change_between(before, after);
  REQUIRE(change.curves.size() == 1);
  CHECK(change.curves[0].parked_mm[1] == 10.0);
  CHECK(figures_of(change.curves[0]).mean == Approx(1.0));
  REQUIRE(change.notes.size() == 3);
  CHECK(change.notes[0] == "EZX at Y 60, Z 0: the files share no travel and approach: not compared");
  CHECK(change.notes[1] == "EZX at Y 110, Z 0 is not in the first file: not compared");
  CHECK(change.notes[2] == "EZX at Y 120, Z 0 is not in the second file: not compared");
}

}  // namespace
}  // namespace ecs::test
