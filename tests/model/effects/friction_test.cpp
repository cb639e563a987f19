// Friction at reversals: the shape over time, and where it may be sought.
#include "model/regression/candidates.hpp"
#include "model/regression/needs.hpp"
#include "model/regression/regressors.hpp"
#include "tests/model/support/made_paths.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// A line along X with readings so long after the reversal [s].
Observations at_times(const std::vector<double>& since_s) {
  laser::MeasurementSet set;
  for (std::size_t i = 0; i < since_s.size(); ++i) {
    Reading reading;
    reading.row = static_cast<int>(i) + 1;
    reading.position_mm[0] = 10.0 * static_cast<double>(i);
    reading.approach = Approach::forward;
    reading.extras[std::string(kTimeSinceReversalColumn)] = since_s[i];
    set.readings.push_back(reading);
  }
  return observations_of(set, Model{}, mill());
}

bool has_note_of_friction(const Observations& data) {
  const auto notes = untried_effects(data);
  return std::any_of(notes.begin(), notes.end(), [](const std::string& note) { return contains(note, "friction"); });
}

laser::CircleTest still_circle() {
  return made_circle([](const PathPlace&) { return Vector3{}; });
}

}  // namespace

TEST_CASE("an axis held by friction falls behind with the square of the time, then catches up smoothly") {
  const Observations data = at_times({0.0, 0.03, 0.06, 0.085, 0.31});
  const Columns columns = Regressors(data).columns(effect(friction, Axis::X, Sense::EX), 60.0);
  CHECK(columns.of(0, 0) == 0.0);
  CHECK(columns.of(1, 0) == Approx(0.25 * columns.of(2, 0)));
  CHECK(columns.of(2, 0) == Approx(-0.859).epsilon(1e-3));
  CHECK(columns.of(3, 0) == Approx((1.0 + 0.025 * (40.0 + 2.0 / 0.06)) / std::exp(1.0) * columns.of(2, 0)));
  CHECK(std::abs(columns.of(4, 0)) < 1e-3);
  for (int k = 0; k < 3; ++k) CHECK(columns.of(k, 1) == Approx(0.0));
  CHECK(columns.of(3, 1) < -0.2);  // a slower drive is still further behind
}

TEST_CASE("an axis that lets go changes neither its place nor its speed at once, and is 1 behind at most") {
  const double before = 0.0599, at = 0.06, after = 0.0601, largest = 0.06 + 0.025 - 1.0 / (40.0 + 2.0 / 0.06);
  const Observations data = at_times({before, at, after, largest - 1e-4, largest, largest + 1e-4});
  const Columns columns = Regressors(data).columns(effect(friction, Axis::X, Sense::EX), 60.0);
  CHECK(columns.of(2, 0) - columns.of(1, 0) == Approx(columns.of(1, 0) - columns.of(0, 0)).epsilon(0.01));
  CHECK(columns.of(4, 0) == Approx(-1.0));
  CHECK(columns.of(3, 0) > -1.0);
  CHECK(columns.of(5, 0) > -1.0);
}

TEST_CASE("while friction holds an axis it still has the lost motion of before, b d less than backlash says") {
  const Observations data = at_times({0.0, 0.03, 0.059, 0.061, 0.31});
  const Regressors regressors(data);
  const Columns held = regressors.columns(effect(friction, Axis::X, Sense::EX), 60.0);
  const Columns lost = regressors.columns(effect(backlash, Axis::X, Sense::EX), 0.0);
  const double b_um = 3.0;
  for (int k = 0; k < 5; ++k) {
    const double shown_um = b_um * lost.of(k, 0) + b_um * held.of(k, 2);
    CHECK(shown_um == Approx(k < 3 ? -1.5 : 1.5));
  }
}

TEST_CASE("at a higher acceleration the axis stands for a shorter time and stays a little further behind") {
  const auto peak_at = [](double feed_mm_min) {
    CircleMade made{.readings = 3600, .runs = 1};
    laser::CircleTest test = made_circle([](const PathPlace&) { return Vector3{}; }, made);
    test.feed_mm_min = feed_mm_min;
    const Observations data = observations_of(set_of_circle(test), Model{}, mill());
    const Observations& motions = data.motions();
    std::pair<double, double> largest;  // size at most, and the time until which it stands
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const double since_s = motions.extras.at(std::string(kTimeSinceReversalColumn))[k];
      if (motions.axis[k] != Axis::Y || motions.sense[k] != Sense::EY || std::isnan(since_s)) continue;
      std::array<double, 3> row{};
      const EffectInstance held = effect(friction, Axis::Y, Sense::EY);
      friction->columns({motions, k, held, 60.0}, row);
      largest.first = std::max(largest.first, std::abs(row[0]));
      if (row[2] != 0.0) largest.second = std::max(largest.second, since_s);
    }
    return largest;
  };
  const auto [size, time_s] = peak_at(2000.0);
  const auto [faster_size, faster_time_s] = peak_at(4000.0);  // four times the acceleration
  CHECK(faster_size / size == Approx(std::pow(4.0, 1.0 / 12.0)).epsilon(0.02));
  CHECK(faster_time_s / time_s == Approx(0.5).epsilon(0.1));
}

TEST_CASE("friction is sought on circles of known feed, of each axis along itself") {
  std::vector<std::string> names;
  for (const EffectInstance& one : candidate_instances(observations_of(set_of_circle(still_circle()), Model{}, mill())))
    if (one.id == friction) names.push_back(to_text(one));
  CHECK(names == std::vector<std::string>{"friction:X:EX", "friction:Y:EY"});
}

TEST_CASE("a circle without its feed says that friction cannot be tried, and lines say nothing of it") {
  laser::CircleTest test = still_circle();
  CHECK_FALSE(has_note_of_friction(observations_of(set_of_circle(test), Model{}, mill())));
  test.feed_mm_min.reset();
  CHECK(has_note_of_friction(observations_of(set_of_circle(test), Model{}, mill())));
  const auto line = measured(Plan{}, 0.2, nothing);
  CHECK_FALSE(has_note_of_friction(observations_of(line, Model{}, mill())));
}

TEST_CASE("the time since a reversal on a circle is the way along it at its feed") {
  const Path path{PathKind::circle, "XY", {Axis::X, Axis::Y}, 100.0, {}, {}};
  const double angle = 0.1;
  const PlaceOnPath place = place_on(path, {100.0 * std::cos(angle), 100.0 * std::sin(angle), 0.0}, 1);
  CHECK(place.path_since_reversal_mm[0].value() == Approx(10.0));
  CHECK_FALSE(place.path_since_reversal_mm[1].has_value());
  const PlaceOnPath before = place_on(path, {100.0 * std::cos(angle), -100.0 * std::sin(angle), 0.0}, 1);
  CHECK_FALSE(before.path_since_reversal_mm[0].has_value());
}
