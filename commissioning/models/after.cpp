#include "commissioning/models/after.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "model/diagnosis/words.hpp"
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

namespace {

/// Sizes beyond so many standard deviations are no scatter; smaller shares of the squares are not worth a sentence.
constexpr double kFarFromZero = 4.0, kWorthTelling = 0.05;

/// One column taken out of what is left: its size, and what the squares fall by.
struct TakenOut {
  double size = 0.0;
  double squares = 0.0;
};
TakenOut take_out(const std::vector<double>& column, std::vector<double>& left) {
  double own = 0.0, with = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    own += column[i] * column[i];
    with += column[i] * left[i];
  }
  if (own <= 0.0) return {};
  for (std::size_t i = 0; i < left.size(); ++i) left[i] -= with / own * column[i];
  return {with / own, with * with / own};
}

std::vector<double> about_mean(std::vector<double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  for (double& value : values) value -= sum / static_cast<double>(values.size());
  return values;
}

/// Constant, slope and difference of the directions of readings of one sense along one axis, one after the other.
void add_parts(const Observations& after, const std::vector<std::size_t>& rows, std::vector<RestPart>& parts) {
  constexpr double kFitted = 3.0;
  const Sense sense = after.sense[rows.front()];
  const Axis axis = after.axis[rows.front()];
  std::vector<double> left, place, side;
  for (const std::size_t k : rows) {
    left.push_back(after.reading[k]);
    place.push_back(after.p_mm(k, axis) / (after.rotary ? 1.0 : 1000.0));
    side.push_back(static_cast<double>(after.approach[k]) / 2.0);
  }
  const TakenOut constant = take_out(std::vector<double>(rows.size(), 1.0), left);
  const TakenOut slope = take_out(about_mean(std::move(place)), left);
  const TakenOut reversal = take_out(about_mean(std::move(side)), left);
  double squares = 0.0;
  for (const double value : left) squares += value * value;
  const double variance = squares / std::max(1.0, static_cast<double>(rows.size()) - kFitted);
  const std::string_view unit = laser::unit_of(sense);
  const std::string of = model::readings_word(sense, axis, after.rotary);
  const auto add = [&](const char* shape, const TakenOut& taken, const std::string& text) {
    if (taken.squares > kFarFromZero * kFarFromZero * variance)
      parts.push_back({shape, sense, axis, taken.size, root_mean(taken.squares, after.size()), text});
  };
  add("constant", constant, fmt::format("a constant {:+.2g} {} of {}: zero or datum", constant.size, unit, of));
  add("slope", slope,
      fmt::format("a slope of {:+.2g} {}/{} of {}: scale or temperature", slope.size, unit, after.rotary ? "deg" : "m",
                  of));
  add("reversal", reversal,
      fmt::format("a difference of {:+.2g} {} between forward and reverse of {}: lost motion", reversal.size, unit,
                  of));
}

}  // namespace

std::vector<RestPart> parts_of_rest(const Observations& after) {
  std::map<std::tuple<Sense, Axis>, std::vector<std::size_t>> lines;
  double squares = 0.0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    squares += after.reading[k] * after.reading[k];
    if (!after.on_path(k)) lines[{after.sense[k], after.axis[k]}].push_back(k);
  }
  std::vector<RestPart> parts;
  for (const auto& [line, rows] : lines) add_parts(after, rows, parts);
  const double least_um = std::sqrt(kWorthTelling) * root_mean(squares, after.size());
  std::erase_if(parts, [&](const RestPart& part) { return part.rms_um < least_um; });
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.rms_um > b.rms_um; });
  return parts;
}

}  // namespace ecs::commissioning
