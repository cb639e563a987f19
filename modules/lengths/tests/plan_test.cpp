// Plans of lengths: they reach what was asked, and measured they give the uncertainty that they promised.
#include "modules/lengths/plan_lengths.hpp"
#include "modules/lengths/tests/support/made_lengths.hpp"

namespace ecs::test {
namespace {

model::LengthPlanSettings small_plan() {
  model::LengthPlanSettings settings{.volume_U_um = 1.0, .instrument_um = 0.5, .scatter_um = 0.0};
  for (auto& knots : settings.knots_mm) knots = 250.0;
  return settings;
}

TEST_CASE("a tracker's plan promises the uncertainty that its lengths then have") {
  MadeLengths lengths("XYTZ");
  const auto plan = must(model::planned_lengths(lengths.machine, small_plan()));
  CHECK(plan.reached);
  CHECK(plan.volume_U_um <= 1.0);
  CHECK(plan.minutes > plan.set_up_minutes);
  CHECK(plan.single.reached);
  CHECK(plan.minutes < plan.single.minutes);
  lengths.test = plan.test;
  const MadeComponents made(11);
  lengths.measure(made, 0.5, 3);
  const model::Identification found = identified(lengths, {});
  CHECK(found.whole());
  REQUIRE(found.volume_um.has_value());
  CHECK(2.0 * *found.volume_um == Approx(plan.first_tool_U_um).epsilon(0.2));
}

TEST_CASE("half the uncertainty takes more minutes") {
  const params::Machine machine = length_test_machine("TXYZ");
  model::LengthPlanSettings settings = small_plan();
  const auto coarse = model::planned_lengths(machine, settings);
  settings.volume_U_um = 0.5;
  const auto fine = model::planned_lengths(machine, settings);
  REQUIRE((coarse.has_value() && fine.has_value()));
  CHECK(fine->minutes > coarse->minutes);
  CHECK(fine->volume_U_um <= 0.5);
}

TEST_CASE("an interferometer pays for each line, and its plan is whole too") {
  MadeLengths lengths("XYTZ");
  model::LengthPlanSettings settings = small_plan();
  settings.instrument = model::LengthInstrument::interferometer;
  settings.volume_U_um = 2.0;
  const auto plan = must(model::planned_lengths(lengths.machine, settings));
  CHECK(plan.reached);
  CHECK(plan.set_up_minutes >= 25.0 * static_cast<double>(plan.set_ups));
  lengths.test = plan.test;
  lengths.measure(MadeComponents(12), 0.5, 4);
  CHECK(identified(lengths, {}).whole());
}

model::LengthPlanSettings ball_bar_plan() {
  model::LengthPlanSettings settings = small_plan();
  settings.instrument = model::LengthInstrument::ball_bar;
  settings.ball_bar_mm = 120.0;
  settings.instrument_um = 0.2;
  settings.volume_U_um = 15.0;
  settings.tools_mm = {{0.0, 0.0, 0.0}, {0.0, 0.0, -150.0}, {100.0, 0.0, -80.0}};
  return settings;
}

TEST_CASE(
    "a ball bar of known length: balls in the volume, the same poses with each tool, and all components come back") {
  MadeLengths lengths("XYTZ");
  const auto plan = must(model::planned_lengths(lengths.machine, ball_bar_plan()));
  CHECK(plan.reached);
  CHECK(plan.undetermined.empty());
  CHECK(plan.test.bar_um == 1.0);
  for (const model::LengthReading& r : plan.test.readings) {
    const Vector3 point = model::point_of(plan.test, r), ball = plan.test.set_ups[r.set_up].place;
    CHECK(std::hypot(point[0] - ball[0], point[1] - ball[1], point[2] - ball[2]) == Approx(120.0).epsilon(1e-4));
  }
  lengths.test = plan.test;
  lengths.measure(MadeComponents(13), 0.2, 5);
  const model::Identification found = identified(lengths, {});
  CHECK(found.whole());
  REQUIRE(found.volume_um.has_value());
  CHECK(2.0 * *found.volume_um == Approx(plan.first_tool_U_um).epsilon(0.2));
}

TEST_CASE("a ball bar whose length is not known leaves the scale that all axes share, and the plan says so") {
  MadeLengths lengths("XYTZ");
  model::LengthPlanSettings settings = ball_bar_plan();
  settings.bar_um = 0.0;
  const auto plan = must(model::planned_lengths(lengths.machine, settings));
  for (const char* name : {"EXX", "EYY", "EZZ"})
    CHECK(std::find(plan.undetermined.begin(), plan.undetermined.end(), name) != plan.undetermined.end());
  REQUIRE(!plan.notes.empty());
  CHECK(contains(plan.notes[0], "EXX"));
  lengths.test = plan.test;
  lengths.measure(MadeComponents(14), 0.2, 6);
  const model::Identification found = identified(lengths, {});
  CHECK(contains(found.curves[index_of(Component::EXX)].why_not, "only together with"));
}

TEST_CASE("a ball bar that fits nowhere is refused") {
  model::LengthPlanSettings settings = small_plan();
  settings.instrument = model::LengthInstrument::ball_bar;
  settings.ball_bar_mm = 400.0;
  const auto refused = must_fail(model::planned_lengths(length_test_machine("XYTZ"), settings));
  CHECK(contains(to_text(refused), "expected a shorter ball bar"));
}

}  // namespace
}  // namespace ecs::test
