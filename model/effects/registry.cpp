// The effects of the library, a line each. A new effect is a file that defines it and a line in this list.
#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>

#include "model/effects/artefact_place.hpp"
#include "model/effects/definition.hpp"

// In the order in which lists of effects are printed; the effects of the user last.
#define ECS_EFFECTS(EFFECT)  \
  EFFECT(offset)             \
  EFFECT(scale)              \
  EFFECT(tilt_scale)         \
  EFFECT(progressive)        \
  EFFECT(cyclic)             \
  EFFECT(backlash)           \
  EFFECT(reversal_curve)     \
  EFFECT(step)               \
  EFFECT(sag)                \
  EFFECT(angular)            \
  EFFECT(squareness)         \
  EFFECT(measurement_line)   \
  EFFECT(thermal_scale)      \
  EFFECT(thermal_drift)      \
  EFFECT(thermal_bend)       \
  EFFECT(set_up_rotation)    \
  EFFECT(location)           \
  EFFECT(linear_axes)        \
  EFFECT(head_bending)       \
  EFFECT(machine_bending)    \
  EFFECT(tool_bending)       \
  EFFECT(ball_on_table)      \
  EFFECT(ball_in_spindle)    \
  EFFECT(artefact_angle)     \
  EFFECT(artefact_form)      \
  EFFECT(warm_up)            \
  EFFECT(time_drift)         \
  EFFECT(air_refraction)     \
  EFFECT(dead_path)          \
  EFFECT(cosine)             \
  EFFECT(servo_lag)          \
  EFFECT(delay)              \
  EFFECT(load)               \
  EFFECT(reversal_spike)     \
  EFFECT(friction)           \
  EFFECT(map_polarity)       \
  EFFECT(map_gain)           \
  EFFECT(map_shift)          \
  EFFECT(map_direction_swap) \
  EFFECT(user)

namespace ecs::model {
namespace effects {

#define ECS_DECLARE(name) EffectDefinition name();
ECS_EFFECTS(ECS_DECLARE)
#undef ECS_DECLARE

}  // namespace effects

const std::vector<EffectDefinition>& effect_library() {
#define ECS_CALL(name) effects::name(),
  static const std::vector<EffectDefinition> library{ECS_EFFECTS(ECS_CALL)};
#undef ECS_CALL
  return library;
}

EffectId effect_named(std::string_view name) {
  for (const EffectDefinition& definition : effect_library())
    if (definition.id == name) return &definition;
  return nullptr;
}

EffectId effect_at(Place place) {
  const auto& library = effect_library();
  const auto found = std::ranges::find_if(library, [&](const EffectDefinition& one) { return one.place == place; });
  assert(found != library.end());
  return &*found;
}

namespace {

/// The direction in which the machine has no axis that could correct the effect.
std::optional<Axis> missing_axis(const EffectInstance& effect, const params::Machine& machine) {
  const bool known = std::ranges::any_of(machine.axes, [](const auto& axis) { return axis.has_value(); });
  if (!known || !effect.sense || is_rotation(*effect.sense) || !effect.definition().is_carried()) return std::nullopt;
  const Axis direction = direction_of(*effect.sense);
  return machine.axes[index_of(direction)] ? std::nullopt : std::optional(direction);
}

/// Readings of a ball are those of rotary axes, and may show errors of the linear ones.
bool acts_on_rotary_axes(const EffectInstance& effect) {
  return effect.rotary && components_of(effect.definition()).empty();
}

/// Why no row of the unit on that machine follows the effect's conditions; empty: there can be rows.
std::string missing_input(const EffectInstance& effect, const params::Machine& machine) {
  for (const LiveTerm& term : effect.definition().live) {
    if (term.source == LiveSource::load && !machine.states_load)
      return "no load reaches the unit (`load_kg = true` in [inputs] of the machine file)";
    if (term.source == LiveSource::motion && !live_motion_of(effect, machine))
      return "the machine file names no motion that warms the machine (`motion_X_mm_min` in [inputs])";
    const bool material = term.source == LiveSource::material;
    if (!material && term.source != LiveSource::sensor && term.source != LiveSource::difference) continue;
    for (const std::string& sensor : {material ? std::string(kMaterialSensor) : effect.sensor, effect.sensor2})
      if (!sensor.empty() && !machine.input_of(sensor))
        return fmt::format("the machine file names no input of the unit for {} ([inputs])", sensor);
    if (effect.sense && is_rotation(*effect.sense) && (term.law != ThermalLaw::shift || !effect.axis))
      return "the unit has no row for a rotation that changes along its axis, or of no axis";
  }
  return {};
}

}  // namespace

std::optional<Axis> live_motion_of(const EffectInstance& effect, const params::Machine& machine) {
  if (effect.axis && machine.full_duty_mm_min[index_of(*effect.axis)]) return effect.axis;
  for (const Axis a : kAllAxes)
    if (machine.full_duty_mm_min[index_of(a)]) return a;
  return std::nullopt;
}

bool is_rotary_error(const EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  return acts_on_rotary_axes(effect) && definition.carrier == Carrier::error_map &&
         (definition.place == Place::location || definition.place == Place::axis_and_sense ||
          !definition.motions.empty() || definition.bending != nullptr);
}

std::string rotary_axes_refused(const params::Machine& machine) {
  bool after_rotary = false;
  for (const char letter : machine.rotary_configuration) {
    const bool is_rotary = letter >= 'A' && letter <= 'C';
    if (letter != 'T' && !is_rotary && after_rotary)
      return fmt::format(
          "a rotary axis carries the linear axis {}, and the unit does not compensate such a kinematic chain", letter);
    after_rotary = letter != 'T' && (is_rotary || after_rotary);
    const auto& axis = machine.rotary[static_cast<std::size_t>(is_rotary ? letter - 'A' : 0)];
    if (is_rotary && !(axis && axis->resolution_deg))
      return fmt::format(
          "the machine file states no resolution_deg of the axis {}: the unit has no input for its angle. State it if "
          "there is one, or use machine data or a table of the control",
          letter);
  }
  return machine.rotary_configuration.empty()
             ? "this is known only with a machine file that has rotary axes (--machine)"
             : "";
}

namespace {

/// Why no map of this machine has the error of a rotary axis; "" where it has.
std::string rotary_error_refused(const EffectInstance& effect, const params::Machine& machine) {
  constexpr double kWholeTurn_deg = 360.0;
  if (std::string refused = rotary_axes_refused(machine); !refused.empty()) return refused;
  if (effect.definition().place == Place::artefact && !effects::tilting_axis(machine.rotary_configuration))
    return "no rotary axis carries the tool";
  const auto& axis = effect.axis ? machine.rotary[index_of(*effect.axis)] : std::nullopt;
  if (!effect.traits().adds_up || !axis || axis->travel_deg[1] - axis->travel_deg[0] < kWholeTurn_deg) return "";
  return "the curve of an axis that turns fully is the same again after a turn: correct its ratio in the control";
}

}  // namespace

std::string_view not_of_machine(const EffectInstance& effect) {
  const bool slope = effect.id == effect_named("scale");
  if (effect.from_run > 0)
    return slope ? "the alignment of the optics in some runs, not an error of the machine"
                 : "the zero of the readout in some runs, not an error of the machine";
  if (effect.line <= 1) return "";
  return slope ? "the alignment of the optics on one line, not an error of the machine"
               : "the zero of the readout on one line, not an error of the machine";
}

bool is_of_measurement(const EffectInstance& effect) {
  return effect.traits().of_measurement || !not_of_machine(effect).empty();
}

bool is_carried(const EffectInstance& effect, const params::Machine& machine) {
  if (!not_of_machine(effect).empty()) return false;
  if (acts_on_rotary_axes(effect)) return is_rotary_error(effect) && rotary_error_refused(effect, machine).empty();
  return effect.definition().is_carried() && !missing_axis(effect, machine) && missing_input(effect, machine).empty();
}

std::string how_compensated(const EffectInstance& effect, const params::Machine& machine) {
  if (const auto zero = not_of_machine(effect); !zero.empty()) return std::string(zero);
  if (is_rotary_error(effect)) {
    std::string refused = rotary_error_refused(effect, machine);
    if (!refused.empty() || effect.definition().place != Place::axis_and_sense)
      return refused.empty() ? std::string(effect.definition().how) : refused;
    return fmt::format("curve {}{} of the rotary axes in the map", name_of(*effect.sense), axis_letter(effect));
  }
  if (acts_on_rotary_axes(effect) && effect.definition().is_carried())
    return effect.definition().carrier == Carrier::inputs
               ? "the unit has no thermal row for a rotary axis"
               : "a constant in readings of a rotary axis is the zero of the probe or of the sensor";
  if (const auto axis = missing_axis(effect, machine))
    return fmt::format("the machine has no axis {} that could correct it", letter_of(*axis));
  if (std::string missing = missing_input(effect, machine); !missing.empty()) return missing;
  return std::string(effect.definition().how);
}

namespace {

constexpr std::string_view kShift = "um", kTilt = "um_per_m";

std::string in_degrees(std::string_view parameter) {
  constexpr std::string_view kLength = "_mm";
  if (!parameter.ends_with(kLength)) return std::string(parameter);
  return std::string(parameter.substr(0, parameter.size() - kLength.size())) + "_deg";
}

}  // namespace

bool is_direction(const EffectInstance& effect) {
  return effect.definition().place == Place::location && effect.sense && is_rotation(*effect.sense);
}

std::string unit_of(const EffectInstance& effect, const ParameterDefinition& parameter) {
  constexpr std::string_view kLength = "um";
  if (effect.rotary && parameter.unit == "mm") return "deg";
  const Place place = effect.definition().place;
  const bool of_rotation = effect.sense && is_rotation(*effect.sense) && place != Place::set_up;
  if (!of_rotation || !parameter.unit.starts_with(kLength)) return std::string(parameter.unit);
  return "um/m" + std::string(parameter.unit.substr(kLength.size()));
}

std::string shown_name(std::string_view parameter, const EffectInstance& effect) {
  if (is_direction(effect) && parameter == kShift) return std::string(kTilt);
  return effect.rotary ? in_degrees(parameter) : std::string(parameter);
}

std::string shown_name(const ParameterEstimate& parameter) {
  if (parameter.is_direction && parameter.name == kShift) return std::string(kTilt);
  return parameter.unit == "deg" ? in_degrees(parameter.name) : parameter.name;
}

std::string spoken_name(std::string_view shown, std::string_view unit) {
  constexpr std::array<std::string_view, 8> kUnits{"um", "mm", "m", "s", "ms", "rad", "mrad", "deg"};
  std::string words;
  for (std::size_t at = 0; at <= shown.size();) {
    const std::size_t end = std::min(shown.find('_', at), shown.size());
    const std::string_view word = shown.substr(at, end - at);
    if (!unit.empty() && std::ranges::find(kUnits, word) != kUnits.end()) break;
    words.append(words.empty() ? "" : " ").append(word);
    at = end + 1;
  }
  // Symbols of the library that nobody reads as a word; of a user's own formula they are what its user wrote.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 15> kWords{{
      {"u0", "decay length"},
      {"c", "size"},
      {"k2", "quadratic term"},
      {"k3", "cubic term"},
      {"amplitude2", "amplitude of the second harmonic"},
      {"phase2", "phase of the second harmonic"},
      {"tau", "time constant"},
      {"lag", "time constant"},
      {"stands", "standstill"},
      {"slower", "slow part"},
      {"late", "lost motion"},
      {"c0y", "squareness C0Y"},
      {"b0z", "squareness B0Z"},
      {"a0z", "squareness A0Z"},
      {"rms", "rms over the measured range"},
  }};
  const auto known =
      std::ranges::find(kWords, std::string_view(words), &std::pair<std::string_view, std::string_view>::first);
  return unit.empty() || words == shown || known == kWords.end() ? words : std::string(known->second);
}

std::string library_name(std::string_view shown, const EffectInstance& effect) {
  constexpr std::string_view kAngle = "_deg";
  if (is_direction(effect) && shown == kTilt) return std::string(kShift);
  if (!effect.rotary || !shown.ends_with(kAngle)) return std::string(shown);
  return std::string(shown.substr(0, shown.size() - kAngle.size())) + "_mm";
}

std::string_view EffectDefinition::searched_parameter() const {
  for (const ParameterDefinition& parameter : parameters)
    if (parameter.coding == Coding::searched) return parameter.name;
  return "";
}

}  // namespace ecs::model
