// An effect at its place in a machine: what a model holds. Which effects there are says the library (definition.hpp).
// Does not live here: what an effect contributes to a reading (model/regression/regressors.hpp), model files
// (model/fit/model_file.hpp).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"

namespace ecs::model {

struct EffectDefinition;
struct EffectTraits;

/// Which effect of the library: its definition, compared by identity. Null only before it is set.
using EffectId = const EffectDefinition*;

/// The name of model files, "cyclic". @pre not null
[[nodiscard]] std::string_view name_of(EffectId id);
/// Null where the library has no effect of that name.
[[nodiscard]] EffectId effect_named(std::string_view name);

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
  EffectId id = nullptr;
  std::optional<Axis> axis;       ///< absent where the effect has none (the whole map)
  std::optional<Sense> sense;     ///< absent for `angular`, `squareness` and the whole map; of a set-up its rotation,
                                  ///< of a location error its first letter: EX of XOC, EA of AOC
  std::optional<Component> code;  ///< of angular, squareness, measurement_line; of a map fault of one component
  bool rotary = false;            ///< `axis` is A, B or C: positions and lengths are in degrees
  ApproachMode approach = ApproachMode::both;
  int ball = 1;                              ///< of a ball on the table: which, in the order of the readings
  std::string sensor;                        ///< column of the sensor, where one is used
  std::string sensor2;                       ///< of the second, where their difference is
  std::string name;                          ///< of a user effect
  std::string tied_with;                     ///< what the data cannot tell it from: names with commas between them
  std::vector<UserFormula> formulas;         ///< of a user effect
  std::vector<UserParameter> user;           ///< of a user effect
  std::map<std::string, double> parameters;  ///< given: held. Absent ones are fitted from the data
  std::map<std::string, double> fitted;      ///< values of the last fit; used where there are no data to fit
  FittedCurve curve;                         ///< of the last fit, for effects that are curves
  /// Present: the readings of the last fit do not determine its values, beside the effects of these names; none: the
  /// readings do not show it.
  std::optional<std::vector<std::string>> undetermined;

  /// @pre id is set
  [[nodiscard]] const EffectDefinition& definition() const { return *id; }
  [[nodiscard]] const EffectTraits& traits() const;
  /// Written by the user as formulas.
  [[nodiscard]] bool is_user() const;
  friend bool operator==(const EffectInstance&, const EffectInstance&) = default;
};

/// X, Y, Z; of a rotary axis A, B, C. @pre it has an axis
[[nodiscard]] char axis_letter(const EffectInstance& effect);

/// "cyclic:X:EX", "cyclic:C:EC", "angular:X:ECX", "set_up_rotation:EC", "ball_on_table:2", "map_polarity" (the whole
/// map), "user:encoder tilt".
[[nodiscard]] std::string to_text(const EffectInstance& effect);

/// "cyclic:X:EX, reverse", "thermal_drift:X:EX with t_spindle_degC": the same with approach and sensors.
[[nodiscard]] std::string place_text(const EffectInstance& effect);

/// Sense and code as model files and JSON name them, "" where there is none; the rotation of a set-up is its code.
[[nodiscard]] std::string_view sense_text(const EffectInstance& effect);
[[nodiscard]] std::string_view code_text(const EffectInstance& effect);
/// What `code = "…"` says.
struct Coded {
  std::optional<Axis> axis;  ///< of a location error: the rotary axis
  std::optional<Sense> sense;
  std::optional<Component> code;
};
/// Nothing: no such component, for a set-up no rotation EA, EB, EC, for a location error none such as XOC.
[[nodiscard]] std::optional<Coded> code_named(EffectId id, std::string_view word);
/// Sets it. False: none, or of another axis than the effect has.
[[nodiscard]] bool set_code(EffectInstance& effect, std::string_view word);

/// "t_spindle_degC", "t_front_degC and t_back_degC", "" where no sensor is used.
[[nodiscard]] std::string sensors_text(const EffectInstance& effect);

/// Same cause at the same place; parameters, approach and sensors may differ.
[[nodiscard]] bool same_place(const EffectInstance& a, const EffectInstance& b);
[[nodiscard]] bool same_sensors(const EffectInstance& a, const EffectInstance& b);
/// Same place, approach and sensors; parameters may differ.
[[nodiscard]] bool same_candidate(const EffectInstance& a, const EffectInstance& b);

}  // namespace ecs::model
