#include "commissioning/volume/fitted_rotary.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "commissioning/models/view.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/compiled_rotary.hpp"
#include "model/regression/candidates.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kStep_deg = 5.0, kTurn_deg = 360.0;

std::vector<double> angles_of(const std::optional<params::Machine>& machine, Axis axis) {
  std::array<double, 2> travel_deg{0.0, kTurn_deg};
  if (machine && machine->rotary[index_of(axis)]) travel_deg = machine->rotary[index_of(axis)]->travel_deg;
  const bool turns = travel_deg[1] - travel_deg[0] >= kTurn_deg;
  const double span = std::min(travel_deg[1] - travel_deg[0], kTurn_deg);
  const auto steps = static_cast<std::size_t>(std::ceil(span / kStep_deg));
  std::vector<double> angles;
  for (std::size_t i = 0; i < steps + (turns ? 0 : 1); ++i)
    angles.push_back(travel_deg[0] + span * static_cast<double>(i) / static_cast<double>(steps));
  return angles;
}

/// Of what the effect adds in that sense at an angle: its sizes in um or um/m.
double standard_uncertainty_of(const model::EffectFit& effect, Sense sense) {
  const auto& motions = effect.effect.definition().motions;
  double square = 0.0;
  for (const model::ParameterEstimate& one : effect.parameters) {
    const auto term = std::ranges::find(motions, one.name, &model::MotionTerm::parameter);
    if (one.sigma && one.unit.starts_with("um") && (motions.empty() || (term != motions.end() && term->sense == sense)))
      square += *one.sigma * *one.sigma;
  }
  return std::sqrt(square);
}

volume::RotaryTable& table_for(volume::RotaryErrors& errors, kinematics::Joint joint, Sense sense, Approach side,
                               const std::vector<double>& angles_deg) {
  for (volume::RotaryTable& table : errors.tables)
    if (table.joint == joint && table.sense == sense && table.approach == side) return table;
  const std::vector<double> nothing(angles_deg.size(), 0.0);
  return errors.tables.emplace_back(volume::RotaryTable{joint, sense, side, angles_deg, nothing, nothing});
}

std::array<std::size_t, 2> place_of(const model::EffectInstance& location) {
  return {index_of(*location.axis), static_cast<std::size_t>(*location.sense)};
}

/// Of s = k + e the readings show s alone. Where k (with its noise) and e are normal about 0 and independent, e / s has
/// Cauchy's distribution, its middle at 1/(1 + q²) and its scale q/(1 + q²), q the ratio of their standard deviations
/// (G. Marsaglia, J. Amer. Statist. Assoc. 60 (1965) 193). For every q, |e| > 6.4 |s| has a probability below 5 %; it
/// is largest near q = 1. Half of that is the standard uncertainty of which the double covers e.
constexpr double kUncertaintyOfShare = 3.2;

/// A location error that is not told from what was fitted: 0, and each of the two as uncertain as their shares of the
/// sum are, while the sum keeps its certainty by the tie.
void add_exchangeable(FittedRotary& out, const model::Exchangeable& one) {
  const auto of = place_of(one.effect);
  const double u = kUncertaintyOfShare * one.stands_for;
  out.errors.location_u[of[0]][of[1]] = u;
  out.errors.location_given[of[0]][of[1]] = true;
  std::string others;
  for (const model::Exchangeable::Share& share : one.shares) {
    const auto other = place_of(share.of);
    if (!out.errors.location_given[other[0]][other[1]]) continue;
    auto& u_of_other = out.errors.location_u[other[0]][other[1]];
    u_of_other = std::hypot(u_of_other.value_or(0.0), share.by * u);
    out.errors.ties.push_back({of, other, -share.by});
    others += fmt::format("{}{}", others.empty() ? "" : ", ", place_text(share.of));
  }
  const std::string_view unit = is_rotation(*one.effect.sense) ? "um/m" : "um";
  out.not_told.push_back(fmt::format(
      "{}: these readings cannot distinguish it from the effect fitted instead. If it alone were the cause, it would "
      "be "
      "{} {}. Any share of that may be its own: it is written as 0 with a standard uncertainty of {} {}{}",
      place_text(one.effect), few_digits(one.stands_for, 2), unit, few_digits(u, 2), unit,
      others.empty() ? "" : fmt::format(", which is included in that of {}; their sum keeps its own", others)));
}

/// What the effect adds to the error motions of the axis.
Result<void> add_motions(volume::RotaryErrors& errors, const model::Model& fitted, const model::EffectFit& one,
                         const std::optional<params::Machine>& machine, Axis axis) {
  const std::vector<double> angles = angles_of(machine, axis);
  for (const Approach side : {Approach::forward, Approach::reverse}) {
    ECS_TRY(motions, motions_of(fitted, one.effect, machine.value_or(params::Machine{}), axis, angles, side));
    for (const model::AddedMotion& motion : motions) {
      volume::RotaryTable& table =
          table_for(errors, static_cast<kinematics::Joint>(kAxes + index_of(axis)), motion.sense, side, angles);
      const double u = standard_uncertainty_of(one, motion.sense);
      for (std::size_t i = 0; i < angles.size(); ++i) {
        table.error[i] += motion.values[i];
        table.u[i] = std::hypot(table.u[i], u);
      }
    }
  }
  return {};
}

}  // namespace

Result<FittedRotary> fitted_rotary(const model::Model& model, const model::Fit& fit,
                                   const std::optional<params::Machine>& machine, const model::Observations& data) {
  FittedRotary out;
  const model::Model fitted = with_values(model, fit);
  bool any = false;
  for (const model::EffectFit& one : fit.effects) {
    const model::EffectInstance& effect = one.effect;
    if (!model::is_rotary_error(effect)) {
      out.left_out.push_back(
          fmt::format("{}: neither a location error nor an error motion of a rotary axis", place_text(effect)));
      continue;
    }
    if (effect.undetermined) {
      out.left_out.push_back(fmt::format("{}: the readings do not determine it", place_text(effect)));
      continue;
    }
    const auto& facts = machine && effect.axis ? machine->rotary[index_of(*effect.axis)] : std::nullopt;
    if (effect.traits().adds_up && facts && facts->travel_deg[1] - facts->travel_deg[0] >= kTurn_deg) {
      out.left_out.push_back(
          fmt::format("{}: the table of an axis that turns fully is the same again after a turn", place_text(effect)));
      continue;
    }
    if (effect.definition().bending != nullptr) {
      out.left_out.push_back(
          fmt::format("{}: no error motion of an axis; `ecs map build --from-model` without --rotary compensates it",
                      place_text(effect)));
      continue;
    }
    any = true;
    if (effect.definition().place == model::Place::location) {
      const auto [r, s] = place_of(effect);
      out.errors.location[r][s] += one.parameters.front().value;
      out.errors.location_u[r][s] =
          std::hypot(out.errors.location_u[r][s].value_or(0.0), one.parameters.front().sigma.value_or(0.0));
      out.errors.location_given[r][s] = true;
      continue;
    }
    for (const Axis axis : kAllAxes) ECS_DO(add_motions(out.errors, fitted, one, machine, axis));
  }
  for (const model::Exchangeable& one : model::exchangeable_locations(data, fitted.effects)) add_exchangeable(out, one);
  if (any) return out;
  return problem(
      ProblemKind::refused,
      "--rotary: no effect of the model is a determined error of a rotary axis (location, cyclic, backlash, …){}",
      data.through_chain.empty() ? "; location errors need readings of a ball, and --machine with the rotary axes"
                                 : "");
}

}  // namespace ecs::commissioning
