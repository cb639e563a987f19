// [[effect]] of the errors file: ids, keys and parameters of docs/emulator.md; of rotary axes (axis = "C") too,
// with their [location] and [[contribution]] of EXC ….
#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "ecs_emulator/effects/effects.hpp"
#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

using Names = std::vector<std::string>;

bool read_approach(TomlReader& reader, const toml::table& table, PlacedEffect& effect) {
  const std::string word = reader.word(table, "approach").value_or("both");
  if (word == "forward") effect.approach = Approach::forward;
  if (word == "reverse") effect.approach = Approach::reverse;
  if (word == "both" || word == "forward" || word == "reverse") return true;
  reader.complain(place_of(table, "approach"), "approach: expected both, forward or reverse, got \"{}\"", word);
  return false;
}

/// A rotary axis has degrees under the names of the list.
std::string in_degrees(std::string_view name) {
  constexpr std::string_view kLength = "_mm";
  if (!name.ends_with(kLength)) return std::string(name);
  return std::string(name.substr(0, name.size() - kLength.size())) + "_deg";
}

/// `parameters`. @return false: they are not there
bool read_parameters(TomlReader& reader, const toml::table& table, bool rotary, PlacedEffect& effect) {
  const auto name_in_file = [&](std::string_view name) { return rotary ? in_degrees(name) : std::string(name); };
  const toml::table* given = reader.child(table, "parameters");
  Names names;
  for (const ParameterDefinition& one : effect.kind->parameters) names.push_back(name_in_file(one.name));
  const bool none_required = effect.kind->parameters.front().optional;
  if (given == nullptr || (none_required && given->empty())) {
    reader.complain(place_of(table, "parameters"), "parameters: expected {{ {} }}", fmt::join(names, ", "));
    return false;
  }
  reader.only(*given, names, "parameters");
  for (const ParameterDefinition& one : effect.kind->parameters)
    if (const std::string name = name_in_file(one.name); !one.optional || given->contains(name))
      required_into(reader, *given, name, one.positive ? Sign::positive : Sign::any,
                    effect.parameters[std::string(one.name)]);
  return true;
}

class EffectReader {
 public:
  EffectReader(ErrorsReading& reading, const toml::table& table)
      : reading_(reading), reader_(reading.reader), table_(table) {}

  void read() {
    const EffectDefinition* kind = kind_of_id();
    if (kind == nullptr) return;
    const std::size_t before = complaints_;
    const std::string what = fmt::format("effect {}", kind->id);
    const bool curve = kind->curve;
    Names keys{"id", "axis", "sense", "code", "approach", "cause"};
    if (curve) keys.insert(keys.end(), {"formula", "points", "csv"});
    if (kind->sensors > 0) keys.emplace_back("sensor");
    if (kind->sensors > 1) keys.emplace_back("sensor2");
    if (!curve) keys.emplace_back("parameters");
    reader_.only(table_, keys, what.c_str());
    effect_.effect.kind = kind;
    read_place(*kind);
    if (!read_approach(reader_, table_, effect_.effect)) ++complaints_;
    if (kind->sensors > 0) effect_.effect.sensor = sensor_in("sensor");
    if (kind->sensors > 1) effect_.effect.sensor2 = sensor_in("sensor2");
    if (curve) {
      effect_.curve = curve_in(reading_, table_, what.c_str());
      if (!effect_.curve) return;
    } else if (!read_parameters(reader_, table_, false, effect_.effect)) {
      return;
    }
    if (complaints_ != before) return;
    for (const PlacedEffect& part : parts_of(effect_.effect)) {
      demand(reading_, table_, what, *part.axis);
      reading_.parts.effects.push_back({part, carrier_of(part), std::exchange(effect_.curve, std::nullopt)});
    }
  }

 private:
  void complain(std::string_view key, std::string message) {
    reader_.complain(place_of(table_, key), std::move(message));
    ++complaints_;
  }

  const EffectDefinition* kind_of_id() {
    const std::string id = reader_.word(table_, "id").value_or("");
    const EffectDefinition* kind = effect_named(id);
    if (kind != nullptr && kind->elsewhere.empty()) return kind;
    if (kind != nullptr) {
      complain("id", fmt::format("{}: {}", id, kind->elsewhere));
      return nullptr;
    }
    Names known;
    for (const EffectDefinition& one : effects())
      if (one.elsewhere.empty()) known.emplace_back(one.id);
    const std::string like = nearest_word(id, known);
    complain("id", like.empty() ? fmt::format("id: expected one of {}, got \"{}\"", fmt::join(known, ", "), id)
                                : fmt::format("id: no such effect \"{}\"; did you mean \"{}\"?", id, like));
    return nullptr;
  }

  /// The component: of the code, or of sense and axis, each standing for the other where it may.
  void read_place(const EffectDefinition& kind) {
    PlacedEffect& effect = effect_.effect;
    const auto axis = reader_.word(table_, "axis");
    const auto sense = reader_.word(table_, "sense");
    if (axis) effect.axis = axis->size() == 1 ? axis_of(axis->front()) : std::nullopt;
    if (sense) effect.sense = sense_named(*sense);
    if (axis && !effect.axis) return complain("axis", fmt::format("axis: expected X, Y or Z, got \"{}\"", *axis));
    if (sense && !effect.sense)
      return complain("sense", fmt::format("sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", *sense));
    if (kind.placed_by == PlacedBy::code_of_set_up) return read_rotation(kind);
    if (kind.placed_by != PlacedBy::sense) return read_code(kind);
    if (table_.contains("code")) return complain("code", "code: only angular, squareness and set_up_rotation have one");
    if (kind.needs_axis && !effect.axis) return complain("axis", "axis: expected X, Y or Z");
    if (!effect.sense && effect.axis) effect.sense = static_cast<Sense>(index_of(*effect.axis));
    if (!effect.sense) return complain("sense", "sense: expected EX, EY, EZ, EA, EB or EC");
    if (!effect.axis) effect.axis = direction_of(*effect.sense);
    if (kind.straightness && (is_rotation(*effect.sense) || direction_of(*effect.sense) == *effect.axis))
      return complain("sense", fmt::format("sense: {} acts across its axis: expected a translation other than along {}",
                                           kind.id, letter_of(*effect.axis)));
  }

  void read_rotation(const EffectDefinition& kind) {
    for (const char* key : {"axis", "sense"})
      if (table_.contains(key)) return complain(key, fmt::format("{}: {} has a code alone", key, kind.id));
    const std::string word = reader_.word(table_, "code").value_or("");
    effect_.effect.sense = sense_named(word);
    if (!effect_.effect.sense || !is_rotation(*effect_.effect.sense))
      complain("code", fmt::format("code: expected EA, EB or EC, got \"{}\"", word));
  }

  void read_code(const EffectDefinition& kind) {
    PlacedEffect& effect = effect_.effect;
    const std::string word = reader_.word(table_, "code").value_or("");
    const auto code = component_of(word);
    const bool squareness = kind.placed_by == PlacedBy::code_of_squareness;
    if (!code || (squareness ? !is_squareness(*code) : !is_angular(*code)))
      return complain("code",
                      fmt::format("code: expected {}, got \"{}\"", squareness ? "C0Y, B0Z or A0Z" : "EAX … ECZ", word));
    if (effect.sense) return complain("sense", fmt::format("sense: {} has a code and no sense", kind.id));
    const Axis axis = !squareness ? moving_axis(*code) : *code == Component::C0Y ? Axis::Y : Axis::Z;
    if (effect.axis && *effect.axis != axis)
      return complain("axis", fmt::format("axis: {} belongs to {}", word, letter_of(axis)));
    effect.axis = axis;
    effect.code = code;
  }

  /// `spindle`, or the column in which it is measured, `t_spindle_degC`.
  std::string sensor_in(const char* key) {
    std::string name = reader_.word(table_, key).value_or("");
    if (name.starts_with("t_") && name.ends_with("_degC")) name = name.substr(2, name.size() - 7);
    if (!reading_.parts.variables.temperatures.contains(name))
      complain(key, fmt::format("{}: expected a sensor of this file, got \"{}\"", key, name));
    return name;
  }

  ErrorsReading& reading_;
  TomlReader& reader_;
  const toml::table& table_;
  FileEffect effect_;
  std::size_t complaints_ = 0;
};

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
    reading.reader.complain(node, "location: expected XOA … COC, an error of an axis line such as XOC, got \"{}\"",
                            name);
    return;
  }
  reading.parts.rotary.location[found->axis][found->letter] += value;
  reading.parts.rotary.line[found->axis] = static_cast<int>(node.source().begin.line);
}

void read_location_effect(ErrorsReading& reading, const toml::table& table) {
  reading.reader.only(table, {"id", "code", "parameters", "cause"}, "effect location");
  const std::string code = reading.reader.word(table, "code").value_or("");
  const toml::table* parameters = reading.reader.child(table, "parameters");
  const auto found = location_in(code);
  const std::string unit = found && found->letter >= kAxes ? "um_per_m" : "um";
  const auto value = parameters != nullptr ? reading.reader.number(*parameters, unit) : std::nullopt;
  if (parameters != nullptr) reading.reader.only(*parameters, {unit}, "parameters");
  if (!value) return reading.reader.complain(table, "location: expected parameters = {{ {} = … }}", unit);
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
    return reading.reader.complain(table, "id: of a rotary axis expected {} or location, got \"{}\"",
                                   fmt::join(kOfTurns, ", "), id);
  reading.reader.only(table, {"id", "axis", "sense", "approach", "parameters", "cause"}, "effect of a rotary axis");
  const auto word = reading.reader.word(table, "sense");
  const auto sense = word ? sense_named(*word) : std::optional(static_cast<Sense>(kAxes + axis));
  if (!sense) return reading.reader.complain(table, "sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", *word);
  motion.sense = *sense;
  if (!read_approach(reading.reader, table, effect) || !read_parameters(reading.reader, table, true, effect)) return;
  motion.effect = std::move(effect);
  reading.parts.rotary.motions.push_back(std::move(motion));
}

/// False: it is none of a rotary axis.
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

}  // namespace

void read_effects(ErrorsReading& reading) {
  for (const toml::table* table : reading.reader.children(reading.file, "effect"))
    if (!read_rotary_effect(reading, *table)) EffectReader(reading, *table).read();
}

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
  reading.reader.only(table, {"component", "formula", "points", "csv", "cause", "bends"}, "contribution");
  RotaryMotion motion;
  motion.axis = axis;
  motion.sense = *sense;
  motion.curve = curve_in(reading, table, "contribution");
  if (table.contains("bends")) {
    const auto what = reading.reader.word(table, "bends");
    if (what && ((*what != "machine" && *what != "tool") || is_rotation(*sense)))
      reading.reader.complain(
          table, fmt::format("bends: expected \"machine\" or \"tool\" of EX, EY or EZ, got \"{}\" of {}", *what,
                             name_of(*sense)));
    motion.bends = what == "machine" ? Bends::machine : Bends::tool;
  }
  motion.line = reading.parts.rotary.line[axis] = static_cast<int>(table.source().begin.line);
  if (motion.curve) reading.parts.rotary.motions.push_back(std::move(motion));
  return true;
}

}  // namespace ecs::emulator
