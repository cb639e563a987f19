#include "commissioning/models/after.hpp"

#include <cmath>
#include <map>
#include <tuple>

#include "model/effects/definition.hpp"

namespace ecs::commissioning {
namespace {

using model::Observations;

/// Readings less every effect that the unit can compensate.
std::vector<double> left_over(const model::Fit& fit, const Observations& data) {
  std::vector<double> left = data.reading;
  for (const model::EffectFit& effect : fit.effects) {
    if (!is_carried(effect.effect, data.machine)) continue;
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= effect.contribution[k];
  }
  return left;
}

struct Sums {
  double now = 0.0, predicted = 0.0, achieved = 0.0;
  std::size_t before = 0, after = 0;
  std::string axes{};
};

/// Path, sense, axis and direction: lines first.
using Direction = std::tuple<std::string, Sense, Axis, int>;

Sums& sums_of(std::map<Direction, Sums>& groups, const Observations& data, std::size_t k) {
  Sums& sums = groups[{data.path_name(k), data.sense[k], data.axis[k], -data.approach[k]}];
  if (data.on_path(k)) sums.axes = axes_of(data.path_of(k));
  return sums;
}

double root_mean(double sum, std::size_t count) {
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

std::vector<AfterDirection> after_by_direction(const model::Fit& fit, const Observations& before,
                                               const Observations& after) {
  std::map<Direction, Sums> groups;
  const std::vector<double> left = left_over(fit, before);
  for (std::size_t k = 0; k < before.size(); ++k) {
    Sums& sums = sums_of(groups, before, k);
    sums.now += before.reading[k] * before.reading[k];
    sums.predicted += left[k] * left[k];
    ++sums.before;
  }
  for (std::size_t k = 0; k < after.size(); ++k) {
    Sums& sums = sums_of(groups, after, k);
    sums.achieved += after.reading[k] * after.reading[k];
    ++sums.after;
  }
  std::vector<AfterDirection> list;
  for (const auto& [key, sums] : groups) {
    AfterDirection one{std::get<1>(key),
                       std::get<2>(key),
                       -std::get<3>(key),
                       root_mean(sums.now, sums.before),
                       root_mean(sums.predicted, sums.before),
                       {},
                       sums.before,
                       sums.after,
                       std::get<0>(key),
                       sums.axes};
    if (sums.after > 0) one.achieved_um = root_mean(sums.achieved, sums.after);
    list.push_back(one);
  }
  return list;
}

}  // namespace ecs::commissioning
