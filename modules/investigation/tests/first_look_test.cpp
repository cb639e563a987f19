#include "modules/investigation/first_look.hpp"

#include <doctest/doctest.h>

#include "modules/investigation/tests/made_workshop.hpp"

namespace ecs::commissioning {
namespace {

TEST_CASE("the first look keeps inside the travel, ascending, on steps that differ by a tenth and more") {
  const auto look = first_look({Axis::X, Sense::EX}, one_axis_machine(), workshop_times());
  const double overrun = look.overrun_mm;
  REQUIRE(look.targets_mm.size() >= 5);
  const double step = 1000.0 / static_cast<double>(look.targets_mm.size() - 1);
  double shortest = 1000.0, longest = 0.0;
  for (std::size_t i = 1; i < look.targets_mm.size(); ++i) {
    const double gap = look.targets_mm[i] - look.targets_mm[i - 1];
    shortest = std::min(shortest, gap);
    longest = std::max(longest, gap);
  }
  CHECK(look.targets_mm.front() >= overrun);
  CHECK(look.targets_mm.back() <= 1000.0 - overrun);
  CHECK(shortest > 0.0);
  CHECK(longest - shortest > 0.1 * step);
}

TEST_CASE("the programme of ISO 230-2 is five runs both ways over 25 targets, set-up included") {
  const IsoProgramme programme = iso_programme({{Axis::X, Sense::EX}}, one_axis_machine(), workshop_times());
  CHECK(programme.targets == 25);
  CHECK(programme.set_up_minutes == doctest::Approx(3.0));
  // 250 readings of 3 s, ten passes of 990 mm at 2000 mm/min, and the ways to the overruns
  CHECK(programme.minutes == doctest::Approx(3.0 + 250 * 3.0 / 60.0 + 10 * 0.99 / 2.0).epsilon(0.02));
}

TEST_CASE("a model names its lines; positioning of the axes that it does not speak of comes last") {
  params::Machine machine = one_axis_machine();
  machine.axes[1] = machine.axes[0];
  model::Model model = usual_model();
  const auto lines = lines_of_model(model, machine);
  REQUIRE(lines.size() == 1);
  CHECK(lines.front() == InvestigatedLine{Axis::X, Sense::EX});
  CHECK(other_lines(lines, machine) == std::vector<InvestigatedLine>{{Axis::Y, Sense::EY}});
  CHECK(lines_of_model({}, machine).size() == 2);
}

TEST_CASE("a squareness is looked at along its second axis, against a square; the artefact lies as it was first") {
  params::Machine machine = one_axis_machine();
  machine.axes[1] = machine.axes[0];
  model::EffectInstance squareness;
  squareness.id = model::effect_named("squareness");
  squareness.code = Component::C0Y;
  squareness.axis = Axis::Y;
  model::Model model;
  model.effects = {squareness};
  const auto lines = lines_of_model(model, machine);
  REQUIRE(lines.size() == 1);
  CHECK(lines.front() == InvestigatedLine{Axis::Y, Sense::EX, true});
  const auto look = first_look(lines.front(), machine, workshop_times());
  CHECK(look.reversed == false);
  CHECK(look.sentence.find("Measure EX along Y against a square, first look") == 0);
  CHECK_FALSE(first_look({Axis::X, Sense::EX}, machine, workshop_times()).reversed.has_value());
  const auto turned = look_turned_over(look, workshop_times());
  CHECK(turned.reversed == true);
  CHECK(turned.set_up_minutes == doctest::Approx(4.0));
}

}  // namespace
}  // namespace ecs::commissioning
