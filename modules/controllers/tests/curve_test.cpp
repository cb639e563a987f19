#include "modules/controllers/curve.hpp"

#include <rapidcheck.h>

#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

ControlCurve curve(std::vector<double> p, std::vector<double> forward, std::vector<double> reverse) {
  return {std::move(p), std::move(forward), std::move(reverse)};
}

/// Largest difference of either side between the points of `whole` and the lines of `part`.
double miss(const ControlCurve& part, const ControlCurve& whole) {
  double most = 0.0;
  for (std::size_t i = 0; i < whole.position_mm.size(); ++i) {
    most = std::max(most, std::abs(value_at(part, Approach::forward, whole.position_mm[i]) - whole.forward[i]));
    most = std::max(most, std::abs(value_at(part, Approach::reverse, whole.position_mm[i]) - whole.reverse[i]));
  }
  return most;
}

TEST_CASE("the corners of a broken line are kept, and nothing else is needed") {
  ControlCurve whole;
  for (int i = 0; i <= 100; ++i) {
    whole.position_mm.push_back(i);
    whole.forward.push_back(i <= 30 ? i : i <= 70 ? 30.0 : 100.0 - i);
    whole.reverse.push_back(i <= 30 ? -i : -30.0);
  }
  const ControlCurve kept = thinned(whole, 4);
  CHECK(kept.position_mm == std::vector<double>{0, 30, 70, 100});
  CHECK(miss(kept, whole) < 1e-5);
}

TEST_CASE("one side alone may need a point: forward and reverse share their positions") {
  const ControlCurve kept = thinned(curve({0, 1, 2, 3, 4}, {0, 0, 0, 0, 0}, {0, 0, 9, 0, 0}), 3);
  CHECK(kept.position_mm == std::vector<double>{0, 2, 4});
  CHECK(kept.reverse == std::vector<double>{0, 9, 0});
}

TEST_CASE("no choice of as many points misses less than the one that is made") {
  rc::check("thinned is the best choice", [] {
    const auto values = *rc::gen::container<std::vector<int>>(7, rc::gen::inRange(-20, 21));
    ControlCurve whole;
    for (std::size_t i = 0; i < values.size(); ++i) {
      whole.position_mm.push_back(static_cast<double>(i * i + 3 * i));
      whole.forward.push_back(values[i]);
      whole.reverse.push_back(values[values.size() - 1 - i]);
    }
    for (std::size_t most = 2; most < 7; ++most) {
      double best = 1e9;
      for (unsigned mask = 0; mask < 32; ++mask) {  // every subset of the five inner points
        ControlCurve part;
        for (std::size_t i = 0; i < 7; ++i) {
          if (i != 0 && i != 6 && (mask >> (i - 1) & 1u) == 0) continue;
          part.position_mm.push_back(whole.position_mm[i]);
          part.forward.push_back(whole.forward[i]);
          part.reverse.push_back(whole.reverse[i]);
        }
        if (part.position_mm.size() <= most) best = std::min(best, miss(part, whole));
      }
      const ControlCurve kept = thinned(whole, most);
      RC_ASSERT(kept.position_mm.size() <= most);
      RC_ASSERT(std::abs(miss(kept, whole) - best) < 1e-5);
    }
  });
}

TEST_CASE("a map of 160,000 points is thinned within the time limit") {
  ControlCurve whole;
  for (int i = 0; i < 160'000; ++i) {
    whole.position_mm.push_back(0.01 * i);
    whole.forward.push_back(20.0 * std::sin(i / 8000.0));
    whole.reverse.push_back(20.0 * std::cos(i / 8000.0));
  }
  const ControlCurve kept = thinned(whole, 256);
  CHECK(kept.position_mm.size() == 256);
  CHECK(miss(kept, whole) < 0.2);
}

TEST_CASE("an even grid that fits is kept as it is") {
  const EvenGrid grid = even_grid(curve({-100, -50, 0}, {1, 2, 3}, {1, 2, 3}), 5);
  CHECK(grid.points == 3);
  CHECK(grid.step_mm == Approx(50.0));
  CHECK(grid.first_mm == -100.0);
}

TEST_CASE("an uneven table gets the even grid that follows it best, to both ends") {
  const ControlCurve whole = curve({0, 30, 100}, {0, 30, 30}, {0, 30, 30});
  const EvenGrid grid = even_grid(whole, 11);
  CHECK(grid.points <= 11);
  CHECK(grid.positions().back() == Approx(100.0));
  CHECK(miss(resampled(whole, grid.positions()), whole) < 1e-6);  // a grid of 10 mm has both corners
}

TEST_CASE("the grid of a length that no decimals divide still reaches the end, by nanometres") {
  const ControlCurve whole = curve({0, 1, 2, 100}, {0, 1, 2, 3}, {0, 1, 2, 3});
  const EvenGrid grid = even_grid(whole, 4);
  const double end = grid.first_mm + grid.step_mm * static_cast<double>(grid.points - 1);
  CHECK(end >= 100.0);
  CHECK(end < 100.00001);
  CHECK(grid.step_mm * 1e6 == Approx(std::round(grid.step_mm * 1e6)));
}

TEST_CASE("the unit steps half an increment before the next value, a control joins them by a line") {
  const laser::MapTable table{Component::EXX, Approach::unknown, {0, 10}, {0, 8}};
  CHECK(unit_value_at(table, Interpolation::nearest, 4.9) == 0.0);
  CHECK(unit_value_at(table, Interpolation::nearest, 5.0) == 8.0);
  CHECK(unit_value_at(table, Interpolation::nearest, -3.0) == 0.0);
  CHECK(unit_value_at(table, Interpolation::nearest, 30.0) == 8.0);
  CHECK(unit_value_at(table, Interpolation::linear, 5.0) == Approx(4.0));
  const laser::ErrorMap map{{}, {table}};
  const ControlCurve joined = *curve_of(map, Component::EXX);
  CHECK(deviation_from_unit(joined, map, Component::EXX, Interpolation::linear) == Approx(0.0));
  CHECK(deviation_from_unit(joined, map, Component::EXX, Interpolation::nearest) == Approx(4.0));
}

/// One axis, 0 … 200 mm: error −10 um at 200 (compensation +10), reversal ±1 um.
ExportSource one_axis() {
  ExportSource source;
  source.parameters.configuration = {'T', 'X', 0, 0, 0};
  source.parameters.axis_present = {true, false, false};
  source.travel_mm[0] = {0.0, 200.0};
  add_table(source, Component::EXX, {0, 200}, {1, 11}, {-1, 9});
  return source;
}

TEST_CASE("before compensation the residual is the error, afterwards nothing of what the map says") {
  const ExportSource source = one_axis();
  const auto made = must(linuxcnc_export(source, {}));
  const auto rows = must(residuals(source, made.applied, {}, errors_of_map(source)));
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].where == "line of X");
  CHECK(rows[0].places == 402);
  CHECK(rows[0].before.largest_um[0] == Approx(11.0));
  CHECK(rows[0].unit.largest_um[0] == Approx(0.0));
  CHECK(rows[0].control.largest_um[0] == Approx(0.0));
}

TEST_CASE("a unit that steps leaves half a step") {
  ExportSource source = one_axis();
  source.parameters.interpolation = Interpolation::nearest;
  const auto made = must(linuxcnc_export(source, {}));
  CHECK(made.tables[0].deviation == Approx(5.0));
  const auto rows = must(residuals(source, made.applied, {}, errors_of_map(source)));
  CHECK(rows[0].unit.largest_um[0] == Approx(5.0).epsilon(0.02));
  CHECK(rows[0].control.largest_um[0] == Approx(0.0));
}

TEST_CASE("an encoder table without cross tables leaves half the reversal") {
  const ExportSource source = one_axis();
  SiemensOptions options;
  options.most_tables = 0;
  const auto made = must(siemens_export(source, options));
  const auto rows = must(residuals(source, made.applied, {}, errors_of_map(source)));
  CHECK(rows[0].control.largest_um[0] == Approx(1.0));
  CHECK(rows[0].control.rms_um[0] == Approx(1.0));
}

TEST_CASE("a constant shift is no residual: it is counted from the reference point") {
  ExportSource source = one_axis();
  source.parameters.axes[0].datum.reference_position_mm = 200.0;  // siemens shifts its table by 10 um
  const auto made = must(siemens_export(source, {}));
  CHECK(made.tables[0].shift == Approx(10.0));
  const auto rows = must(residuals(source, made.applied, {}, errors_of_map(source)));
  CHECK(rows[0].before.largest_um[0] == Approx(11.0));  // at 0, seen from 200
  CHECK(rows[0].control.largest_um[0] < 0.001);
}

TEST_CASE("errors given from elsewhere replace the map, and their problem is returned") {
  const ExportSource source = one_axis();
  const auto made = linuxcnc_export(source, {});
  const auto rows = must(residuals(source, made->applied, {}, [](const std::vector<MachinePlace>& places) {
    return Result<std::vector<Vector3>>(std::vector<Vector3>(places.size(), Vector3{}));
  }));
  CHECK(rows[0].before.largest_um[0] == 0.0);
  CHECK(rows[0].control.largest_um[0] == Approx(11.0));  // compensated what is not there
  CHECK_FALSE(residuals(source, made->applied, {}, [](const auto&) -> Result<std::vector<Vector3>> {
    return problem(ProblemKind::bad_input, "no");
  }));
}

}  // namespace
}  // namespace ecs::controllers
