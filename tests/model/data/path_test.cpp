#include "model/data/motions.hpp"
#include "tests/model/support/made_paths.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

Path circle_in_xy() { return path_in("circle XY radius 100 centre 400 300 -50").value(); }
Vector3 no_errors(const PathPlace&) { return {}; }

}  // namespace

TEST_CASE("a path is read back from its text, and other texts are none") {
  for (const char* text : {"circle XY radius 100 centre 400 300 -50.25", "diagonal PNP from 0 500 0 to 800 0 400"}) {
    CHECK(to_text(must(path_in(text))) == text);
  }
  CHECK(name_of(circle_in_xy()) == "circle XY");
  CHECK(axes_of(path_in("diagonal PN0 from 0 500 7 to 800 0 7").value()) == "XY");
  for (const char* text : {"", "left", "circle XX radius 100 centre 0 0 0", "circle XY radius 0 centre 0 0 0",
                           "circle XY radius 100 centre 0 0", "diagonal PPP from 1 1 1 to 1 1 1"})
    CHECK_FALSE(path_in(text));
}

TEST_CASE("on a circle each axis has the approach of its own motion and the travel since its own reversal") {
  const double c = std::cos(0.5), s = std::sin(0.5);
  const PlaceOnPath first = place_on(circle_in_xy(), {400.0 + 100.0 * c, 300.0 + 100.0 * s, -50.0}, 1);
  CHECK(first.along == Approx(0.5 * 180.0 / std::numbers::pi));
  CHECK(first.direction[0] == Approx(c));
  CHECK(first.direction[1] == Approx(s));
  CHECK(first.direction[2] == 0.0);
  CHECK(first.approach == std::array<int, 3>{-1, 1, 0});
  CHECK_FALSE(first.since_reversal_mm[0]);  // 12 mm, beyond a tenth of the radius
  const PlaceOnPath near =
      place_on(circle_in_xy(), {400.0 + 100.0 * std::cos(0.1), 300.0 + 100.0 * std::sin(0.1), -50.0}, 1);
  CHECK(*near.since_reversal_mm[0] == Approx(100.0 * (1.0 - std::cos(0.1))));
  CHECK_FALSE(near.since_reversal_mm[1]);
  CHECK(first.share_of_feed[0] == Approx(s));
  const PlaceOnPath other_way = place_on(circle_in_xy(), {400.0 + 100.0 * c, 300.0 + 100.0 * s, -50.0}, -1);
  CHECK(other_way.approach == std::array<int, 3>{1, -1, 0});
}

TEST_CASE("at its reversal an axis still has the approach with which it arrived") {
  const PlaceOnPath at = place_on(circle_in_xy(), {500.0, 300.0, -50.0}, 1);
  CHECK(at.approach == std::array<int, 3>{1, 1, 0});
  CHECK_FALSE(at.since_reversal_mm[0]);
}

TEST_CASE("along a diagonal an axis that runs against it approaches the other way") {
  const Path path = path_in("diagonal PN0 from 0 400 7 to 300 0 7").value();
  const PlaceOnPath place = place_on(path, {150.0, 200.0, 7.0}, -1);
  CHECK(place.along == Approx(250.0));
  CHECK(place.direction[0] == Approx(0.6));
  CHECK(place.direction[1] == Approx(-0.8));
  CHECK(place.approach == std::array<int, 3>{-1, 1, 0});
}

TEST_CASE("centre and radius of each pass of a circle and the zero of each run of a diagonal are no error") {
  const Observations circle =
      observations_of(set_of_circle(made_circle(no_errors, {.noise_um = 0.0})), Model{}, mill());
  for (const double reading : circle.reading) CHECK(std::abs(reading) < 1e-9);
  const Observations body = observations_of(made_diagonals(no_errors, 0.0), Model{}, mill());
  for (const double reading : body.reading) CHECK(std::abs(reading) < 1e-9);
  CHECK(body.paths.size() == 4);
}

TEST_CASE("a circle beside a line leaves the line as it is") {
  laser::MeasurementSet set = measured({}, 0.2, nothing);
  const Observations alone = observations_of(set, Model{}, mill());
  for (Reading& reading : set_of_circle(made_circle(no_errors)).readings) set.readings.push_back(reading);
  const Observations both = observations_of(set, Model{}, mill());
  const Observations lines = without_paths(both);
  CHECK(lines.size() == alone.size());
  std::vector<double> before = alone.reading, after = lines.reading;
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  CHECK(before == after);
  CHECK_FALSE(lines.moved);
  CHECK(both.motions().size() == alone.size() + 4 * 720);
}

TEST_CASE("a cell of column path that is no path is an extra column like any other") {
  laser::MeasurementSet set = measured({}, 0.2, nothing);
  for (Reading& reading : set.readings) reading.text_extras["path"] = "along the table";
  CHECK(observations_of(set, Model{}, mill()).paths.empty());
}

TEST_CASE("a circle without its centre counts from it and says so; step diagonals are refused") {
  laser::CircleTest test = made_circle(no_errors);
  test.centre_mm = {};
  const laser::MeasurementSet set = set_of_circle(test);
  CHECK(contains(only(set.notes), "no centre_x_mm and centre_y_mm"));
  laser::DiagonalTest steps;
  steps.steps = true;
  CHECK(contains(must_fail(set_of_diagonals(steps)).message, "expected diagonal, found step"));
}
