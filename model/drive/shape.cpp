// The figures that a person reads off the curve of a step: level, rise, fall, end of the plateau.
#include <algorithm>
#include <cmath>

#include "model/drive/trace.hpp"

namespace ecs::model {
namespace {

/// Means over a few samples where the noise asks for it.
std::vector<double> smoothed(const std::vector<double>& value, double noise) {
  const double span = *std::max_element(value.begin(), value.end()) - *std::min_element(value.begin(), value.end());
  if (noise < 0.002 * span) return value;
  const std::ptrdiff_t reach = noise < 0.01 * span ? 1 : 2, n = std::ssize(value);
  std::vector<double> mean;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t half = std::min({reach, i, n - 1 - i});
    double sum = 0.0;
    for (std::ptrdiff_t j = i - half; j <= i + half; ++j) sum += value[static_cast<std::size_t>(j)];
    mean.push_back(sum / static_cast<double>(2 * half + 1));
  }
  return mean;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median of the upper tenth of the height.
double level_of(const std::vector<double>& v, double base) {
  std::vector<double> sorted = v;
  std::sort(sorted.begin(), sorted.end());
  const double high = sorted[static_cast<std::size_t>(0.98 * static_cast<double>(sorted.size() - 1))];
  std::vector<double> upper;
  for (const double x : v)
    if (x - base >= 0.9 * (high - base)) upper.push_back(x);
  return upper.empty() ? high : median_of(upper);
}

using Times = std::vector<double>;

/// When the curve first crosses `level` upward (`from` 0) or last crosses it downward; nothing where it does not.
std::optional<double> first_rise(const Times& t, const std::vector<double>& v, double level) {
  for (std::size_t i = 1; i < v.size(); ++i)
    if (v[i - 1] < level && v[i] >= level) return std::lerp(t[i - 1], t[i], (level - v[i - 1]) / (v[i] - v[i - 1]));
  return std::nullopt;
}
std::optional<double> last_fall(const Times& t, const std::vector<double>& v, double level) {
  for (std::size_t i = v.size() - 1; i > 0; --i)
    if (v[i - 1] >= level && v[i] < level) return std::lerp(t[i - 1], t[i], (v[i - 1] - level) / (v[i - 1] - v[i]));
  return std::nullopt;
}

std::optional<double> difference(std::optional<double> later, std::optional<double> earlier) {
  if (!later || !earlier) return std::nullopt;
  return *later - *earlier;
}

/// The straight line through two crossings, carried on by half their distance in level.
std::optional<double> carried_back(std::optional<double> near, std::optional<double> far) {
  if (!near || !far) return std::nullopt;
  return *near - 0.5 * (*far - *near);
}

}  // namespace

StepShape shape_of(const Times& time_s, const std::vector<double>& value, double noise) {
  StepShape shape;
  if (value.size() < 3) return shape;
  std::vector<double> v = smoothed(value, noise);
  const auto [least, most] = std::minmax_element(v.begin(), v.end());
  const double sense = std::abs(*least) > std::abs(*most) ? -1.0 : 1.0;
  for (double& x : v) x *= sense;
  // at rest before the move, or after it where the recorder came too late
  const auto few = static_cast<std::ptrdiff_t>(v.size() / 100 + 1);
  const double before = median_of({v.begin(), v.begin() + few}), after = median_of({v.end() - few, v.end()});
  const double top = *std::max_element(v.begin(), v.end());
  const double base = std::min(before, after);
  if (base > 0.5 * top) return shape;
  const double level = level_of(v, base), height = level - base;
  if (height < 5.0 * noise) return shape;
  shape.steady = sense * level;
  const auto at = [&](double share) { return base + share * height; };
  const auto up10 = first_rise(time_s, v, at(0.1));
  shape.rise_s = difference(first_rise(time_s, v, at(0.9)), up10);
  shape.start_s = carried_back(up10, first_rise(time_s, v, at(0.3)));
  const auto down90 = last_fall(time_s, v, at(0.9));
  shape.fall_s = difference(last_fall(time_s, v, at(0.1)), down90);
  shape.decay_start_s = difference(carried_back(down90, last_fall(time_s, v, at(0.7))), shape.start_s);
  return shape;
}

}  // namespace ecs::model
