#include "ecs_emulator/measurement_request.hpp"

#include <fmt/format.h>

namespace ecs::emulator {

std::optional<MeasurementPlan> plan_in(Arguments& arguments) {
  MeasurementPlan plan;
  const auto axis = arguments.axis("axis");
  const auto sense_name = arguments.word("sense");
  const auto sense = sense_named(sense_name);
  if (!axis) arguments.complain("axis: expected X, Y or Z");
  if (!sense) arguments.complain(fmt::format("sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", sense_name));
  if (const std::string name = arguments.word("instrument"); !name.empty()) {
    plan.instrument = instrument_named(name);
    if (!plan.instrument)
      arguments.complain(
          fmt::format("instrument: expected linear, straightness, angular, level or square, got \"{}\"", name));
  }
  plan.targets_mm = arguments.numbers("targets");
  const auto from = arguments.number("from");
  const auto to = arguments.number("to");
  const auto step = arguments.number("step");
  if (plan.targets_mm.empty() && from && to && step) plan.targets_mm = targets_between(*from, *to, *step);
  if (plan.targets_mm.empty()) arguments.complain("expected targets, or from, to and step (above 0)");
  plan.runs = static_cast<int>(arguments.integer("runs", 1, 1000).value_or(plan.runs));
  plan.bidirectional = !arguments.flag("unidirectional");
  plan.parked_mm = arguments.coordinates("parked");
  plan.feed_mm_min = arguments.number_or("feed", plan.feed_mm_min);
  plan.dwell_s = arguments.number_or("dwell", plan.dwell_s);
  plan.overrun_mm = arguments.number_or("overrun", plan.overrun_mm);
  plan.on_the_fly = arguments.flag("on_the_fly");
  plan.date = arguments.word("date");
  plan.engineer = arguments.word("engineer");
  plan.name = arguments.word("plan_name");
  if (axis) plan.axis = *axis;
  if (sense) plan.sense = *sense;
  return axis && sense ? std::optional(plan) : std::nullopt;
}

}  // namespace ecs::emulator
