// [[effect]] of the errors file: ids, keys and parameters of docs/emulator.md.
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

using Names = std::vector<std::string>;

class EffectReader {
 public:
  EffectReader(ErrorsReading& reading, const toml::table& table)
      : reading_(reading), reader_(reading.reader), table_(table) {}

  void read() {
    const EffectDefinition* kind = kind_of_id();
    if (kind == nullptr) return;
    const std::size_t before = complaints_;
    const std::string what = fmt::format("effect {}", kind->id);
    const bool curve = kind->curve != CurveOf::nothing;
    Names keys{"id", "axis", "sense", "code", "approach", "cause"};
    if (curve) keys.insert(keys.end(), {"formula", "points", "csv"});
    if (kind->sensors > 0) keys.emplace_back("sensor");
    if (kind->sensors > 1) keys.emplace_back("sensor2");
    if (!curve) keys.emplace_back("parameters");
    reader_.only(table_, keys, what.c_str());
    effect_.effect.kind = kind;
    read_place(*kind);
    read_approach();
    if (kind->sensors > 0) effect_.effect.sensor = sensor_in("sensor");
    if (kind->sensors > 1) effect_.effect.sensor2 = sensor_in("sensor2");
    if (curve) {
      effect_.curve = curve_in(reading_, table_, what.c_str());
      if (!effect_.curve) return;
    } else {
      read_parameters(*kind);
    }
    if (complaints_ != before) return;
    for (const PlacedEffect& part : parts_of(effect_.effect)) {
      demand(reading_, table_, what, *part.axis);
      reading_.parts.effects.push_back({part, carrier_of(part), std::exchange(effect_.curve, std::nullopt)});
    }
  }

 private:
  void complain(std::string_view key, std::string message) {
    const toml::node* node = table_.get(key);
    reader_.complain(node != nullptr ? *node : table_, std::move(message));
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
    for (const EffectDefinition* one : effects())
      if (one->elsewhere.empty()) known.emplace_back(one->id);
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

  void read_approach() {
    const auto word = reader_.word(table_, "approach");
    if (!word || *word == "both") return;
    if (*word == "forward")
      effect_.effect.approach = Approach::forward;
    else if (*word == "reverse")
      effect_.effect.approach = Approach::reverse;
    else
      complain("approach", fmt::format("approach: expected both, forward or reverse, got \"{}\"", *word));
  }

  /// `spindle`, or the column in which it is measured, `t_spindle_degC`.
  std::string sensor_in(const char* key) {
    std::string name = reader_.word(table_, key).value_or("");
    if (name.starts_with("t_") && name.ends_with("_degC")) name = name.substr(2, name.size() - 7);
    if (!reading_.parts.variables.temperatures.contains(name))
      complain(key, fmt::format("{}: expected a sensor of this file, got \"{}\"", key, name));
    return name;
  }

  void read_parameters(const EffectDefinition& kind) {
    const toml::table* table = reader_.child(table_, "parameters");
    Names all;
    for (const ParameterDefinition& parameter : kind.parameters) all.emplace_back(parameter.name);
    const bool none_required = kind.parameters.front().optional;
    if (table == nullptr || (none_required && table->empty()))
      return complain("parameters", fmt::format("parameters: expected {{ {} }}", fmt::join(all, ", ")));
    reader_.only(*table, all, "parameters");
    for (const ParameterDefinition& parameter : kind.parameters) {
      if (parameter.optional && !table->contains(parameter.name)) continue;
      required_into(reader_, *table, parameter.name, parameter.range.above == 0.0 ? Sign::positive : Sign::any,
                    effect_.effect.parameters[std::string(parameter.name)]);
    }
  }

  ErrorsReading& reading_;
  TomlReader& reader_;
  const toml::table& table_;
  FileEffect effect_;
  std::size_t complaints_ = 0;
};

}  // namespace

void read_effects(ErrorsReading& reading) {
  for (const toml::table* table : reading.reader.children(reading.file, "effect"))
    if (!read_rotary_effect(reading, *table)) EffectReader(reading, *table).read();
}

}  // namespace ecs::emulator
