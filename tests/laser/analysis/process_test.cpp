// What is done to curves, against numbers worked by hand.
#include "laser/analysis/process.hpp"

#include <rapidcheck.h>

#include "core/terms.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

double reversal(const CurvePoint& point) { return *point.forward - *point.reverse; }

Curve single_line(Axis axis, Sense sense, const std::vector<std::pair<double, double>>& values) {
  Curve curve{.axis = axis, .sense = sense, .merge_tolerance_mm = 0.01};
  for (const auto& [position_mm, value] : values) {
    CurvePoint point;
    point.position_mm = position_mm;
    point.forward = point.reverse = value;
    point.forward_count = point.reverse_count = 1;
    curve.points.push_back(point);
  }
  return curve;
}

}  // namespace

TEST_CASE("averaging sorts targets and gives mean, count and deviation of each approach") {
  const Curve curve = curve_of({{100.0, {3.0, 5.0}, {1.0}}, {0.0, {1.0, 1.0}, {}}});
  REQUIRE(curve.points.size() == 2);
  CHECK(curve.points[0].position_mm == 0.0);
  CHECK_FALSE(curve.points[0].reverse.has_value());
  CHECK(*curve.points[1].forward == Approx(4.0));
  CHECK(*curve.points[1].forward_std == Approx(std::sqrt(2.0)));
  CHECK(curve.points[1].forward_count == 2);
  CHECK_FALSE(curve.points[1].reverse_std.has_value());
  CHECK(*mean_of(curve.points[1]) == Approx(2.5));
}

TEST_CASE("readings of unknown approach serve both directions and say so") {
  MeasurementSet set;
  set.readings = {reading(Axis::X, Sense::EX, 0.0, 1.0), reading(Axis::X, Sense::EX, 0.0, 3.0)};
  const auto curve = must(averaged(set, groups_of(set).front()));
  CHECK_FALSE(curve.approach_known);
  CHECK(curve.points[0].forward == 2.0);
  CHECK(curve.points[0].reverse == 2.0);
  CHECK(*mean_std_error(curve.points[0], false) == Approx(1.0));
}

TEST_CASE("exclusions leave readings out and the data alone") {
  MeasurementSet set = set_of({{0.0, {1.0, 9.0}, {1.0}}, {10.0, {2.0, 9.0}, {2.0}}});
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].row = static_cast<int>(i) + 1;
  Exclusion run_2;
  run_2.run = 2;
  Exclusion row_4{.row = 4, .approach = Approach::reverse};
  const Selection selection = selected(set, {run_2, row_4, Exclusion{}});
  CHECK(set.readings.size() == 6);
  CHECK(selection.chosen.readings.size() == 4);
  CHECK(selection.left_out == std::vector<std::size_t>{2, 0, 0});
  CHECK(says(selection.notes, "exclusion 2 fits no reading"));
}

TEST_CASE("the end point slope is that of the means, and the reversal error stays") {
  const Curve curve = curve_of({{-100.0, {11.0}, {9.0}}, {0.0, {17.0}, {13.0}}, {100.0, {31.0}, {29.0}}});
  const auto result = must(levelled(curve, SlopeMethod::end_points));
  CHECK(result.removed.slope_per_m == Approx(100.0));
  CHECK(result.removed.offset == Approx(20.0));
  CHECK(*mean_of(result.curve.points[0]) == Approx(0.0));
  CHECK(*mean_of(result.curve.points[1]) == Approx(-5.0));
  CHECK(*mean_of(result.curve.points[2]) == Approx(0.0));
  for (std::size_t i = 0; i < 3; ++i) CHECK(reversal(result.curve.points[i]) == Approx(reversal(curve.points[i])));
}

TEST_CASE("the least squares slope and its standard error agree with the hand") {
  const Curve curve = single_line(Axis::X, Sense::EY, {{0.0, 0.0}, {1000.0, 1.0}, {2000.0, 0.0}});
  const auto result = must(levelled(curve, SlopeMethod::least_squares));
  CHECK(result.removed.slope_per_m == Approx(0.0));
  CHECK(result.removed.offset == Approx(1.0 / 3.0));
  CHECK(*result.slope_std_error_per_m == Approx(1.0 / std::sqrt(3.0)));
}

TEST_CASE("a target with one approach only does not tilt the slope by its reversal error") {
  const Curve curve = curve_of({{0.0, {5.0}, {-5.0}}, {100.0, {5.0}, {-5.0}}, {200.0, {5.0}, {}}});
  for (const SlopeMethod method : {SlopeMethod::end_points, SlopeMethod::least_squares})
    CHECK(levelled(curve, method)->removed.slope_per_m == Approx(0.0));
}

TEST_CASE("no slope is removed where none is asked for, and one target has none") {
  const Curve curve = curve_of({{0.0, {5.0}, {}}});
  CHECK(levelled(curve, SlopeMethod::none)->curve == curve);
  CHECK_FALSE(levelled(curve, SlopeMethod::least_squares).has_value());
}

TEST_CASE("slope removal takes exactly an added line and nothing the second time") {
  CHECK(rc::check([] {
    std::vector<Stop> stops;
    const int count = *rc::gen::inRange(3, 12);
    const double slope_um_per_m = *rc::gen::inRange(-300, 300);
    const double offset_um = *rc::gen::inRange(-50, 50);
    std::vector<Stop> tilted;
    for (int i = 0; i < count; ++i) {
      const double at_mm = 40.0 * i - 100.0;
      const double forward = *rc::gen::inRange(-900, 900) / 10.0;
      const double reverse = *rc::gen::inRange(-900, 900) / 10.0;
      const double line = offset_um + slope_um_per_m * at_mm / 1000.0;
      stops.push_back({at_mm, {forward}, {reverse}});
      tilted.push_back({at_mm, {forward + line}, {reverse + line}});
    }
    for (const SlopeMethod method : {SlopeMethod::end_points, SlopeMethod::least_squares}) {
      const auto plain = levelled(curve_of(stops), method);
      const auto with_line = levelled(curve_of(tilted), method);
      RC_ASSERT(std::abs(with_line->removed.slope_per_m - plain->removed.slope_per_m - slope_um_per_m) < 1e-8);
      RC_ASSERT(std::abs(with_line->removed.offset - plain->removed.offset - offset_um) < 1e-9);
      for (std::size_t i = 0; i < plain->curve.points.size(); ++i) {
        RC_ASSERT(std::abs(*plain->curve.points[i].forward - *with_line->curve.points[i].forward) < 1e-9);
        RC_ASSERT(std::abs(*plain->curve.points[i].reverse - *with_line->curve.points[i].reverse) < 1e-9);
      }
      const auto again = levelled(plain->curve, method);
      RC_ASSERT(std::abs(again->removed.slope_per_m) < 1e-8);
      RC_ASSERT(std::abs(again->removed.offset) < 1e-9);
    }
  }));
}

TEST_CASE("at the datum the bidirectional mean becomes zero") {
  const Curve curve = curve_of({{0.0, {2.0}, {0.0}}, {100.0, {6.0}, {4.0}}});
  const auto result = must(zeroed_at(curve, 25.0));
  CHECK(result.removed == Approx(2.0));
  CHECK(*result.curve.points[0].forward == Approx(0.0));
  CHECK(*result.curve.points[1].reverse == Approx(2.0));
  CHECK_FALSE(zeroed_at(curve, 101.5).has_value());
  CHECK(zeroed_at(curve, 100.0)->removed == Approx(5.0));
}

TEST_CASE("a line and its lever give the angle in the signs of the rigid-body model, on every chain") {
  int tested = 0;
  for (const char* const configuration : {"TXYZ", "XTYZ", "XYTZ", "XYZT", "TZYX"}) {
    const auto terms = must(terms_of(*chain_of(configuration), Convention::iso, CurveKind::measured));
    for (const Term& term : terms) {
      if (!is_angular(term.component) || !term.has_lever || !term.uses_coordinate) continue;
      const Axis moving = moving_axis(term.component);
      if (term.lever == moving) continue;
      const double value_um_per_m = 30.0;
      const auto line_at = [&](double lever_mm) {
        const double error_um = term.sign * value_um_per_m * lever_mm / 1000.0;
        Curve line = single_line(moving, static_cast<Sense>(index_of(term.observed)), {{0.0, 0.0}, {100.0, error_um}});
        line.parked_mm[index_of(term.lever)] = lever_mm;
        return line;
      };
      const auto angle = must(rotation_from(line_at(0.0), line_at(-1000.0)));
      CHECK(curve_of(angle.sense, angle.axis) == term.component);
      CHECK(*angle.points[1].forward == Approx(value_um_per_m));
      CHECK(*rotation_from(line_at(-1000.0), line_at(0.0))->points[1].reverse == Approx(value_um_per_m));
      ++tested;
    }
  }
  CHECK(tested > 20);
}

TEST_CASE("lines with other targets are interpolated inside their overlap") {
  Curve first = single_line(Axis::X, Sense::EX, {{0.0, 0.0}, {100.0, 0.0}, {200.0, 0.0}});
  Curve second = single_line(Axis::X, Sense::EX, {{-50.0, -5.0}, {150.0, -25.0}});
  second.parked_mm[2] = -500.0;
  const auto yaw = must(rotation_from(first, second));
  REQUIRE(yaw.points.size() == 2);
  CHECK(yaw.sense == Sense::EB);
  CHECK(*yaw.points[0].forward == Approx(20.0));
  CHECK(*yaw.points[1].forward == Approx(40.0));
  CHECK(says(yaw.notes, "1 targets outside"));
}

TEST_CASE("the scatter of two lines adds up in the angle") {
  Curve first = curve_of({{0.0, {1.0, 3.0}, {}}, {100.0, {1.0, 3.0}, {}}});
  Curve second = curve_of({{0.0, {0.0, 2.0}, {}}, {100.0, {0.0, 2.0}, {}}});
  second.parked_mm[2] = -2000.0;
  const auto yaw = must(rotation_from(first, second));
  // each mean has standard error 1 um; the difference √2 um over 2 m
  CHECK(*mean_std_error(yaw.points[0], true) == Approx(std::sqrt(2.0) / 2.0));
}

TEST_CASE("lines that give no angle are refused with the reason") {
  const Curve line = single_line(Axis::X, Sense::EX, {{0.0, 0.0}, {100.0, 1.0}});
  const auto parked = [&](double y, double z) {
    Curve other = line;
    other.parked_mm = {0.0, y, z};
    return other;
  };
  CHECK(contains(rotation_from(line, line).error().message, "the same"));
  CHECK(contains(rotation_from(line, parked(1.0, 1.0)).error().message, "two axes"));
  Curve other = parked(0.0, -100.0);
  other.sense = Sense::EY;
  CHECK(contains(rotation_from(line, other).error().message, "different errors"));
  Curve far = parked(0.0, -100.0);
  for (CurvePoint& point : far.points) point.position_mm += 1000.0;
  CHECK(contains(rotation_from(line, far).error().message, "0 targets in common"));
  Curve across = line;
  across.sense = Sense::EZ;
  Curve along = across;
  along.parked_mm[2] = -100.0;
  CHECK(contains(rotation_from(across, along).error().message, "no rotation acts"));
}

TEST_CASE("squareness of the thesis's machine comes out in our signs") {
  const auto run = [](Axis along, Sense sense, double um_per_m) {
    return *squareness_of(single_line(along, sense, {{-1000.0, -um_per_m}, {-500.0, -um_per_m / 2.0}, {0.0, 0.0}}));
  };
  CHECK(run(Axis::Y, Sense::EX, -16.0).component == Component::C0Y);
  CHECK(run(Axis::Y, Sense::EX, -16.0).um_per_m == Approx(16.0));
  CHECK(run(Axis::Y, Sense::EX, -16.0).indicator_slope_um_per_m == Approx(-16.0));
  CHECK(run(Axis::Z, Sense::EX, -38.8).component == Component::B0Z);
  CHECK(run(Axis::Z, Sense::EX, -38.8).um_per_m == Approx(-38.8));
  CHECK(run(Axis::Y, Sense::EZ, 66.93).component == Component::A0Z);
  CHECK(run(Axis::Y, Sense::EZ, 66.93).um_per_m == Approx(-66.93));
  CHECK(run(Axis::Z, Sense::EY, 66.93).um_per_m == Approx(-66.93));
  CHECK(*run(Axis::Z, Sense::EY, 66.93).std_error_um_per_m == Approx(0.0));
}

TEST_CASE("squareness is not found along the axis run along, nor from a rotation") {
  CHECK_FALSE(squareness_of(single_line(Axis::Y, Sense::EY, {{0.0, 0.0}, {1.0, 1.0}})).has_value());
  CHECK_FALSE(squareness_of(single_line(Axis::Y, Sense::EA, {{0.0, 0.0}, {1.0, 1.0}})).has_value());
}

TEST_CASE("a curve is put on a grid by linear interpolation, each approach on its own") {
  const Curve curve = curve_of({{0.0, {0.0, 0.0, 0.0}, {4.0}}, {50.0, {10.0, 12.0}, {}}, {100.0, {20.0}, {8.0}}});
  const auto result = must(resampled(curve, {0.0, 25.0, 5}));
  CHECK(*result.points[1].forward == Approx(5.5));
  CHECK(*result.points[2].forward == Approx(11.0));
  CHECK(result.points[2].forward_count == 2);
  CHECK(*result.points[2].reverse == Approx(6.0));
  CHECK(*result.points[4].reverse == Approx(8.0));
}

TEST_CASE("grids beyond the travel are refused unless the ends are held") {
  const Curve curve = curve_of({{0.0, {1.0}, {}}, {100.0, {2.0}, {}}});
  CHECK(resampled(curve, {-50.0, 50.0, 5}).error().kind == ProblemKind::refused);
  const auto held = must(resampled(curve, {-50.0, 50.0, 5}, Beyond::hold_end_value));
  CHECK(*held.points.front().forward == 1.0);
  CHECK(*held.points.back().forward == 2.0);
  CHECK_FALSE(held.points.front().reverse.has_value());
  CHECK(resampled(curve, {0.0, 0.0, 5}).error().kind == ProblemKind::usage);
  CHECK(resampled(curve, {0.0, 1.0, 0}).error().kind == ProblemKind::usage);
}
