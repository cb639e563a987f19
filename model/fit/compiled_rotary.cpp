#include "model/fit/compiled_rotary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "laser/map/rotary_map.hpp"
#include "model/effects/artefact_place.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/fit.hpp"

namespace ecs::model {
namespace {

constexpr double kTurn_deg = 360.0, kDeadbandCounts = 5.0;
/// Of the curves; each divides a turn into numbers of cells that the core has.
constexpr std::array kSteps_deg{5.0, 2.5, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1};
constexpr double kStepsPerPeriod = 32.0;  ///< straight between them, a wave is off by 0.5 % of its amplitude
constexpr double kOfJump_deg = 1.0;       ///< a jump becomes a ramp of one step
constexpr double kStepsPerKnot = 2.0;

/// The axis that an effect belongs to; of a sum of error motions and of bending the one next to the tool.
std::optional<Axis> axis_of(const EffectInstance& effect, const params::Machine& machine) {
  const EffectDefinition& definition = effect.definition();
  return definition.motions.empty() && definition.bending == nullptr
             ? effect.axis
             : effects::tilting_axis(machine.rotary_configuration);
}

/// The widest step that follows the effect.
double widest_step_deg(const EffectInstance& effect) {
  double step_deg = kSteps_deg.front();
  if (const auto period = given_or_fitted(effect, "period_mm"); period && *period > 0.0)  // in degrees
    step_deg = std::min(step_deg, *period / kStepsPerPeriod);
  if (effect.definition().traits.shape_of_position && given_or_fitted(effect, "position_mm"))
    step_deg = std::min(step_deg, kOfJump_deg);
  for (std::size_t i = 1; i < effect.curve.p_mm.size(); ++i)
    step_deg = std::min(step_deg, (effect.curve.p_mm[i] - effect.curve.p_mm[i - 1]) / kStepsPerKnot);
  return step_deg;
}

/// The same for all effects of the axis, among the steps that a table can have.
double step_for(std::span<const EffectInstance* const> effects, const params::Machine& machine, Axis axis) {
  double widest = kSteps_deg.front();
  for (const EffectInstance* effect : effects)
    if (axis_of(*effect, machine) == axis) widest = std::min(widest, widest_step_deg(*effect));
  const auto found = std::ranges::find_if(kSteps_deg, [&](double step) { return step <= widest + 1e-9; });
  return found == kSteps_deg.end() ? kSteps_deg.back() : *found;
}

void note_largest(CompiledModel& out, const EffectInstance& effect, const std::vector<double>& values) {
  double& largest = out.largest[to_text(effect)];
  for (const double value : values) largest = std::max(largest, std::abs(value));
}

void add_bending(CompiledModel& out, const EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  std::array<double, 6>& sizes = out.map.header.bending.*definition.bending;
  std::vector<double> added;
  for (const ParameterDefinition& parameter : definition.parameters)
    added.push_back(given_or_fitted(effect, parameter.name).value_or(0.0));
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] += added[i];
  note_largest(out, effect, added);
}

/// Adds the error motions of the effect to the curves of the axis. @return whether it has any
Result<bool> add_motions(CompiledModel& out, laser::MapRotaryAxis& one, const std::vector<double>& angles_deg,
                         const Model& fitted, const EffectInstance& effect, const params::Machine& machine, Axis axis) {
  bool any = false;
  for (const std::size_t side : {0U, 1U}) {
    ECS_TRY(motions,
            motions_of(fitted, effect, machine, axis, angles_deg, side == 1 ? Approach::forward : Approach::reverse));
    for (const AddedMotion& motion : motions) {
      any = true;
      if (one.compensation[0][0].empty())
        for (auto& curves : one.compensation) curves.fill(std::vector<double>(angles_deg.size(), 0.0));
      std::vector<double>& curve = one.compensation[side][static_cast<std::size_t>(motion.sense)];
      for (std::size_t i = 0; i < curve.size(); ++i) curve[i] -= motion.values[i];
      note_largest(out, effect, motion.values);
    }
  }
  return any;
}

/// "curve ECC of the rotary axes in the map, up to 12.3"
std::string places_text(const EffectInstance& effect, Axis axis, const CompiledModel& out) {
  const char letter = static_cast<char>('A' + index_of(axis));
  const double largest = out.largest.at(to_text(effect));
  if (effect.definition().place == Place::location)
    return fmt::format("location error {}O{} of the rotary axes in the map",
                       "XYZABC"[static_cast<std::size_t>(*effect.sense)], letter);
  if (effect.definition().bending != nullptr)
    return fmt::format("{}, up to {:.3g} {}", effect.definition().how, largest,
                       effect.definition().parameters.front().unit);
  std::vector<std::string> curves;
  if (effect.sense) curves.push_back(laser::rotary_curve_name(letter, static_cast<std::size_t>(*effect.sense)));
  for (const MotionTerm& term : effect.definition().motions) {
    std::string curve = laser::rotary_curve_name(letter, static_cast<std::size_t>(term.sense));
    if (given_or_fitted(effect, term.parameter).value_or(0.0) != 0.0 &&
        std::ranges::find(curves, curve) == curves.end())
      curves.push_back(std::move(curve));
  }
  return fmt::format("curve {} of the rotary axes in the map, up to {:.3g}", fmt::join(curves, ", "), largest);
}

}  // namespace

laser::MapRotaryAxis rotary_axis_of(char letter, const params::MachineRotaryAxis& facts) {
  laser::MapRotaryAxis one;
  one.axis.letter = letter;
  one.axis.deg_per_count = *facts.resolution_deg;
  one.axis.deadband_deg = kDeadbandCounts * std::abs(*facts.resolution_deg);
  one.axis.direction = facts.direction;
  one.axis.pivot_mm = facts.pivot_mm;
  one.axis.zero_deg = facts.transducer_zero_deg;
  return one;
}

std::vector<double> set_table_angles(laser::MapRotaryAxis& axis, const params::MachineRotaryAxis& facts,
                                     double increment_deg) {
  const auto of_turn = std::lround(kTurn_deg / increment_deg);
  auto first = std::lround(std::floor(facts.travel_deg[0] / increment_deg + 1e-9));
  auto last = std::lround(std::ceil(facts.travel_deg[1] / increment_deg - 1e-9));
  if (last - first >= of_turn) {
    first = std::clamp(0L, first, last - of_turn);
    last = first + of_turn - 1;
  }
  axis.increment_deg = increment_deg;
  axis.start_deg = static_cast<double>(first) * increment_deg;
  std::vector<double> angles_deg;
  for (long k = first; k <= last; ++k) angles_deg.push_back(static_cast<double>(k) * increment_deg);
  return angles_deg;
}

Result<std::vector<AddedMotion>> motions_of(const Model& fitted, const EffectInstance& effect,
                                            const params::Machine& machine, Axis axis,
                                            const std::vector<double>& angles_deg, Approach side) {
  std::vector<AddedMotion> motions;
  const EffectDefinition& definition = effect.definition();
  if (definition.place == Place::location || definition.bending != nullptr || axis_of(effect, machine) != axis)
    return motions;
  for (const MotionTerm& term : definition.motions) {
    const double size = given_or_fitted(effect, term.parameter).value_or(0.0);
    if (size == 0.0) continue;
    auto& motion = motions.emplace_back(AddedMotion{term.sense, {}});
    for (const double angle_deg : angles_deg) motion.values.push_back(size * term.shape(angle_deg));
  }
  if (!definition.motions.empty()) return motions;
  laser::MeasurementSet set;
  for (const double angle_deg : angles_deg) {
    laser::Reading reading;
    reading.axis = axis;
    reading.rotary = true;
    reading.sense = *effect.sense;
    reading.angle_deg[index_of(axis)] = angle_deg;
    reading.approach = side;
    reading.row = static_cast<int>(set.readings.size()) + 1;
    set.readings.push_back(reading);
  }
  Model alone = fitted;
  alone.effects = {effect};
  const Observations at = observations_of(set, alone, std::nullopt);
  ECS_TRY(at_readings, predicted(alone, at));
  auto& motion = motions.emplace_back(AddedMotion{*effect.sense, std::vector<double>(angles_deg.size())});
  for (std::size_t k = 0; k < at.size(); ++k) motion.values[static_cast<std::size_t>(at.row[k] - 1)] = at_readings[k];
  return motions;
}

Result<void> add_rotary_axes(CompiledModel& out, const Model& fitted, const params::Machine& machine,
                             std::span<const EffectInstance* const> effects) {
  if (effects.empty()) return {};
  laser::MapHeader& header = out.map.header;
  header.rotary_configuration = machine.rotary_configuration;
  for (const char letter : machine.rotary_configuration) {
    if (letter < 'A' || letter > 'C') continue;
    const auto axis = static_cast<Axis>(letter - 'A');
    const params::MachineRotaryAxis& facts = *machine.rotary[index_of(axis)];
    laser::MapRotaryAxis& one = header.rotary.emplace_back(rotary_axis_of(letter, facts));
    const auto angles_deg = set_table_angles(one, facts, step_for(effects, machine, axis));
    std::vector<std::string>& names = out.rotary[letter];
    for (const EffectInstance* effect : effects) {
      if (axis_of(*effect, machine) != axis) continue;
      if (effect->definition().place == Place::location) {
        const double size = given_or_fitted(*effect, effect->definition().parameters.front().name).value_or(0.0);
        one.axis.location[static_cast<std::size_t>(*effect->sense)] += size;
        note_largest(out, *effect, {size});
      } else if (effect->definition().bending != nullptr) {
        add_bending(out, *effect);
      } else {
        ECS_TRY(any, add_motions(out, one, angles_deg, fitted, *effect, machine, axis));
        if (!any) continue;
      }
      names.push_back(to_text(*effect));
      out.carried.push_back(fmt::format("{}: {}", names.back(), places_text(*effect, axis, out)));
    }
    if (!names.empty())
      header.processing.push_back(
          fmt::format("rotary axis {} compiled from the model: {}", letter, fmt::join(names, " + ")));
  }
  return {};
}

}  // namespace ecs::model
