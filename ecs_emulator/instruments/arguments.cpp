#include "ecs_emulator/instruments/arguments.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/moved_targets.hpp"
#include "base/text.hpp"

namespace ecs::emulator {

const nlohmann::json* Arguments::find(const char* key) {
  known_.emplace_back(key);
  const auto at = request_.find(key);
  return at == request_.end() ? nullptr : &*at;
}

void Arguments::complain(std::string message) {
  problems_.push_back({ProblemKind::usage, std::move(message), {}, 0, 0, {}});
}

std::optional<double> Arguments::number(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number()) return value->get<double>();
  complain("{}: expected a number, got {}", key, value->dump());
  return std::nullopt;
}

void Arguments::numbers_into(std::initializer_list<std::pair<const char*, double*>> places) {
  for (const auto& [key, place] : places) *place = number(key).value_or(*place);
}

std::optional<long long> Arguments::integer(const char* key, long long low, long long high) {
  const auto* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number_integer() && value->get<long long>() >= low && value->get<long long>() <= high)
    return value->get<long long>();
  complain("{}: expected a whole number from {} to {}, got {}", key, low, high, value->dump());
  return std::nullopt;
}

std::string Arguments::word(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return {};
  if (value->is_string()) return value->get<std::string>();
  complain("{}: expected a text, got {}", key, value->dump());
  return {};
}

bool Arguments::flag(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return false;
  if (value->is_boolean()) return value->get<bool>();
  complain("{}: expected true or false, got {}", key, value->dump());
  return false;
}

std::optional<bool> Arguments::zero_or_one(const char* key) {
  const auto value = integer(key, 0, 1);
  return value ? std::optional(*value == 1) : std::nullopt;
}

std::vector<double> Arguments::numbers(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return {};
  if (value->is_array() && std::all_of(value->begin(), value->end(), [](const auto& e) { return e.is_number(); }))
    return value->get<std::vector<double>>();
  complain("{}: expected a list of numbers, got {}", key, value->dump());
  return {};
}

std::vector<std::string> Arguments::words(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return {};
  if (value->is_string()) return {value->get<std::string>()};
  if (value->is_array() && std::all_of(value->begin(), value->end(), [](const auto& e) { return e.is_string(); }))
    return value->get<std::vector<std::string>>();
  complain("{}: expected texts, got {}", key, value->dump());
  return {};
}

std::optional<Axis> Arguments::axis(const char* key) {
  const std::string name = word(key);
  if (name.empty()) return std::nullopt;
  if (name.size() == 1)
    if (const auto axis = axis_of(name.front())) return axis;
  complain("{}: expected X, Y or Z, got \"{}\"", key, name);
  return std::nullopt;
}

std::optional<Sense> Arguments::sense(bool required) {
  const std::string name = word("sense");
  const auto sense = sense_named(name);
  if (!sense && (required || !name.empty())) complain("sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", name);
  return sense;
}

std::optional<InstrumentKind> Arguments::instrument() {
  const std::string name = word("instrument");
  const auto kind = instrument_named(name);
  if (!kind && !name.empty())
    complain("instrument: expected linear, straightness, angular, level or square, got \"{}\"", name);
  return kind;
}

PerAxis<std::optional<double>> Arguments::coordinates(const char* object) {
  PerAxis<std::optional<double>> place{};
  if (object == nullptr) {
    place[0] = number("X");
    place[1] = number("Y");
    place[2] = number("Z");
    return place;
  }
  const auto* value = find(object);
  if (value == nullptr) return place;
  if (!value->is_object()) {
    complain("{}: expected {{\"Y\": mm, …}}, got {}", object, value->dump());
    return place;
  }
  for (const auto& [name, coordinate] : value->items()) {
    const auto axis = name.size() == 1 ? axis_of(name.front()) : std::nullopt;
    if (axis && coordinate.is_number())
      place[index_of(*axis)] = coordinate.get<double>();
    else
      complain("{}: expected X, Y or Z with a number, got \"{}\": {}", object, name, coordinate.dump());
  }
  return place;
}

Result<void> Arguments::checked() {
  for (const auto& [key, value] : request_.items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string like = nearest_word(key, known_);
    complain("no such argument \"{}\"{}", key, like.empty() ? "" : fmt::format("; did you mean \"{}\"?", like));
  }
  if (problems_.empty()) return {};
  return tl::unexpected(folded(std::move(problems_)));
}

namespace {

std::optional<Compensation> compensation_in(Arguments& arguments, const char* key) {
  const std::string name = arguments.word(key);
  const auto named = compensation_named(name);
  if (!name.empty() && !named) arguments.complain("{}: expected off, manual or automatic, got \"{}\"", key, name);
  return named;
}

std::optional<double> not_negative_in(Arguments& arguments, const char* key) {
  const auto value = arguments.number(key);
  if (value && *value < 0.0) arguments.complain("{}: expected 0 or more, got {}", key, *value);
  return value;
}

/// What every request for readings says: which component, by which instrument.
template <class Plan>
bool component_in(Arguments& arguments, Plan& plan) {
  const auto axis = arguments.axis("axis");
  if (!axis && arguments.word("axis").empty()) arguments.complain("axis: expected X, Y or Z");
  const auto sense = arguments.sense(true);
  plan.instrument = arguments.instrument();
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
  arguments.numbers_into({{"feed", &plan.feed_mm_min}, {"dwell", &plan.dwell_s}, {"overrun", &plan.overrun_mm}});
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
  arguments.numbers_into({{"rate", &plan.rate_Hz}, {"seconds", &plan.seconds}});
  plan.to_mm = arguments.number("to");
  plan.feed_mm_min = arguments.number_or("feed", plan.feed_mm_min);
  plan.setting = setting_in(arguments);
  plan.date = arguments.word("date");
  plan.engineer = arguments.word("engineer");
  return whole ? std::optional(plan) : std::nullopt;
}

}  // namespace ecs::emulator
