// An investigation that is stopped and gone on with, and its ledger as rows of a screen.
#include "modules/investigation/followed.hpp"

#include <atomic>
#include <numbers>

#include <doctest/doctest.h>

#include "modules/investigation/investigation.hpp"
#include "modules/investigation/tests/made_workshop.hpp"

namespace ecs::commissioning {
namespace {

double wave_of_ten(double x_mm, int approach) {
  return 0.012 * x_mm + 1.5 * approach + 3.0 * std::sin(2.0 * std::numbers::pi * x_mm / 10.0 + 0.4);
}

InvestigationOptions options_with(const std::atomic<bool>& cancelled) {
  constexpr double kMinutes = 200.0;
  return {kMinutes, workshop_times(), &cancelled};
}

TEST_CASE("what was measured before a stop is not measured again") {
  FollowedInvestigation followed;
  MadeWorkshop machine(wave_of_ten);
  std::atomic<bool> cancelled{false};
  {
    FollowedWorkshop workshop(followed, machine, [&] { cancelled = !followed.progress().steps.empty(); });
    CHECK_FALSE(investigate(usual_model(), one_axis_machine(), workshop, options_with(cancelled)).has_value());
  }
  const std::size_t asked = machine.asked.size();
  CHECK(asked == 1);
  CHECK(followed.progress().steps.size() == 1);
  cancelled = false;
  FollowedWorkshop workshop(followed, machine);
  const auto found = investigate(usual_model(), one_axis_machine(), workshop, options_with(cancelled));
  REQUIRE(found.has_value());
  CHECK(found->causes.size() == 1);
  CHECK(followed.progress().steps.size() == found->steps.size());
  for (std::size_t k = asked; k < machine.asked.size(); ++k) CHECK(machine.asked[k].number != 1);
}

TEST_CASE("the ledger has a row a run, the members of the last set, and what is being done") {
  InvestigationProgress progress;
  InvestigationStep step;
  step.minutes = 8.0;
  step.measured = "EX along X, first look: 13 targets, 2 runs both ways";
  step.verdict = model::Verdict::missing_effect;
  step.rms_um = 1.5;
  step.set = {{"sag:X:EX", 0.9}, {"progressive:X:EX", 0.1}};
  progress.steps.push_back(step);
  step.minutes = 4.5;
  step.set = {{"sag:X:EX", 1.0}};
  progress.steps.push_back(step);
  progress.doing = "run 3";
  const LedgerView view = view_of(progress);
  REQUIRE(view.rows.size() == 2);
  CHECK(view.rows[0].members == 2);
  CHECK_FALSE(view.rows[0].settled);
  CHECK(view.rows[1].settled);
  CHECK(view.rows[1].numbers == " 2    4.5   12.5    1.500    1");
  CHECK(view.set == "sag:X:EX 1.00");
  constexpr std::size_t kColumns = 60;
  const auto lines = lines_of(view, kColumns);
  CHECK(lines.size() == 5);
  CHECK(lines[1].find("##") != std::string::npos);
  for (const std::string& line : lines) CHECK(line.size() <= kColumns);
}

}  // namespace
}  // namespace ecs::commissioning
