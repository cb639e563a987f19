#include "model/fit/user_start.hpp"

#include <cmath>

#include "model/fit/core.hpp"

namespace ecs::model {
namespace {

constexpr std::size_t kTrials = 12;

/// Place i of a sequence that fills 0 … 1 evenly (radical inverse).
double filling(std::size_t i, std::size_t base) {
  double place = 0.0, part = 1.0;
  for (; i > 0; i /= base) {
    part /= static_cast<double>(base);
    place += part * static_cast<double>(i % base);
  }
  return place;
}

/// Trial 0 is what the user wrote; the others spread over the range, or over a factor of five either way.
double start_at(const UserParameter& parameter, std::size_t trial, std::size_t dimension) {
  constexpr std::size_t kBases[] = {2, 3, 5, 7};
  const double start = start_of(parameter);
  if (trial == 0) return start;
  const double place = filling(trial, kBases[dimension % 4]);
  if (parameter.least && parameter.greatest) return std::lerp(*parameter.least, *parameter.greatest, place);
  return start * std::pow(5.0, 2.0 * place - 1.0);
}

}  // namespace

std::vector<std::size_t> nonlinear_user_parameters(const EffectInstance& effect, const Observations& data) {
  std::vector<std::size_t> places;
  if (!effect.is_user()) return places;
  const auto formulas = UserFormulas::compile(effect, data);
  if (!formulas) return places;
  std::vector<double> start;
  for (const UserParameter& parameter : effect.user) start.push_back(start_of(parameter));
  const std::vector<bool> linear = formulas->linear_parameters(start);
  for (std::size_t i = 0; i < linear.size(); ++i)
    if (!linear[i] && !effect.user[i].value) places.push_back(i);
  return places;
}

EffectInstance with_best_start(const Model& model, const EffectInstance& candidate, const Regressors& regressors) {
  const std::vector<std::size_t> places = nonlinear_user_parameters(candidate, regressors.motions());
  EffectInstance best = candidate;
  if (places.empty()) return best;
  double least = 0.0;
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    Model with = model;
    with.effects.push_back(candidate);
    for (std::size_t d = 0; d < places.size(); ++d) {
      const UserParameter& parameter = candidate.user[places[d]];
      with.effects.back().fitted[parameter.name] = start_at(parameter, trial, d);
    }
    auto assembly = Assembly::of(with, regressors);
    if (!assembly && trial == 0) return candidate;
    if (!assembly) continue;  // a start from which its formula has no finite values
    const CoreFit fit = fitted(*assembly, regressors, {true, true});
    const double squares = fit.residual.squaredNorm();
    if (!std::isfinite(squares) || (trial > 0 && squares >= least)) continue;
    least = squares;
    const Slot& slot = assembly->slots.back();
    for (std::size_t j = 0; j < slot.user_nonlinear.size(); ++j)
      if (slot.nonlinear_free[j]) best.user[slot.user_nonlinear[j]].start = slot.nonlinear[j];
  }
  return best;
}

}  // namespace ecs::model
