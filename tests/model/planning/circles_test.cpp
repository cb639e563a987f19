// Circles among the proposals.
#include "model/planning/next_measurement.hpp"
#include "model/planning/questions.hpp"
#include "model/planning/run.hpp"
#include "tests/model/support/made_paths.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

MeasuringTimes with_ball_bar() { return {.ball_bar = true}; }

/// A line of X at one feed whose lost motion may also be its following error.
struct Tied {
  Observations data;
  Diagnosis diagnosis;
};
Tied lost_or_lagging() {
  const auto set = session(
      {}, [](const Reading& r) { return 1.0 * d(r); }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  Observations data = observations_of(set, straight(), mill());
  Diagnosis diagnosis = diagnose(straight(), data).value();
  return {std::move(data), std::move(diagnosis)};
}

/// A circle of Y at 36 places whose wrong reversals a spike explains as well as friction does.
struct Coarse {
  Observations data;
  Model model;
  Diagnosis diagnosis;
};
Coarse coarse_circle() {
  const CircleMade made{.readings = 90, .noise_um = 0.1};
  laser::MeasurementSet set = set_of_circle(made_circle(
      [](const PathPlace& at) {
        const double travelled_mm = 100.0 + at.motion[1] * (at.position_mm[1] - 300.0);
        return Vector3{0.0, -4.0 * at.motion[1] * std::exp(-travelled_mm / 0.05), 0.0};
      },
      made));
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  Coarse coarse{observations_of(set, Model{}, mill()), {}, {}};
  coarse.diagnosis = diagnose(coarse.model, coarse.data).value();
  return coarse;
}

const MeasurementProposal* first_circle(const NextMeasurement& next) {
  for (const MeasurementProposal& one : next.proposals)
    if (one.circle) return &one;
  return nullptr;
}

}  // namespace

TEST_CASE("without a ball bar lines are proposed alone, with one circles that tell lost motion from a lag") {
  const Tied tied = lost_or_lagging();
  CHECK(first_circle(next_measurement(straight(), tied.data, tied.diagnosis)) == nullptr);
  const NextMeasurement next = next_measurement(straight(), tied.data, tied.diagnosis, with_ball_bar());
  const MeasurementProposal* circle = first_circle(next);
  REQUIRE(circle != nullptr);
  CHECK(circle->separation_sigma > 3.0);
  CHECK(circle->minutes > 15.0);
  CHECK(contains(circle->sentence, "with a ball bar: radius"));
  CHECK(contains(circle->tells, "distinguishes "));
}

TEST_CASE("circles that are proposed lie inside the travels and are of ball bars") {
  const Tied tied = lost_or_lagging();
  const auto options = circle_options(tied.data, with_ball_bar());
  REQUIRE_FALSE(options.empty());
  for (const MeasurementProposal& one : options) {
    CAPTURE(one.condition);
    for (const Axis axis : one.circle->plane) {
      const auto& travel_mm = tied.data.machine.axes[index_of(axis)]->travel_mm;
      CHECK(one.circle->from_mm[index_of(axis)] - one.circle->radius_mm > travel_mm[0]);
      CHECK(one.circle->from_mm[index_of(axis)] + one.circle->radius_mm < travel_mm[1]);
    }
  }
}

TEST_CASE("after a coarse circle that leaves a spike or friction a circle that tells them apart is proposed first") {
  const Coarse coarse = coarse_circle();
  REQUIRE_FALSE(coarse.diagnosis.candidates.empty());
  REQUIRE_FALSE(coarse.diagnosis.candidates.front().rivals.empty());
  const NextMeasurement next = next_measurement(coarse.model, coarse.data, coarse.diagnosis);
  CHECK(next.rivals.size() == 2);
  REQUIRE_FALSE(next.proposals.empty());
  const MeasurementProposal& first = next.proposals.front();
  REQUIRE(first.circle);
  CHECK(contains(first.circle->name, 'Y'));
  CHECK(first.separation_sigma > 3.0);
  CHECK(first.first_run == 3);
}

TEST_CASE(
    "a circle takes its turns at its feed and its set-up, and is written as arcs and as a plan that is read back") {
  const auto options = circle_options(coarse_circle().data, {});
  const auto closer = std::find_if(options.begin(), options.end(), [](const MeasurementProposal& one) {
    return contains(one.condition, "three times as close");
  });
  REQUIRE(closer != options.end());
  MeasurementProposal one = *closer;
  CHECK(one.circle_step_deg == Approx(1.33));
  one.runs = 2;
  const double turns_min = 2.0 * 2.0 * 450.0 / 360.0 * 2.0 * std::numbers::pi * 100.0 / 2000.0;
  CHECK(minutes_of(one, {}) == Approx(5.0 + turns_min).epsilon(0.02));
  const std::string program = part_program(one, mill());
  check_holds(program,
              {"> G90G17\n", "$REP 2", "> G03X500.0Y300.0I-100.0J0.0F2000;", "> G02X500.0Y300.0I-100.0J0.0F2000;"});
  const auto plan = must(laser::parse_measurement_set(target_list(one), "targets.csv"));
  CHECK(plan.readings.size() == 2 * 2 * 271);
  const Observations rows = observations_of(plan, Model{}, mill());
  CHECK(has_circles(rows));
  CHECK(rows.path_of(0) == *one.circle);
}
