// [[effect]] of the errors file: ids, keys and parameters of docs/surroundings.md.
// Does not live here: what the effects do (ecs_emulator/effects/formula.hpp).
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

using Names = std::vector<std::string>;

/// What an effect may say of itself.
struct Rule {
  EffectKind kind;
  Names required;   ///< parameters
  Names optional;   ///< parameters; if none is required, at least one of them
  bool needs_axis;  ///< depends on the place or the way of an axis; else the axis along the sense is taken
  bool curve = false;
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules{
      {EffectKind::offset, {"um"}, {}, false},
      {EffectKind::scale, {"um_per_m"}, {}, true},
      {EffectKind::progressive, {}, {}, true, true},
      {EffectKind::cyclic, {"period_mm", "amplitude_um"}, {"phase_rad", "amplitude2_um", "phase2_rad"}, true},
      {EffectKind::backlash, {"um"}, {}, true},
      {EffectKind::reversal_curve, {}, {}, true, true},
      {EffectKind::step, {"height_um", "position_mm"}, {}, true},
      {EffectKind::sag, {}, {"k2", "k3"}, true},
      {EffectKind::angular, {}, {}, false, true},
      {EffectKind::squareness, {"um_per_m"}, {}, false},
      {EffectKind::thermal_scale, {"um_per_m_degC"}, {}, true},
      {EffectKind::thermal_drift, {"um_per_degC"}, {}, false},
      {EffectKind::warm_up, {"tau_s"}, {"c_um", "c_um_per_m"}, false},
      {EffectKind::time_drift, {"um_per_h"}, {}, false},
      {EffectKind::servo_lag, {"um_per_m_min"}, {}, true},
      {EffectKind::load, {}, {"um_per_kg", "um_per_kg_m"}, false},
      {EffectKind::reversal_spike, {"c_um", "u0_mm"}, {}, true},
  };
  return kRules;
}

/// Why an effect of the library has no place in this file, and where it has one.
std::string elsewhere(EffectKind kind) {
  if (is_map_fault(kind))
    return "a fault of the unit's map: give the unit such a map, or polarity and gain in its parameters";
  switch (kind) {
    case EffectKind::measurement_line:
      return "comes from where the map was measured, not from the machine: measure with the other axes parked "
             "elsewhere (parked_mm of the plan)";
    case EffectKind::air_refraction:
      return "an effect of the instrument: the air is [air] of this file, what the laser makes of it "
             "air_compensation in [emulator.laser] of the machine file";
    case EffectKind::dead_path:
      return "an effect of the instrument: set dead_path_m in [emulator.laser] of the machine file";
    default:
      return "an effect of the instrument: set misalignment_mrad in [emulator.laser] of the machine file";
  }
}

class EffectReader {
 public:
  EffectReader(ErrorsReading& reading, const toml::table& table)
      : reading_(reading), reader_(reading.reader), table_(table) {}

  void read() {
    const Rule* rule = rule_of_id();
    if (rule == nullptr) return;
    const std::size_t before = complaints_;
    Names keys{"id", "axis", "sense", "code", "approach", "cause"};
    if (rule->curve) keys.insert(keys.end(), {"formula", "points", "csv"});
    if (rule->kind == EffectKind::thermal_drift) keys.emplace_back("sensor");
    if (!rule->curve) keys.emplace_back("parameters");
    reader_.only(table_, keys, fmt::format("effect {}", name_of(rule->kind)));
    effect_.effect.kind = rule->kind;
    read_place(*rule);
    read_approach();
    if (rule->kind == EffectKind::thermal_drift) read_sensor();
    if (rule->curve) {
      effect_.curve = curve_in(reading_, table_, fmt::format("effect {}", name_of(rule->kind)).c_str());
      if (!effect_.curve) return;
    } else {
      read_parameters(*rule);
    }
    if (complaints_ != before) return;
    demand(reading_, table_, fmt::format("effect {}", name_of(rule->kind)), *effect_.effect.axis);
    reading_.parts.effects.push_back(std::move(effect_));
  }

 private:
  void complain(std::string_view key, std::string message) {
    const toml::node* node = table_.get(key);
    reader_.complain(node != nullptr ? *node : table_, std::move(message));
    ++complaints_;
  }

  const Rule* rule_of_id() {
    const std::string id = reader_.word(table_, "id").value_or("");
    const auto kind = effect_kind_named(id);
    if (!kind) {
      Names known;
      for (const Rule& rule : rules()) known.emplace_back(name_of(rule.kind));
      const std::string like = nearest_word(id, known);
      complain("id", like.empty() ? fmt::format("id: expected one of {}, got \"{}\"", fmt::join(known, ", "), id)
                                  : fmt::format("id: no such effect \"{}\"; did you mean \"{}\"?", id, like));
      return nullptr;
    }
    for (const Rule& rule : rules())
      if (rule.kind == *kind) return &rule;
    complain("id", fmt::format("{}: {}", id, elsewhere(*kind)));
    return nullptr;
  }

  /// The component: of the code, or of sense and axis, each standing for the other where it may.
  void read_place(const Rule& rule) {
    PlacedEffect& effect = effect_.effect;
    const auto axis = reader_.word(table_, "axis");
    const auto sense = reader_.word(table_, "sense");
    if (axis) effect.axis = axis->size() == 1 ? axis_of(axis->front()) : std::nullopt;
    if (sense) effect.sense = sense_named(*sense);
    if (axis && !effect.axis) return complain("axis", fmt::format("axis: expected X, Y or Z, got \"{}\"", *axis));
    if (sense && !effect.sense)
      return complain("sense", fmt::format("sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", *sense));
    if (rule.kind == EffectKind::angular || rule.kind == EffectKind::squareness) return read_code(rule.kind);
    if (table_.contains("code")) return complain("code", "code: only angular and squareness have one");
    if (rule.needs_axis && !effect.axis) return complain("axis", "axis: expected X, Y or Z");
    if (!effect.sense && effect.axis) effect.sense = static_cast<Sense>(index_of(*effect.axis));
    if (!effect.sense) return complain("sense", "sense: expected EX, EY, EZ, EA, EB or EC");
    if (!effect.axis) effect.axis = direction_of(*effect.sense);
    effect_.component = curve_of(*effect.sense, *effect.axis);
  }

  void read_code(EffectKind kind) {
    PlacedEffect& effect = effect_.effect;
    const std::string word = reader_.word(table_, "code").value_or("");
    const auto code = component_of(word);
    const bool squareness = kind == EffectKind::squareness;
    if (!code || (squareness ? !is_squareness(*code) : !is_angular(*code)))
      return complain("code",
                      fmt::format("code: expected {}, got \"{}\"", squareness ? "C0Y, B0Z or A0Z" : "EAX … ECZ", word));
    if (effect.sense) return complain("sense", fmt::format("sense: {} has a code and no sense", name_of(kind)));
    const Axis axis = !squareness ? moving_axis(*code) : *code == Component::C0Y ? Axis::Y : Axis::Z;
    if (effect.axis && *effect.axis != axis)
      return complain("axis", fmt::format("axis: {} belongs to {}", word, letter_of(axis)));
    effect.axis = axis;
    effect.code = code;
    effect_.component = *code;
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
  void read_sensor() {
    std::string name = reader_.word(table_, "sensor").value_or("");
    if (name.starts_with("t_") && name.ends_with("_degC")) name = name.substr(2, name.size() - 7);
    if (!reading_.parts.variables.temperatures.contains(name))
      complain("sensor", fmt::format("sensor: expected a sensor of this file, got \"{}\"", name));
    effect_.effect.sensor = name;
  }

  void read_parameters(const Rule& rule) {
    const toml::table* table = reader_.child(table_, "parameters");
    Names all = rule.required;
    all.insert(all.end(), rule.optional.begin(), rule.optional.end());
    if (table == nullptr || (rule.required.empty() && table->empty()))
      return complain("parameters", fmt::format("parameters: expected {{ {} }}", fmt::join(all, ", ")));
    reader_.only(*table, all, "parameters");
    for (const std::string& name : all) {
      const bool required = std::find(rule.required.begin(), rule.required.end(), name) != rule.required.end();
      if (!required && !table->contains(name)) continue;
      const bool divides = name == "period_mm" || name == "tau_s" || name == "u0_mm";
      required_into(reader_, *table, name, divides ? Sign::positive : Sign::any, effect_.effect.parameters[name]);
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
  for (const toml::table* table : reading.reader.children(reading.file, "effect")) EffectReader(reading, *table).read();
}

}  // namespace ecs::emulator
