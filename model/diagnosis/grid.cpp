// At which values a nonlinear parameter is tried: fine enough not to step over anything, facts of the machine first.
#include <algorithm>
#include <cmath>

#include "model/diagnosis/search.hpp"

namespace ecs::model {
namespace {

using enum EffectId;

std::vector<double> logarithmic(double least, double greatest, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(least * std::pow(greatest / least, static_cast<double>(i) / static_cast<double>(count - 1)));
  return values;
}

std::vector<double> positions(const Observations& data, const Acting& acting, Axis axis) {
  std::vector<double> p;
  for (const std::size_t k : acting.rows) p.push_back(data.p_mm(k, axis));
  return distinct(std::move(p), 1e-5);
}

/// Greatest step of which all positions are multiples, 0 if it is below `least`.
double common_step(const std::vector<double>& p, double least) {
  double step = 0.0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    double a = std::max(step, p[i] - p[i - 1]), b = std::min(step, p[i] - p[i - 1]);
    while (b > 1e-3 * least) {
      const double rest = std::abs(a - b * std::round(a / b));
      a = b;
      b = rest;
    }
    step = a;
    if (step < least) return 0.0;
  }
  return step;
}

Grid periods(const Observations& data, const Acting& acting, Axis axis, std::size_t most) {
  Grid grid;
  const std::vector<double> p = positions(data, acting, axis);
  if (p.size() < 6) return grid;
  const double travel = p.back() - p.front();
  const double mean_step = travel / static_cast<double>(p.size() - 1);
  const double step = common_step(p, 0.02 * mean_step);
  double highest = step > 0.0 ? 0.5 / step : 5.0 / mean_step;
  highest = std::min(highest, 5.0 / mean_step);
  const double lowest = 1.5 / travel;  // fewer turns than that are a curve, not a period
  constexpr double kOversampling = 3.0;
  const auto wanted = static_cast<std::size_t>(std::max(1.0, kOversampling * travel * (highest - lowest)));
  const std::size_t count = std::min(wanted, most);
  for (std::size_t i = 0; i <= count; ++i) {
    const double frequency = lowest + static_cast<double>(i) / (kOversampling * travel);
    if (step > 0.0 && frequency > highest * 1.0001) break;
    grid.values.push_back(1.0 / frequency);
  }
  grid.independent = std::max(2.0, static_cast<double>(grid.values.size()) / kOversampling);
  const auto& machine_axis = data.machine.axes[index_of(axis)];
  if (machine_axis) {
    for (const auto& pitch : {machine_axis->screw_pitch_mm, machine_axis->scale_pitch_mm}) {
      if (!pitch) continue;
      for (const double part : {1.0, 0.5, 2.0, 1.0 / 3.0, 0.25, 0.2, 3.0, 4.0, 5.0, 0.1})
        if (*pitch * part * 1.5 < travel) grid.facts.push_back(*pitch * part);
    }
  }
  return grid;
}

Grid steps(const Observations& data, const Acting& acting, Axis axis, std::size_t most) {
  Grid grid;
  const std::vector<double> p = positions(data, acting, axis);
  const std::size_t stride = std::max<std::size_t>(1, p.size() / most);
  for (std::size_t i = stride; i < p.size(); i += stride) grid.values.push_back(0.5 * (p[i] + p[i - 1]));
  grid.independent = static_cast<double>(p.size());
  return grid;
}

Grid shifts(const Observations& data, const EffectInstance& effect) {
  Grid grid;
  double widest = 0.0, increment = 1e300;
  for (const laser::MapTable& table : data.map->tables) {
    if (effect.axis && moving_axis(table.component) != *effect.axis) continue;
    if (table.position_mm.size() < 2) continue;
    widest = std::max(widest, table.position_mm.back() - table.position_mm.front());
    increment = std::min(increment, (table.position_mm.back() - table.position_mm.front()) /
                                        static_cast<double>(table.position_mm.size() - 1));
  }
  if (widest <= 0.0) return grid;
  const auto add = [&](double shift) {
    grid.values.push_back(shift);
    grid.values.push_back(-shift);
  };
  // its size is not fitted: a small shift tried twice too large looks worse than none
  const double step = std::max(0.5 * increment, widest / 240.0);
  for (double shift = widest / 2000.0; shift < step; shift *= 1.3) add(shift);
  for (double shift = step; shift <= 0.25 * widest; shift += step) add(shift);
  grid.independent = static_cast<double>(grid.values.size()) / 2.0;
  return grid;
}

}  // namespace

Grid grid_of(const Regressors& regressors, const EffectInstance& effect, const Acting& acting,
             std::size_t most_values) {
  const Observations& data = regressors.data();
  Grid grid;
  if (const auto held = effect.parameters.find(std::string(nonlinear_parameter_of(effect.id)));
      held != effect.parameters.end()) {
    grid.values = {held->second};
    return grid;
  }
  if (effect.id == cyclic) return periods(data, acting, *effect.axis, most_values);
  if (effect.id == step) return steps(data, acting, *effect.axis, 200);
  if (effect.id == map_shift) return shifts(data, effect);
  const auto extent = [&](const Column& column) {
    double least = 1e300, greatest = 0.0;
    for (const std::size_t k : acting.rows) {
      greatest = std::max(greatest, column[k]);
      if (column[k] > 0.0) least = std::min(least, column[k]);
    }
    return std::pair{std::min(least, greatest), greatest};
  };
  if (effect.id == warm_up && !acting.rows.empty()) {
    const double last = extent(data.time_s).second;
    if (last > 0.0) grid.values = logarithmic(last / 20.0, 1.5 * last, 10);
    grid.independent = 4.0;
    return grid;
  }
  if (effect.id == reversal_spike && !acting.rows.empty()) {
    const auto [least, greatest] = extent(data.travel_since_reversal_mm);
    if (greatest > 0.0) grid.values = logarithmic(std::max(0.3 * least, 1e-3 * greatest), 1.5 * greatest, 16);
    grid.independent = 5.0;
    return grid;
  }
  grid.values = {0.0};
  return grid;
}

}  // namespace ecs::model
