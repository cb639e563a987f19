// The loop of an investigation, against a machine of one axis whose errors are known.
#include "modules/investigation/investigation.hpp"

#include <atomic>
#include <numbers>

#include <doctest/doctest.h>

#include "modules/investigation/tests/made_workshop.hpp"

namespace ecs::commissioning {
namespace {

double usual_error(double x_mm, int approach) { return 0.012 * x_mm + 1.5 * approach; }
double waving_error(double x_mm, int approach) {
  return usual_error(x_mm, approach) + 3.0 * std::sin(2.0 * std::numbers::pi * x_mm / 10.0 + 0.4);
}

Investigation investigated(MadeWorkshop& workshop, double minutes) {
  InvestigationOptions options;
  options.minutes = minutes;
  options.times = workshop_times();
  const auto found = investigate(usual_model(), one_axis_machine(), workshop, options);
  REQUIRE(found.has_value());
  return *found;
}

TEST_CASE("an investigation names the hidden period, adds it, and measures the line again with the new map") {
  MadeWorkshop workshop(waving_error);
  const Investigation found = investigated(workshop, 200.0);
  CHECK(found.verdict == model::Verdict::missing_effect);
  REQUIRE(found.causes.size() == 1);
  CHECK(found.causes.front().name == "cyclic:X:EX");
  CHECK(found.causes.front().probability == doctest::Approx(1.0));
  CHECK(found.steps.back().set.size() == 1);
  CHECK(workshop.active.effects.size() == 4);  // zeros of runs are no part of it
  CHECK(workshop.asked.back().with_new_map);
  CHECK(*found.rms_before_um > 3.0);
  CHECK(*found.rms_compensated_um < 0.6);
}

TEST_CASE("minutes are those of the steps, and less than the programme of ISO 230-2 on the same line") {
  MadeWorkshop workshop(waving_error);
  const Investigation found = investigated(workshop, 200.0);
  double sum = 0.0;
  for (const InvestigationStep& step : found.steps) sum += step.minutes;
  CHECK(found.minutes == doctest::Approx(sum));
  CHECK(found.minutes < found.programme.minutes);
  CHECK(workshop.steps.size() == found.steps.size());
}

TEST_CASE("where nothing is missing nothing is named") {
  MadeWorkshop workshop(usual_error);
  const Investigation found = investigated(workshop, 60.0);
  CHECK(found.verdict == model::Verdict::adequate);
  CHECK(found.causes.empty());
  CHECK(found.steps.back().set.empty());
}

TEST_CASE("a cause that shows only under a load is found: each line is looked at with one") {
  MadeWorkshop workshop(usual_error);
  workshop.um_per_kg_m = 0.1;
  const Investigation found = investigated(workshop, 60.0);
  CHECK(found.verdict == model::Verdict::missing_effect);
  REQUIRE(found.causes.size() == 1);
  CHECK(found.causes.front().name == "load:X:EX");
  CHECK(found.minutes < found.programme.minutes);
}

TEST_CASE("the load is taken off before the lines are measured with the new map") {
  MadeWorkshop workshop(usual_error);
  workshop.um_per_kg_m = 0.1;
  investigated(workshop, 60.0);
  REQUIRE(workshop.asked.back().with_new_map);
  CHECK(workshop.asked.back().proposal.load_kg == 0.0);
}

TEST_CASE("no run begins that would take more than the minutes that remain") {
  MadeWorkshop workshop(waving_error);
  const Investigation found = investigated(workshop, 3.0);
  CHECK(found.steps.empty());
  CHECK_FALSE(found.verdict);
  CHECK(workshop.asked.empty());
  REQUIRE_FALSE(found.notes.empty());
  CHECK(found.notes.front().find("3 minutes") != std::string::npos);
}

TEST_CASE("a run that cannot be made is noted, and another is taken in its place") {
  MadeWorkshop workshop(usual_error);
  workshop.refuse = [](const RequestedRun& run) { return run.number == 2 && !run.with_new_map; };
  const Investigation found = investigated(workshop, 2000.0);
  CHECK(found.verdict == model::Verdict::adequate);
  CHECK(std::any_of(found.notes.begin(), found.notes.end(),
                    [](const std::string& note) { return note.find("no load is at hand") != std::string::npos; }));
}

TEST_CASE("a first run that cannot be made ends the investigation with the reason") {
  MadeWorkshop workshop(usual_error);
  workshop.refuse = [](const RequestedRun&) { return true; };
  const auto found = investigate(usual_model(), one_axis_machine(), workshop, {60.0, workshop_times(), nullptr});
  REQUIRE_FALSE(found.has_value());
  CHECK(found.error().message == "no load is at hand");
}

TEST_CASE("an investigation that is cancelled asks for nothing more") {
  MadeWorkshop workshop(usual_error);
  const std::atomic<bool> cancelled{true};
  const auto found = investigate(usual_model(), one_axis_machine(), workshop, {60.0, workshop_times(), &cancelled});
  REQUIRE_FALSE(found.has_value());
  CHECK(found.error().kind == ProblemKind::refused);
  CHECK(workshop.asked.empty());
}

}  // namespace
}  // namespace ecs::commissioning
