// Means of a residual over a variable, a line, a run or an approach, and sentences for the shapes found in them; no
// statistics of its own (shape_fit.cpp).
#include "model/diagnosis/shape.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/diagnosis/shape_fit.hpp"
#include "model/diagnosis/words.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Means at the utmost: a choice; more cost time, fewer hide short waves.
constexpr std::size_t kMostPoints = 120;

/// Means over equal values of a variable, or over equal shares of the readings where there are more than `most`.
template <class Value>
Points points_over(const VectorXd& residual, double noise_um, const std::vector<std::size_t>& rows, const Value& value,
                   std::size_t most, double tolerance) {
  std::vector<std::pair<double, double>> pairs;
  for (const std::size_t k : rows)
    if (!std::isnan(value(k))) pairs.emplace_back(value(k), residual(static_cast<Index>(k)));
  std::sort(pairs.begin(), pairs.end());
  Points points;
  if (pairs.empty() || pairs.back().first <= pairs.front().first) return points;
  points.from = pairs.front().first;
  points.to = pairs.back().first;
  const std::size_t least = (pairs.size() + most - 1) / most;
  for (std::size_t from = 0; from < pairs.size();) {
    std::size_t to = from + 1;
    double place = pairs[from].first, sum = pairs[from].second;
    while (to < pairs.size() && (pairs[to].first - pairs[from].first <= tolerance || to - from < least)) {
      place += pairs[to].first;
      sum += pairs[to++].second;
    }
    const double n = static_cast<double>(to - from);
    points.place.push_back((place / n - points.from) / (points.to - points.from));
    points.mean.push_back(sum / n);
    points.sigma.push_back(std::max(noise_um, kLeastDivisor) / std::sqrt(n));
    from = to;
  }
  return points;
}

std::string with_unit(double value, std::string_view unit) { return fmt::format("{:.3g} {}", value, unit); }

/// @param unit  of the variable  @param name  "X", "time": where the shape runs along  @param um  unit of the readings
std::string words_of(const ShapeFit& fit, const Points& points, std::string_view unit, const std::string& name,
                     std::string_view um) {
  const double range = points.to - points.from;
  const auto period = [&](double waves) { return range / waves; };
  const auto end = [&](bool last) {
    return fmt::format("{} = {}", name, with_unit(last ? points.to : points.from, unit));
  };
  switch (fit.kind) {
    case ShapeKind::line:
      return fmt::format("a straight line, {:+.3g} {} from {} to {}", fit.size, um, end(false), end(true));
    case ShapeKind::curve:
      return fmt::format("a smooth curve over {}, {:.3g} {} from least to greatest", name, fit.size, um);
    case ShapeKind::jump:
      return fmt::format("a jump of {:+.3g} {} at {} = {}", fit.size, um, name, with_unit(points.at(fit.first), unit));
    case ShapeKind::bump:
      return fmt::format("a bump of {:+.3g} {} near {} = {}", fit.size, um, name,
                         with_unit(points.at(fit.first), unit));
    case ShapeKind::wave:
      return fmt::format("a wave of {:.3g} {} and a period of {} along {}", fit.size, um,
                         with_unit(period(fit.waves), unit), name);
    case ShapeKind::chirp: {
      const double first = period(fit.first), second = period(fit.second);
      return fmt::format("a wave of {:.3g} {} whose period {} from {:.3g} to {} along {}", fit.size, um,
                         second > first ? "grows" : "falls", first, with_unit(second, unit), name);
    }
    default:
      return fmt::format("a wave of a period of {} whose amplitude dies towards {}", with_unit(period(fit.waves), unit),
                         end(fit.first > fit.second));
  }
}

std::string proved_words(const Points& points, std::string_view unit, const std::string& name, std::string_view um) {
  const auto fit = proved_shape(points);
  return fit ? words_of(*fit, points, unit, name, um) : "";
}

/// Rows of the sense in which most is left, and of the axis that moves there most.
struct MainLine {
  Channel channel = 0;
  Axis axis = Axis::X;
  std::vector<std::size_t> rows;
};
MainLine main_line(const Observations& data, const VectorXd& residual, const std::vector<bool>& left_out) {
  std::map<std::pair<Channel, Axis>, double> squares;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k])
      squares[{data.channel(k), data.axis[k]}] += residual(static_cast<Index>(k)) * residual(static_cast<Index>(k));
  MainLine line;
  double most = -1.0;
  for (const auto& [place, sum] : squares)
    if (sum > most) {
      most = sum;
      line.channel = place.first;
      line.axis = place.second;
    }
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k] && data.channel(k) == line.channel && data.axis[k] == line.axis) line.rows.push_back(k);
  return line;
}

std::string_view unit_of_readings(const Observations& data, const MainLine& line) {
  return laser::unit_of(data.sense[line.rows.front()]);
}

/// What runs along a line: "X", of a path "angle_deg"; and its unit.
std::string name_along(const Observations& data, const MainLine& line) {
  return data.on_path(line.rows.front()) ? std::string(variable_along(data.path_of(line.rows.front())))
                                         : std::string(1, data.letter(line.axis));
}
std::string_view unit_along(const Observations& data, const MainLine& line) {
  const std::size_t first = line.rows.front();
  return data.on_path(first) && data.path_of(first).kind == PathKind::circle ? "deg" : data.position_unit();
}

Points along_axis_of(const Observations& data, const VectorXd& residual, double noise_um, const MainLine& line) {
  return points_over(
      residual, noise_um, line.rows,
      [&](std::size_t k) { return data.on_path(k) ? data.along[k] : data.position_mm[k][index_of(line.axis)]; },
      kMostPoints, 10.0 * kSamePlace_mm);
}

std::string approach_words(const Observations& data, const VectorXd& residual, double noise_um, const MainLine& line) {
  VectorXd half = residual;
  double forward = 0.0, reverse = 0.0, n_forward = 0.0, n_reverse = 0.0;
  for (const std::size_t k : line.rows) {
    const double r = residual(static_cast<Index>(k));
    half(static_cast<Index>(k)) = r * data.approach[k];
    (data.approach[k] > 0 ? forward : reverse) += data.approach[k] == 0 ? 0.0 : r;
    (data.approach[k] > 0 ? n_forward : n_reverse) += data.approach[k] == 0 ? 0.0 : 1.0;
  }
  if (n_forward < 2.0 || n_reverse < 2.0) return "";
  const double difference = forward / n_forward - reverse / n_reverse;
  const double sigma = noise_um * std::sqrt(1.0 / n_forward + 1.0 / n_reverse);
  const std::string shape = proved_words(along_axis_of(data, half, noise_um, line), unit_along(data, line),
                                         name_along(data, line), unit_of_readings(data, line));
  if (!shape.empty()) return fmt::format("half the difference of the directions is {}", shape);
  if (std::abs(difference) < 4.0 * sigma) return "";
  return fmt::format("forward lies {:+.3g} {} from reverse", difference, unit_of_readings(data, line));
}

std::string run_words(const Observations& data, const VectorXd& residual, double noise_um, const MainLine& line) {
  std::map<int, std::vector<double>> runs;
  for (const std::size_t k : line.rows) runs[data.run[k]].push_back(residual(static_cast<Index>(k)));
  if (runs.size() < 3) return "";
  std::vector<double> means, sigmas;
  std::vector<int> names;
  for (const auto& [run, values] : runs) {
    double sum = 0.0;
    for (const double v : values) sum += v;
    means.push_back(sum / static_cast<double>(values.size()));
    sigmas.push_back(noise_um / std::sqrt(static_cast<double>(values.size())));
    names.push_back(run);
  }
  const auto spread = [&](std::size_t without) {  // of the means, weighted squares about their mean
    double n = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < means.size(); ++i)
      if (i != without) {
        n += 1.0;
        sum += means[i];
      }
    for (std::size_t i = 0; i < means.size(); ++i)
      if (i != without) squares += std::pow((means[i] - sum / n) / sigmas[i], 2);
    return std::pair{squares, sum / n};
  };
  const double all = spread(means.size()).first;
  if (all < 8.0 * static_cast<double>(means.size())) return "";
  std::size_t apart = 0;
  for (std::size_t i = 1; i < means.size(); ++i)
    if (spread(i).first < spread(apart).first) apart = i;
  if (spread(apart).first < 0.1 * all)
    return fmt::format("run {} lies {:+.3g} {} from the others", names[apart], means[apart] - spread(apart).second,
                       unit_of_readings(data, line));
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  const double n = static_cast<double>(means.size());
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double x = static_cast<double>(i);
    sx += x;
    sy += means[i];
    sxx += x * x;
    sxy += x * means[i];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), start = (sy - slope * sx) / n;
  double left = 0.0;
  for (std::size_t i = 0; i < means.size(); ++i)
    left += std::pow((means[i] - start - slope * static_cast<double>(i)) / sigmas[i], 2);
  if (means.size() >= 4 && left < 0.15 * all)
    return fmt::format("a trend by run, {:+.3g} {} from run {} to run {}", slope * (n - 1.0),
                       unit_of_readings(data, line), names.front(), names.back());
  return fmt::format("each run has another zero, {:.3g} {} from least to greatest",
                     *std::max_element(means.begin(), means.end()) - *std::min_element(means.begin(), means.end()),
                     unit_of_readings(data, line));
}

constexpr std::size_t kBinsOfTime = 40, kBinsOfCondition = 24;

std::string_view unit_of_variable(const std::string& variable) {
  for (const std::string_view unit : {"degC", "hPa", "pct", "kg", "mm_min", "mm", "s"})
    if (variable.ends_with(fmt::format("_{}", unit))) return unit == "mm_min" ? "mm/min" : unit == "pct" ? "%RH" : unit;
  return "";
}

}  // namespace

std::string shape_in_words(const Observations& data, const VectorXd& residual, double noise_um,
                           const std::vector<bool>& left_out, const std::string& variable) {
  const MainLine line = main_line(data, residual, left_out);
  if (variable == "approach") return approach_words(data, residual, noise_um, line);
  if (variable == "run") return run_words(data, residual, noise_um, line);
  for (const Axis axis : kAllAxes)
    if (variable == data.position_name(axis))
      return proved_words(
          points_over(
              residual, noise_um, line.rows, [&](std::size_t k) { return data.position_mm[k][index_of(axis)]; },
              kMostPoints, 10.0 * kSamePlace_mm),
          data.position_unit(), std::string(1, data.letter(axis)), unit_of_readings(data, line));
  const Points points = points_over(
      residual, noise_um, line.rows, [&](std::size_t k) { return variable_of(data, k, variable); },
      variable == "time_s" || variable == "row" ? kBinsOfTime : kBinsOfCondition, 0.0);
  const bool is_angle = variable == name_along(data, line);
  return proved_words(points, is_angle ? unit_along(data, line) : unit_of_variable(variable),
                      variable == "time_s" ? "time" : variable, unit_of_readings(data, line));
}

std::string spectrum_in_words(const Observations& data, const VectorXd& residual, double noise_um,
                              const std::vector<bool>& left_out) {
  constexpr std::size_t kMostPeriods = 3;
  constexpr double kLeastShareOfWave = 0.1;
  const MainLine line = main_line(data, residual, left_out);
  Points points = along_axis_of(data, residual, noise_um, line);
  if (points.size() < kFewestPoints) return "";
  std::vector<std::string> periods;
  const double all = squares_about_mean(points), n = static_cast<double>(points.size());
  const double least = n + 20.0;  // what noise leaves, and a wave that it shows in one of thousands of sets
  double before = all;
  while (periods.size() < kMostPeriods && before > least) {
    const ShapeFit wave = wave_in(points);
    if (before - wave.left < std::max(kLeastShareOfWave * (all - n), 20.0)) break;
    periods.push_back(fmt::format("{:.3g} {} ({:.0f} %)", (points.to - points.from) / wave.waves,
                                  unit_along(data, line), kPercent * (before - wave.left) / all));
    points.mean = means_without(points, wave);
    before = wave.left;
  }
  return periods.empty() ? "" : fmt::format("periods along {}: {}", name_along(data, line), fmt::join(periods, ", "));
}

void describe_what_is_left(Diagnosis& diagnosis, const Observations& data, const std::vector<double>& residual,
                           const std::vector<bool>& left_out) {
  constexpr double kWorthWords = 0.05, kClearlyStronger = 0.1;  // shares of the residual variance
  const VectorXd left = Eigen::Map<const VectorXd>(residual.data(), static_cast<Index>(residual.size()));
  double strongest = 0.0;  // of the others: any order of runs is an order of rows
  for (const Dependence& one : diagnosis.where)
    if (one.variable != "row") strongest = std::max(strongest, one.strength);
  std::erase_if(diagnosis.where, [&](const Dependence& one) {
    return one.variable == "row" && one.strength < strongest + kClearlyStronger;
  });
  for (Dependence& one : diagnosis.where)
    if (one.strength >= kWorthWords)
      one.looks_like = shape_in_words(data, left, diagnosis.noise.noise_um, left_out, one.variable);
  const std::string spectrum = spectrum_in_words(data, left, diagnosis.noise.noise_um, left_out);
  if (!spectrum.empty()) diagnosis.notes.push_back(fmt::format("what is left, by {}", spectrum));
}

}  // namespace ecs::model
