// Poses that are reached again and again: points that scatter on their own, a body that arrives elsewhere, two ways of
// approach; and the arm of a real robot.
#include "modules/standards/poses.hpp"

#include <cmath>
#include <map>

#include "base/random.hpp"
#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/real_data.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

struct Made {
  double shift_um = 0.0, turn_um_per_m = 0.0, noise_um = 2.0;
  int visits = 10;
  std::vector<Vector3> points{{0.0, 0.0, 0.0}, {120.0, 0.0, 0.0}, {30.0, 90.0, 150.0}};
};

MeasurementSet visits(const Made& made, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  MeasurementSet set;
  set.source = "made.csv";
  for (int visit = 1; visit <= made.visits; ++visit) {
    Vector3 shift{}, turn{};
    for (std::size_t d = 0; d < 3; ++d) {
      shift[d] = made.shift_um * normal(random);
      turn[d] = made.turn_um_per_m * normal(random);
    }
    for (const Vector3& p : made.points)
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
        Reading r{.row = static_cast<int>(set.readings.size()) + 1, .position_mm = p, .sense = static_cast<Sense>(d)};
        r.error = shift[d] + (turn[e] * p[f] - turn[f] * p[e]) / 1000.0 + made.noise_um * normal(random);
        r.run = visit;
        set.readings.push_back(r);
      }
  }
  return set;
}

}  // namespace

TEST_CASE("points that scatter on their own do not move as a whole") {
  int wrong = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) wrong += must(pose_test_of(visits({}, seed))).moves_as_a_whole();
  CHECK(wrong <= 2);  // one in a thousand is stated
}

TEST_CASE(
    "the accuracy of a pose is how far its barycentre lies from the commanded position, where a file states that") {
  MeasurementSet set = visits({.noise_um = 0.5}, 5);
  std::map<std::pair<double, Sense>, double> mean;
  for (const Reading& r : set.readings) mean[{r.position_mm[0], r.sense}] += r.error / 10.0;
  for (Reading& r : set.readings) r.error -= mean[{r.position_mm[0], r.sense}];
  for (const PosePoint& point : must(pose_test_of(set)).points) CHECK_FALSE(point.off_mm);
  for (Reading& r : set.readings) r.error += r.sense == Sense::EX ? 300.0 : r.sense == Sense::EY ? -400.0 : 0.0;
  for (const PosePoint& point : must(pose_test_of(set)).points) {
    const Vector3 off = must(point.off_mm);
    CHECK(off[0] == Approx(0.3));
    CHECK(off[1] == Approx(-0.4));
    CHECK(std::abs(off[2]) < 1e-9);
  }
}

TEST_CASE("a body that arrives elsewhere is found with the sizes of its motions, and the noise is left") {
  const PoseTest test = must(pose_test_of(visits({.shift_um = 60.0, .turn_um_per_m = 300.0, .visits = 400}, 3)));
  CHECK(test.moves_as_a_whole());
  CHECK(test.turn_um_per_m == Approx(300.0).epsilon(0.06));
  CHECK(test.rms_um > 60.0);
  CHECK(test.rms_after_um == Approx(2.0 * std::sqrt(3.0 / 9.0)).epsilon(0.1));  // three of nine freedoms are left
  CHECK(test.of_rest == 3 * 399);
}

TEST_CASE("readings without the motion of their visit keep the errors of the points, and have no motion left") {
  MeasurementSet set = visits({.shift_um = 60.0, .turn_um_per_m = 300.0, .noise_um = 0.5}, 4);
  for (Reading& r : set.readings) r.error += r.sense == Sense::EY ? 0.5 * r.position_mm[0] : 0.0;
  const PoseTest test = must(pose_test_of(set));
  const MeasurementSet rest = without_motions(set, test);
  const PoseTest again = must(pose_test_of(rest));
  CHECK(again.rms_um == Approx(test.rms_after_um).epsilon(1e-3));
  CHECK(again.shift_um < 1e-3);
  for (std::size_t p = 0; p < test.points.size(); ++p)
    CHECK(must(again.points[p].off_mm)[1] == Approx(must(test.points[p].off_mm)[1]).epsilon(1e-5));
  CHECK(metadata_value(rest, "removed") == "the rigid motion of each visit (run)");
}

TEST_CASE("two ways of approach differ by the motions of the body, a worse instrument by the scatter of the points") {
  const PoseTest one_way = must(pose_test_of(visits({.shift_um = 3.0}, 5)));
  const PoseTest any_way = must(pose_test_of(visits({.shift_um = 90.0, .turn_um_per_m = 400.0}, 6)));
  const PoseTest shaking = must(pose_test_of(visits({.shift_um = 3.0, .noise_um = 40.0}, 7)));
  CHECK(comparison_of(one_way, any_way).is_way_of_approach());
  CHECK(comparison_of(any_way, one_way).is_way_of_approach());
  CHECK_FALSE(comparison_of(one_way, shaking).is_way_of_approach());
  CHECK_FALSE(comparison_of(one_way, must(pose_test_of(visits({.shift_um = 3.0}, 8)))).is_way_of_approach());
  CHECK(*comparison_of(one_way, any_way).largest_shift_mm < 0.3);
}

TEST_CASE("repeatability is the mean distance from the barycentre and three standard deviations of it") {
  MeasurementSet set = visits({.noise_um = 0.0, .visits = 4}, 1);
  for (Reading& r : set.readings)  // 1 mm either way along X: all distances are 1 mm
    if (r.sense == Sense::EX) r.error = r.run % 2 == 0 ? 1000.0 : -1000.0;
  const PoseTest test = must(pose_test_of(set));
  for (const PosePoint& point : test.points) CHECK(point.repeatability_mm == Approx(1.0));
  CHECK(test.shift_um == Approx(1000.0 / std::sqrt(3.0)));
}

TEST_CASE("what a motion cannot be found from is refused with what is missing") {
  Made few{.points = {{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}}};
  CHECK(contains(to_text(must_fail(pose_test_of(visits(few, 1)))), "found 2 points in 10 visits"));
  few.points = {{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}, {20.0, 0.0, 0.0}};
  CHECK(contains(to_text(must_fail(pose_test_of(visits(few, 1)))), "not all on one line"));
  MeasurementSet gap = visits({}, 1);
  gap.readings.erase(gap.readings.begin() + 4);
  CHECK(contains(to_text(must_fail(pose_test_of(gap))), "visit 1: expected EX, EY and EZ of all 3 points"));
}

TEST_CASE("a robot's arm: from arbitrary poses it arrives elsewhere, and the tracker is not the cause") {
  SKIP_UNLESS(!real_data("robot-tracker").empty(), kNoRealData);
  const auto test_of = [](const char* name) {
    const auto read = must(read_any(real_data(std::string("robot-tracker/") + name),
                                    by_columns("point=1,measured_x_mm=2,measured_y_mm=3,measured_z_mm=4")));
    return must(pose_test_of(read.set));
  };
  const PoseTest one_way = test_of("pose1.txt"), any_way = test_of("anfahrt_pose1.txt");
  const std::array<double, 3> published{0.0130, 0.0154, 0.0173}, published_any{0.4480, 0.5604, 0.2553};
  for (std::size_t p = 0; p < 3; ++p) {
    CHECK(one_way.points[p].repeatability_mm == Approx(published[p]).epsilon(0.004));
    CHECK(any_way.points[p].repeatability_mm == Approx(published_any[p]).epsilon(0.0004));
  }
  CHECK(one_way.rms_um == Approx(4.2).epsilon(0.01));
  CHECK(any_way.rms_um == Approx(96.7).epsilon(0.001));
  CHECK(one_way.rms_after_um == Approx(2.56).epsilon(0.01));
  CHECK(any_way.rms_after_um == Approx(2.54).epsilon(0.01));
  CHECK_FALSE(one_way.moves_as_a_whole());
  CHECK(any_way.moves_as_a_whole());
  CHECK(comparison_of(one_way, any_way).is_way_of_approach());
}
