// The figures that a person reads off the curve of a step: level, rise, fall, end of the plateau; transition durations
// between 10 % and 90 % of the level (IEC 60469:2013; IEEE Std 181-2011).
#include <algorithm>
#include <cmath>

#include "model/drive/trace.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Noise, as a share of the span of the curve, below which nothing is smoothed; below which three samples do, else
/// five. Choices.
constexpr double kQuiet = 0.002, kNoisy = 0.01;
/// The level is looked for among the samples of the upper tenth below this quantile: overshoot and glitches are above.
constexpr double kTopQuantile = 0.98;
/// 10 % and 90 % of the level, and where the straight parts of rise and fall are carried back from.
constexpr double kLow = 0.1, kHigh = 0.9, kLowFurther = 0.3, kHighFurther = 0.7;
/// Samples without which there is no curve; rest is the median of one in so many at either end; a curve is at least so
/// many noises high.
constexpr std::size_t kFewestSamples = 3, kSamplesARest = 100;
constexpr double kLeastHeight = 5.0;

/// Means over a few samples where the noise asks for it.
std::vector<double> smoothed(const std::vector<double>& value, double noise) {
  const double span = *std::max_element(value.begin(), value.end()) - *std::min_element(value.begin(), value.end());
  if (noise < kQuiet * span) return value;
  const std::ptrdiff_t reach = noise < kNoisy * span ? 1 : 2, n = std::ssize(value);
  std::vector<double> mean;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t half = std::min({reach, i, n - 1 - i});
    double sum = 0.0;
    for (std::ptrdiff_t j = i - half; j <= i + half; ++j) sum += value[static_cast<std::size_t>(j)];
    mean.push_back(sum / static_cast<double>(2 * half + 1));
  }
  return mean;
}

/// Median of the upper tenth of the height.
double level_of(const std::vector<double>& v, double base) {
  std::vector<double> sorted = v;
  std::sort(sorted.begin(), sorted.end());
  const double high = sorted[static_cast<std::size_t>(kTopQuantile * static_cast<double>(sorted.size() - 1))];
  std::vector<double> upper;
  for (const double x : v)
    if (x - base >= kHigh * (high - base)) upper.push_back(x);
  return upper.empty() ? high : upper_median(upper);
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
  if (value.size() < kFewestSamples) return shape;
  std::vector<double> v = smoothed(value, noise);
  const auto [least, most] = std::minmax_element(v.begin(), v.end());
  const double sense = std::abs(*least) > std::abs(*most) ? -1.0 : 1.0;
  for (double& x : v) x *= sense;
  // at rest before the move, or after it where the recorder came too late
  const auto few = static_cast<std::ptrdiff_t>(v.size() / kSamplesARest + 1);
  const double before = upper_median({v.begin(), v.begin() + few}), after = upper_median({v.end() - few, v.end()});
  const double top = *std::max_element(v.begin(), v.end());
  const double base = std::min(before, after);
  if (base > 0.5 * top) return shape;
  const double level = level_of(v, base), height = level - base;
  if (height < kLeastHeight * noise) return shape;
  shape.steady = sense * level;
  const auto at = [&](double share) { return base + share * height; };
  const auto up10 = first_rise(time_s, v, at(kLow));
  shape.rise_s = difference(first_rise(time_s, v, at(kHigh)), up10);
  shape.start_s = carried_back(up10, first_rise(time_s, v, at(kLowFurther)));
  const auto down90 = last_fall(time_s, v, at(kHigh));
  shape.fall_s = difference(last_fall(time_s, v, at(kLow)), down90);
  shape.decay_start_s = difference(carried_back(down90, last_fall(time_s, v, at(kHighFurther))), shape.start_s);
  return shape;
}

}  // namespace ecs::model
