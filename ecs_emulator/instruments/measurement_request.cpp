#include "ecs_emulator/instruments/measurement_request.hpp"

#include <fmt/format.h>

#include "base/moved_targets.hpp"

namespace ecs::emulator {
namespace {

std::optional<Compensation> compensation_in(Arguments& arguments, const char* key) {
  const std::string name = arguments.word(key);
  const auto named = compensation_named(name);
  if (!name.empty() && !named)
    arguments.complain(fmt::format("{}: expected off, manual or automatic, got \"{}\"", key, name));
  return named;
}

std::optional<double> not_negative_in(Arguments& arguments, const char* key) {
  const auto value = arguments.number(key);
  if (value && *value < 0.0) arguments.complain(fmt::format("{}: expected 0 or more, got {}", key, *value));
  return value;
}

/// What every request for readings says: which component, by which instrument.
template <class Plan>
bool component_in(Arguments& arguments, Plan& plan) {
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
  if (axis) plan.axis = *axis;
  if (sense) plan.sense = *sense;
  return axis && sense;
}

InstrumentSetting setting_in(Arguments& arguments) {
  InstrumentSetting setting;
  setting.air = compensation_in(arguments, "air");
  setting.material = compensation_in(arguments, "material");
  setting.material_degC = arguments.number("material_temperature");
  setting.dead_path_m = not_negative_in(arguments, "dead_path");
  setting.misalignment_mrad = arguments.number("misalignment");
  setting.trigger_latency_s = not_negative_in(arguments, "trigger_latency");
  return setting;
}

}  // namespace

std::optional<MeasurementPlan> plan_in(Arguments& arguments) {
  MeasurementPlan plan;
  const bool whole = component_in(arguments, plan);
  plan.targets_mm = arguments.numbers("targets");
  const auto from = arguments.number("from");
  const auto to = arguments.number("to");
  const auto step = arguments.number("step");
  if (plan.targets_mm.empty() && from && to && step) plan.targets_mm = targets_between(*from, *to, *step);
  if (arguments.flag("moved")) plan.targets_mm = moved_targets(std::move(plan.targets_mm));
  if (plan.targets_mm.empty()) arguments.complain("expected targets, or from, to and step (above 0)");
  plan.runs = static_cast<int>(arguments.integer("runs", 1, 1000).value_or(plan.runs));
  plan.bidirectional = !arguments.flag("unidirectional");
  plan.parked_mm = arguments.coordinates("parked");
  plan.feed_mm_min = arguments.number_or("feed", plan.feed_mm_min);
  plan.dwell_s = arguments.number_or("dwell", plan.dwell_s);
  plan.overrun_mm = arguments.number_or("overrun", plan.overrun_mm);
  plan.on_the_fly = arguments.flag("on_the_fly");
  plan.setting = setting_in(arguments);
  plan.setting.reversed = arguments.zero_or_one("reversed");
  if (const auto reading = arguments.integer("beam_broken_at", 1, 100'000'000))
    plan.beam_broken_at = static_cast<std::size_t>(*reading);
  plan.date = arguments.word("date");
  plan.engineer = arguments.word("engineer");
  plan.name = arguments.word("plan_name");
  return whole ? std::optional(plan) : std::nullopt;
}

std::optional<CapturePlan> capture_in(Arguments& arguments) {
  CapturePlan plan;
  const bool whole = component_in(arguments, plan);
  plan.rate_Hz = arguments.number_or("rate", plan.rate_Hz);
  plan.seconds = arguments.number_or("seconds", plan.seconds);
  plan.to_mm = arguments.number("to");
  plan.feed_mm_min = arguments.number_or("feed", plan.feed_mm_min);
  plan.setting = setting_in(arguments);
  plan.date = arguments.word("date");
  plan.engineer = arguments.word("engineer");
  return whole ? std::optional(plan) : std::nullopt;
}

}  // namespace ecs::emulator
