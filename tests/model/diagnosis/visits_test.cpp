// Points in space that are seen again and again, each time displaced and turned as one rigid body.
#include "model/diagnosis/visits.hpp"

#include "model/fit/noise.hpp"
#include "tests/model/support/real_sets.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

struct Visits {
  std::size_t visits = 8, points = 5;
  double shift_um = 30.0, turn_um_per_m = 60.0, noise_um = 1.0;  ///< standard deviations of a coordinate
  unsigned seed = 1;
  bool by_column = false;  ///< a column `session` numbers pairs of visits, which move together
};

constexpr Vector3 kPoints_mm[] = {{0, 0, 0}, {800, 0, 100}, {0, 600, 250}, {500, 400, 700}, {900, 650, 30}};
constexpr Vector3 kCentre_mm = {440, 330, 216};  // of all five

/// Each reading: the motion of its visit, an error of its own point, and noise.
Set visited(const Visits& plan) {
  Set set;
  std::mt19937_64 random(plan.seed);
  NormalDraws normal;
  std::array<double, 6> motion{};
  for (std::size_t visit = 0; visit < plan.visits; ++visit) {
    const std::size_t session = visit / 2;
    if (!plan.by_column || visit % 2 == 0)
      for (std::size_t i = 0; i < 6; ++i) motion[i] = (i < 3 ? plan.shift_um : plan.turn_um_per_m) * normal(random);
    for (std::size_t p = 0; p < plan.points; ++p) {
      const Vector3& at = kPoints_mm[p];
      const double lever_m[] = {(at[0] - kCentre_mm[0]) / 1000.0, (at[1] - kCentre_mm[1]) / 1000.0,
                                (at[2] - kCentre_mm[2]) / 1000.0};
      const double turned[] = {motion[4] * lever_m[2] - motion[5] * lever_m[1],
                               motion[5] * lever_m[0] - motion[3] * lever_m[2],
                               motion[3] * lever_m[1] - motion[4] * lever_m[0]};
      for (std::size_t i = 0; i < 3; ++i) {
        const double of_point_um = 20.0 * std::sin(static_cast<double>(3 * p + i));
        Reading& r = added(set, static_cast<Axis>(i), static_cast<Sense>(i), at,
                           of_point_um + motion[i] + turned[i] + plan.noise_um * normal(random));
        r.run = static_cast<int>(visit) + 1;
        if (plan.by_column) r.extras["session"] = static_cast<double>(session);
      }
    }
  }
  return set;
}

Model offsets_of_space() { return offsets({{Axis::X, Sense::EX}, {Axis::Y, Sense::EY}, {Axis::Z, Sense::EZ}}); }

Diagnosis diagnosed_space(const Set& set) {
  const Model model = offsets_of_space();
  return must(diagnose(model, observations_of(set, model, std::nullopt)));
}

std::optional<MotionsOfGroups> motions_in(const Set& set) {
  const Observations data = observations_of(set, Model{}, std::nullopt);
  return motions_of_groups(
      data, Eigen::Map<const Eigen::VectorXd>(data.reading.data(), static_cast<Eigen::Index>(data.size())));
}

}  // namespace

TEST_CASE("a rigid motion of each visit is found with its size, and readings left out of its fit show it") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto motions = must(motions_in(visited({.visits = 40, .seed = seed})));
    CHECK(motions.by == "run");
    CHECK(motions.groups == 40);
    CHECK(motions.shift_um == Approx(30.0).epsilon(0.2));  // 120 draws: known to 6 %, less the common motion
    CHECK(motions.turn_um_per_m == Approx(60.0).epsilon(0.2));
    CHECK(motions.rms_before_um > 30.0);
    CHECK(motions.rms_after_um < 1.0);
    CHECK(motions.held_out_rms_um < 4.0);
  }
}

TEST_CASE("no reading of a visit that arrives far off is an outlier, a single one that is far off is") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Set set = visited({.seed = seed});
    for (std::size_t k = 0; k < 15; ++k) set.readings[k].error += k % 5 == 0 ? 400.0 : 200.0;
    const Observations data = observations_of(set, Model{}, std::nullopt);
    const auto outliers_of = [&](const Observations& some) {
      const Eigen::VectorXd off =
          Eigen::Map<const Eigen::VectorXd>(some.reading.data(), static_cast<Eigen::Index>(some.size()));
      return std::ranges::count(isolated_outliers(some, off), true);
    };
    CHECK(outliers_of(data) == 0);
    Set one = visited({.seed = seed});
    one.readings[40].error += 2000.0;
    CHECK(outliers_of(observations_of(one, Model{}, std::nullopt)) == 1);
  }
}

TEST_CASE("the answer begins with the motions of the visits, and is not that the model is adequate") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Diagnosis found = diagnosed_space(visited({.seed = seed}));
    INFO(summary_of(found));
    CHECK(found.headline.starts_with("Each visit (run) has a rigid motion of its own: all points are displaced"));
    CHECK(contains(found.headline, "No map corrects that"));
    CHECK(contains(found.headline, "Repeat with one way of approach."));
    CHECK(found.verdict != Verdict::adequate);
    REQUIRE_FALSE(found.where.empty());
    CHECK(found.where.front().variable == "run");
  }
}

TEST_CASE("visits that move together by a column are grouped by that column") {
  const auto motions = must(motions_in(visited({.visits = 12, .by_column = true})));
  CHECK(motions.by == "session");
  CHECK(motions.groups == 6);
}

TEST_CASE("without motions none is named, whatever the points have of errors of their own") {
  int named = 0;
  for (unsigned seed = 1; seed <= 200; ++seed)
    for (const std::size_t points : {3U, 5U})
      named += motions_in(visited({.points = points, .shift_um = 0.0, .turn_um_per_m = 0.0, .seed = seed})) ? 1 : 0;
  CHECK(named == 0);
}

TEST_CASE("errors of single points are no cause: so few points cannot tell") {
  for (const std::size_t points : {3U, 4U, 5U})
    for (unsigned seed = 1; seed <= 8; ++seed) {
      std::mt19937_64 random(seed);
      NormalDraws normal;
      Set set = visited({.visits = 10, .points = points, .shift_um = 0.0, .turn_um_per_m = 0.0, .seed = seed});
      std::map<std::pair<Vector3, Sense>, double> own;
      for (Reading& r : set.readings)
        r.error += own.try_emplace({r.position_mm, r.sense}, 30.0 * normal(random)).first->second;
      const Model model = offsets_of_space();
      const Diagnosis found = must(diagnose(model, observations_of(set, model, mill())));
      INFO(summary_of(found));
      CHECK(found.verdict != Verdict::adequate);
      CHECK(std::ranges::none_of(found.candidates, &Candidate::in_answer));
    }
}

TEST_CASE("an effect that leaves no point to be predicted has no chance of its own, one that predicts them has") {
  const Set set = visited({.visits = 10, .shift_um = 0.0, .turn_um_per_m = 0.0});
  const Observations data = observations_of(set, Model{}, std::nullopt);
  CHECK(are_scattered_points(data));
  const auto n = static_cast<Eigen::Index>(data.size());
  Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(n, 1), slope = zero, free = Eigen::MatrixXd::Zero(n, 4), visit = zero;
  Eigen::VectorXd target(n), errors(n);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const bool along = data.sense[k] == Sense::EX;
    zero(i, 0) = along ? 1.0 : 0.0;
    slope(i, 0) = along ? data.position_mm[k][1] / 1000.0 : 0.0;
    visit(i, 0) = along ? data.run[k] : 0.0;
    for (Eigen::Index j = 0; j < 4; ++j) free(i, j) = along && data.position_mm[k] == kPoints_mm[j + 1] ? 1.0 : 0.0;
    target(i) = 100.0 * slope(i, 0) + 0.1 * std::sin(static_cast<double>(i));
    errors(i) = data.reading[k];
  }
  const std::vector<bool> all(data.size(), false);
  CHECK(must(chance_of_points(data, all, zero, slope, target)) < 1e-6);
  CHECK(must(chance_of_points(data, all, zero, slope, errors)) > 0.01);
  CHECK(must(chance_of_points(data, all, zero, free, target)) == 1.0);
  CHECK_FALSE(chance_of_points(data, all, zero, visit, target));
  // in its own sense a slope is like a turned set-up of the base, which the other sense tells from it
  Eigen::MatrixXd turned = slope;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.sense[k] == Sense::EY) turned(static_cast<Eigen::Index>(k), 0) = -data.position_mm[k][0] / 1000.0;
  CHECK(must(chance_of_points(data, all, turned, slope, target)) < 1e-6);
}

TEST_CASE("points on a line, and senses that were measured apart, show no rigid motion") {
  Set on_line = visited({.seed = 4});
  for (Reading& r : on_line.readings) r.position_mm = {r.position_mm[0], 0.0, 0.0};
  CHECK_FALSE(motions_in(on_line));
  Set apart = visited({.seed = 4});
  std::ranges::stable_sort(apart.readings, {}, [](const Reading& r) { return r.sense; });
  CHECK_FALSE(motions_in(apart));
}

TEST_CASE("a robot that reaches its pose in any way arrives elsewhere each time, as one body") {
  SKIP_UNLESS(!real_data("robot-tracker").empty(), kNoRealData);
  const auto read = [](const std::string& name) {
    laser::ImportOptions options;
    options.mapping =
        must(laser::column_mapping("point=1,measured_x_mm=2[mm],measured_y_mm=3[mm],measured_z_mm=4[mm]"));
    return must(laser::read_any(real_data("robot-tracker/" + name), options)).set;
  };
  const auto motions = must(motions_in(read("anfahrt_pose1.txt")));
  CHECK(motions.by == "run");
  CHECK(motions.rms_before_um == Approx(97.0).epsilon(0.01));  // both figures published with the data
  CHECK(motions.rms_after_um == Approx(2.6).epsilon(0.02));
  CHECK(motions.held_out_rms_um < 0.2 * motions.rms_before_um);
  CHECK(diagnosed_space(read("anfahrt_pose1.txt")).headline.starts_with("Each visit (run) has a rigid motion"));
  CHECK_FALSE(
      motions_in(read("pose1.txt")));  // reached one way: 4.2 um, which the motions reduce no more than by chance
}
