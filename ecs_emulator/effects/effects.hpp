// One physical cause as the emulator knows it: words, parameters, what it adds to a component of the machine. The
// formulas are those of docs/physics.md, "The effect library", written down independently of `model/`: the machine that
// has an effect and the method that finds it share core types only. Does not live here: how an errors file says it
// (ecs_emulator/errors), how errors add up at the tool (ecs_emulator/errors/kinematics.hpp).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "core/terms.hpp"

namespace ecs::emulator {

struct EffectDefinition;

/// What an effect depends on, at one reading or at one instant of the machine.
struct Conditions {
  double p_mm = 0.0;      ///< of the effect's axis, from its datum
  double approach = 1.0;  ///< 1 or −1
  double curve = 0.0;     ///< value at p of the effect's curve, if it has one [um or um/m]
  double time_s = 0.0;
  double feed_mm_min = 0.0;
  double load_kg = 0.0;
  double travel_since_reversal_mm = 0.0;
  double material_degC = 20.0;             ///< set where the effect depends on it
  std::array<double, 2> degC{20.0, 20.0};  ///< at the places of the effect's sensors, as many as it has
  double first_degC = 20.0;                ///< of the first of them at time 0
};

/// An effect at its place in a machine, with its size. Parameters bear the names of docs/physics.md; curves have a
/// shape instead.
struct PlacedEffect {
  const EffectDefinition* kind = nullptr;
  std::optional<Axis> axis;
  std::optional<Sense> sense;
  std::optional<Component> code;
  Approach approach = Approach::unknown;  ///< unknown: both
  std::string sensor;                     ///< of an effect that depends on one
  std::string sensor2;                    ///< of an effect that depends on two
  std::map<std::string, double, std::less<>> parameters;
  [[nodiscard]] double parameter(std::string_view name) const;  ///< 0 where there is none
};

/// "cyclic:X:EX", "angular:X:ECX", "map_polarity:X" (all curves of X), "map_polarity" (the whole map).
[[nodiscard]] std::string name_of(const PlacedEffect& effect);
/// The effects of one component each that it consists of; mostly itself alone.
[[nodiscard]] std::vector<PlacedEffect> parts_of(const PlacedEffect& effect);
/// The component of the machine that carries it. @pre it has its seat in the machine and is a part
[[nodiscard]] Component carrier_of(const PlacedEffect& effect);

struct ParameterDefinition {
  std::string_view name;
  std::string_view unit;  ///< "1": a ratio
  bool optional = false;  ///< in an errors file; if all are, at least one is given
  bool positive = false;
};

/// What says which component it sits in.
enum class PlacedBy {
  sense,
  code_of_rotation,
  code_of_squareness,
  code_of_set_up,  ///< EA, EB, EC: kept as the sense; no axis
};

struct EffectDefinition {
  std::string_view id;
  std::vector<ParameterDefinition> parameters{};  ///< those that an errors file must give come first
  bool curve = false;                             ///< in place of parameters
  PlacedBy placed_by = PlacedBy::sense;
  int sensors = 0;               ///< temperatures it depends on, by name: 0 to 2
  bool of_material = false;      ///< it depends on the temperature of the material
  bool needs_axis = false;       ///< depends on place or way of an axis; else an errors file may leave it to the sense
  bool straightness = false;     ///< acts across the axis only
  std::string_view elsewhere{};  ///< why it has no place in an errors file and where it has one; empty: it has
  /// Value of its component [um or um/m]; null where it is none of the machine's.
  double (*value)(const PlacedEffect&, const Conditions&) = nullptr;
  /// What it adds to each component that it acts in, where that is not one.
  std::vector<PlacedEffect> (*parts)(const PlacedEffect&) = nullptr;
};

/// All effects of the emulator. The order stays; new ones go to the end.
[[nodiscard]] const std::vector<EffectDefinition>& effects();
/// Null where there is none of that id.
[[nodiscard]] const EffectDefinition* effect_named(std::string_view id);

}  // namespace ecs::emulator
