// Errors of rotary axes in the errors file: [location], [[contribution]] of EXC … and [[effect]] with axis = "C".
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

constexpr std::string_view kLocation = "location";
/// What a rotary axis may have; a curve is a [[contribution]].
constexpr std::array<std::string_view, 5> kOfTurns{"offset", "backlash", "cyclic", "step", "time_drift"};

/// A, B, C; kAxes where the letter is none of them.
std::size_t rotary_axis_in(std::string_view letter) {
  const std::size_t axis = letter.size() == 1 ? std::string_view("ABC").find(letter) : std::string_view::npos;
  return axis == std::string_view::npos ? kAxes : axis;
}

struct LocationName {
  std::size_t axis = 0, letter = 0;
};
std::optional<LocationName> location_in(std::string_view name) {
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    for (std::size_t letter = 0; letter < 2 * kAxes; ++letter)
      if (location_name(axis, letter) == name) return LocationName{axis, letter};
  return std::nullopt;
}

void add_location(ErrorsReading& reading, const toml::node& node, std::string_view name, double value) {
  const auto found = location_in(name);
  if (!found) {
    reading.reader.complain(
        node, fmt::format("location: expected XOA … COC, an error of an axis line such as XOC, got \"{}\"", name));
    return;
  }
  reading.parts.rotary.location[found->axis][found->letter] += value;
  reading.parts.rotary.line[found->axis] = static_cast<int>(node.source().begin.line);
}

std::string in_millimetres(std::string name) {
  constexpr std::string_view kAngle = "_deg";
  if (!name.ends_with(kAngle)) return name;
  return name.substr(0, name.size() - kAngle.size()) + "_mm";
}

std::string in_degrees(std::string_view name) {
  constexpr std::string_view kLength = "_mm";
  if (!name.ends_with(kLength)) return std::string(name);
  return std::string(name.substr(0, name.size() - kLength.size())) + "_deg";
}

/// `parameters` of an effect of turns, degrees under the names of the list.
bool take_parameters(ErrorsReading& reading, const toml::table& table, PlacedEffect& effect) {
  const toml::table* given = reading.reader.child(table, "parameters");
  std::vector<std::string> names;
  for (const ParameterDefinition& one : effect.kind->parameters) names.push_back(in_degrees(one.name));
  if (given == nullptr) {
    reading.reader.complain(table, fmt::format("parameters: expected {{ {} }}", fmt::join(names, ", ")));
    return false;
  }
  reading.reader.only(*given, names, "parameters");
  for (const ParameterDefinition& one : effect.kind->parameters) {
    const std::string name = in_degrees(one.name);
    if (one.optional && !given->contains(name)) continue;
    required_into(reading.reader, *given, name, one.range.above == 0.0 ? Sign::positive : Sign::any,
                  effect.parameters[in_millimetres(name)]);
  }
  return true;
}

void read_location_effect(ErrorsReading& reading, const toml::table& table) {
  reading.reader.only(table, {"id", "code", "parameters", "cause"}, "effect location");
  const std::string code = reading.reader.word(table, "code").value_or("");
  const toml::table* parameters = reading.reader.child(table, "parameters");
  const auto found = location_in(code);
  const std::string unit = found && found->letter >= kAxes ? "um_per_m" : "um";
  const auto value = parameters != nullptr ? reading.reader.number(*parameters, unit) : std::nullopt;
  if (parameters != nullptr) reading.reader.only(*parameters, {unit}, "parameters");
  if (!value) return reading.reader.complain(table, fmt::format("location: expected parameters = {{ {} = … }}", unit));
  add_location(reading, table, code, *value);
}

void read_turn_effect(ErrorsReading& reading, const toml::table& table, std::size_t axis) {
  const std::string id = reading.reader.word(table, "id").value_or("");
  RotaryMotion motion;
  motion.axis = axis;
  motion.line = reading.parts.rotary.line[axis] = static_cast<int>(table.source().begin.line);
  PlacedEffect effect;
  effect.kind = effect_named(id);
  if (effect.kind == nullptr || std::find(kOfTurns.begin(), kOfTurns.end(), id) == kOfTurns.end())
    return reading.reader.complain(
        table, fmt::format("id: of a rotary axis expected {} or location, got \"{}\"", fmt::join(kOfTurns, ", "), id));
  reading.reader.only(table, {"id", "axis", "sense", "approach", "parameters", "cause"}, "effect of a rotary axis");
  const auto word = reading.reader.word(table, "sense");
  const auto sense = word ? sense_named(*word) : std::optional(static_cast<Sense>(kAxes + axis));
  if (!sense)
    return reading.reader.complain(table, fmt::format("sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", *word));
  motion.sense = *sense;
  const std::string approach = reading.reader.word(table, "approach").value_or("both");
  if (approach != "both" && approach != "forward" && approach != "reverse")
    return reading.reader.complain(table,
                                   fmt::format("approach: expected both, forward or reverse, got \"{}\"", approach));
  if (approach == "forward") effect.approach = Approach::forward;
  if (approach == "reverse") effect.approach = Approach::reverse;
  if (!take_parameters(reading, table, effect)) return;
  motion.effect = std::move(effect);
  reading.parts.rotary.motions.push_back(std::move(motion));
}

}  // namespace

void read_location(ErrorsReading& reading) {
  const toml::table* table = reading.reader.child(reading.file, kLocation);
  if (table == nullptr) return;
  for (const auto& [key, node] : *table) {
    const auto value = reading.reader.number(*table, key.str());
    if (value) add_location(reading, node, key.str(), *value);
  }
}

bool read_rotary_contribution(ErrorsReading& reading, const toml::table& table) {
  const toml::node* name = table.get("component");
  const std::string component = name != nullptr ? name->value<std::string>().value_or("") : "";
  const std::size_t axis = component.size() == 3 ? rotary_axis_in(component.substr(2)) : kAxes;
  const auto sense = component.size() == 3 ? sense_named(component.substr(0, 2)) : std::nullopt;
  if (axis == kAxes || !sense) return false;
  reading.reader.only(table, {"component", "formula", "points", "csv", "cause"}, "contribution");
  RotaryMotion motion;
  motion.axis = axis;
  motion.sense = *sense;
  motion.curve = curve_in(reading, table, "contribution");
  motion.line = reading.parts.rotary.line[axis] = static_cast<int>(table.source().begin.line);
  if (motion.curve) reading.parts.rotary.motions.push_back(std::move(motion));
  return true;
}

bool read_rotary_effect(ErrorsReading& reading, const toml::table& table) {
  const auto word = [&](std::string_view key) {
    const toml::node* node = table.get(key);
    return node != nullptr ? node->value<std::string>().value_or("") : std::string();
  };
  if (word("id") == kLocation) {
    read_location_effect(reading, table);
    return true;
  }
  const std::size_t axis = rotary_axis_in(word("axis"));
  if (axis < kAxes) read_turn_effect(reading, table, axis);
  return axis < kAxes;
}

}  // namespace ecs::emulator
