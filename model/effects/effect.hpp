// The effect library: every named physical cause that can stand in an error model, and one place of it in a machine.
// Does not live here: what an effect contributes to a reading (regressors.hpp), model files (model/fit/model_file.hpp).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "core/component.hpp"

namespace ecs::model {

/// One cause each; the names are those of model files (docs/physics.md, effect library).
enum class EffectId : std::uint8_t {
  offset,
  scale,
  progressive,
  cyclic,
  backlash,
  reversal_curve,
  step,
  sag,
  angular,
  squareness,
  measurement_line,
  thermal_scale,
  thermal_drift,
  warm_up,
  time_drift,
  air_refraction,
  dead_path,
  cosine,
  servo_lag,
  load,
  reversal_spike,
  map_polarity,
  map_gain,
  map_shift,
  map_direction_swap,
  user,  ///< written by the user as formulas
};

/// A parameter as model files and JSON name it.
struct ParameterInfo {
  std::string_view name;
  std::string_view unit;     ///< "" for a pure number
  double least = 0.0;        ///< physical range; both 0: any value
  double greatest = 0.0;     ///<
  bool nonlinear = false;    ///< the contribution is not proportional to it
  std::string_view meaning;  ///< in plain words
};

/// What the unit can do about an effect.
enum class Carrier : std::uint8_t {
  error_map,   ///< a table of the error map
  parameters,  ///< a value among the unit's parameters (squareness, polarity, scaling, datum)
  set_up,      ///< nothing to compensate: the measurement or the commissioning is to be put right
  none,        ///< varies with something the unit does not see
};

struct EffectInfo {
  EffectId id = EffectId::offset;
  std::string_view name;         ///< "cyclic"
  std::string_view title;        ///< "Periodic error"
  std::string_view formula;      ///< contribution to a reading, as printed in the manual
  std::string_view cause;        ///< physical cause, plain words
  std::string_view tells_apart;  ///< what tells it from its neighbours
  std::vector<ParameterInfo> parameters;
  bool of_approach = false;  ///< acts only on readings of known approach of its own moving axis
  Carrier carrier = Carrier::none;
  std::string_view how;  ///< how the unit compensates it, or why it cannot
};

/// All effects of the library in the order of EffectId, `user` last.
[[nodiscard]] const std::vector<EffectInfo>& effect_library();
[[nodiscard]] const EffectInfo& info_of(EffectId id);
[[nodiscard]] std::string_view name_of(EffectId id);
[[nodiscard]] std::optional<EffectId> effect_named(std::string_view name);

/// Readings on which an effect with an `approach` acts.
enum class ApproachMode : std::uint8_t { both, forward, reverse };
[[nodiscard]] std::string_view name_of(ApproachMode mode);
[[nodiscard]] std::optional<ApproachMode> approach_mode_named(std::string_view name);

/// One formula of a user effect: its contribution to readings of one sense.
struct UserFormula {
  Sense sense = Sense::EX;
  std::string text;  ///< muParser; variables: parameters and any numeric column of the measurement set
  friend bool operator==(const UserFormula&, const UserFormula&) = default;
};

/// A parameter of a user effect: held where a value is given, else fitted from `start`, inside the range if there is
/// one.
struct UserParameter {
  std::string name;
  std::string unit;
  std::optional<double> value;
  std::optional<double> start;
  std::optional<double> least;
  std::optional<double> greatest;
  friend bool operator==(const UserParameter&, const UserParameter&) = default;
};

/// A fitted curve, to be drawn, kept in the model file and compiled into a map; linear between points.
struct FittedCurve {
  std::vector<double> p_mm;   ///< machine coordinates, ascending
  std::vector<double> value;  ///< um, um/m for angular
  [[nodiscard]] bool empty() const { return p_mm.empty(); }
  friend bool operator==(const FittedCurve&, const FittedCurve&) = default;
};

/// An effect at its place in a machine.
struct EffectInstance {
  EffectId id = EffectId::offset;
  std::optional<Axis> axis;       ///< absent where the effect has none (the whole map)
  std::optional<Sense> sense;     ///< absent for `angular`, `squareness` and the whole map
  std::optional<Component> code;  ///< of angular, squareness, measurement_line; of a map fault of one component
  ApproachMode approach = ApproachMode::both;
  std::string sensor;                        ///< column of the sensor, where one is used
  std::string name;                          ///< of a user effect
  std::vector<UserFormula> formulas;         ///< of a user effect
  std::vector<UserParameter> user;           ///< of a user effect
  std::map<std::string, double> parameters;  ///< given: held. Absent ones are fitted from the data
  std::map<std::string, double> fitted;      ///< values of the last fit; used where there are no data to fit
  FittedCurve curve;                         ///< of the last fit, for effects that are curves
  friend bool operator==(const EffectInstance&, const EffectInstance&) = default;
};

/// "cyclic:X:EX", "angular:X:ECX", "map_polarity" (the whole map), "user:encoder tilt".
[[nodiscard]] std::string to_text(const EffectInstance& effect);

/// Same cause at the same place; parameters, approach and sensor may differ.
[[nodiscard]] bool same_place(const EffectInstance& a, const EffectInstance& b);

}  // namespace ecs::model
