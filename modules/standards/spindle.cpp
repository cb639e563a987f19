#include "modules/standards/spindle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/units.hpp"
#include "laser/groups.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/zone.hpp"
#include "modules/standards/spindle_series.hpp"

namespace ecs::laser {
namespace {

/// Below it a note says that the asynchronous value still grows with the turns; a choice.
constexpr std::size_t kUsualTurns = 20;
/// More are not evaluated; a choice.
constexpr double kMostAngles = 1440.0;
constexpr int kMostPerTurn = 8;

/// The last one ends within a step behind the last reading, or within another where a mark of the spindle is uncertain.
std::size_t whole_turns(const SpindleTrace& trace) {
  return static_cast<std::size_t>(trace.turn.back() + 2.0 * median_of(steps_of(trace.turn)));
}

using Turns = std::vector<std::vector<double>>;  // (turns × angles)

Turns combined(const Turns& a, const Turns& b, const auto& make) {
  Turns out = a;
  for (std::size_t t = 0; t < a.size(); ++t)
    for (std::size_t m = 0; m < a[t].size(); ++m) out[t][m] = make(a[t][m], b[t][m], m);
  return out;
}

/// At the same angles of every turn, linear between readings. What comes once per turn is large and is taken out before
/// and put back after, so that the chords of its circle cut nothing off.
Turns resampled(const SpindleTrace& trace, const std::vector<double>& values, std::size_t turns, std::size_t angles) {
  const double whole = trace.turn.back();
  const auto sizes = fitted<5>(values, values.size(), [&](std::size_t i) {
    const double v = 2.0 * trace.turn[i] / whole - 1.0, angle = kTurn * trace.turn[i];
    return std::array{1.0, v, v * v, std::cos(angle), std::sin(angle)};
  });
  const auto once = [&](double turn) { return sizes[3] * std::cos(kTurn * turn) + sizes[4] * std::sin(kTurn * turn); };
  const auto rest = [&](std::size_t i) { return values[i] - once(trace.turn[i]); };
  Turns out(turns, std::vector<double>(angles));
  std::size_t above = 1;
  for (std::size_t t = 0; t < turns; ++t)
    for (std::size_t m = 0; m < angles; ++m) {
      const double at = static_cast<double>(t) + static_cast<double>(m) / static_cast<double>(angles);
      while (above + 1 < trace.turn.size() && trace.turn[above] < at) ++above;
      const double low = trace.turn[above - 1], high = trace.turn[above];
      const double share = high > low ? std::clamp((at - low) / (high - low), 0.0, 1.0) : 1.0;
      out[t][m] = std::lerp(rest(above - 1), rest(above), share) + once(at);
    }
  return out;
}

std::vector<double> means_of(const Turns& turns) {
  std::vector<double> means;
  for (const auto& turn : turns) means.push_back(*mean_of(turn));
  return means;
}

/// Drift of one sensor: a parabola through the means of its turns, over the turns.
struct Parabola {
  std::array<double, 3> sizes{};
  [[nodiscard]] double at(double turns) const { return sizes[0] + (sizes[1] + sizes[2] * turns) * turns; }
};

/// @param middle  of the readings of a turn: a half less half a step
Parabola parabola_of(const std::vector<double>& means, double middle) {
  return {fitted<3>(means, means.size(), [middle](std::size_t t) {
    const double at = static_cast<double>(t) + middle;
    return std::array{1.0, at, at * at};
  })};
}

Turns without_drift(Turns turns, const Parabola& drift) {
  for (std::size_t t = 0; t < turns.size(); ++t)
    for (std::size_t m = 0; m < turns[t].size(); ++m)
      turns[t][m] -= drift.at(static_cast<double>(t) + static_cast<double>(m) / static_cast<double>(turns[t].size()));
  return turns;
}

Turns without_mean(Turns turns) {
  const double mean = *mean_of(means_of(turns));
  for (auto& turn : turns)
    for (double& value : turn) value -= mean;
  return turns;
}

/// Coefficients of cos and sin of a whole number of waves over even angles: least squares.
std::array<double, 2> wave_in(const std::vector<double>& values, const std::vector<double>& angle_deg, int per_turn) {
  std::array<double, 2> sum{};
  for (std::size_t m = 0; m < values.size(); ++m) {
    const double angle = kTurn * per_turn * angle_deg[m] / kFullTurn_deg;
    sum[0] += 2.0 * values[m] * std::cos(angle) / static_cast<double>(values.size());
    sum[1] += 2.0 * values[m] * std::sin(angle) / static_cast<double>(values.size());
  }
  return sum;
}

/// Of the mean of the turns; its uncertainty from the scatter of the coefficients over the turns.
SpindleWave wave_of(const Turns& turns, const std::vector<double>& angle_deg, int per_turn) {
  const double count = static_cast<double>(turns.size());
  std::array<double, 2> mean{}, squares{};
  for (const auto& turn : turns) {
    const auto one = wave_in(turn, angle_deg, per_turn);
    for (std::size_t i = 0; i < 2; ++i) {
      mean[i] += one[i] / count;
      squares[i] += one[i] * one[i];
    }
  }
  double scatter = 0.0;
  for (std::size_t i = 0; i < 2; ++i) scatter += std::max(0.0, squares[i] - count * mean[i] * mean[i]) / (count - 1.0);
  const double at_deg = std::atan2(mean[1], mean[0]) * kFullTurn_deg / kTurn / per_turn;
  return {per_turn, std::hypot(mean[0], mean[1]), std::sqrt(scatter / 2.0 / count),
          at_deg < 0.0 ? at_deg + kFullTurn_deg / per_turn : at_deg};
}

double zone_width(const std::vector<double>& curve, const std::vector<double>& angle_deg) {
  std::vector<ZonePoint> points;
  for (std::size_t m = 0; m < curve.size(); ++m) {
    const double angle = kTurn * angle_deg[m] / kFullTurn_deg;
    points.push_back({std::cos(angle), std::sin(angle), curve[m]});
  }
  return minimum_zone(points).width();
}

/// The widest range of the turns at one angle, and its place.
std::pair<double, std::size_t> widest_range(const Turns& turns) {
  std::pair<double, std::size_t> widest{-1.0, 0};
  for (std::size_t m = 0; m < turns.front().size(); ++m) {
    double least = turns.front()[m], greatest = least;
    for (const auto& turn : turns) {
      least = std::min(least, turn[m]);
      greatest = std::max(greatest, turn[m]);
    }
    if (greatest - least > widest.first) widest = {greatest - least, m};
  }
  return widest;
}

std::vector<double> without_wave(std::vector<double> values, const std::vector<double>& angle_deg,
                                 const SpindleWave& wave) {
  for (std::size_t m = 0; m < values.size(); ++m)
    values[m] -= wave.amplitude * std::cos(kTurn * wave.per_turn * (angle_deg[m] - wave.at_deg) / kFullTurn_deg);
  return values;
}

/// What noise of deviation 1 gives over these turns and angles.
struct UnitNoise {
  double asynchronous = 0.0, synchronous = 0.0;
  [[nodiscard]] SpindleNoise times(double rms) const { return {rms, rms * asynchronous, rms * synchronous}; }
};

/// What the values of a motion are made from.
struct RawMotion {
  SpindleMotion motion;
  Turns with_drift, steady;
};

SpindleMotion evaluated(RawMotion raw, const std::vector<double>& angle_deg, const UnitNoise& noise,
                        std::optional<double> sensor_noise) {
  SpindleMotion& motion = raw.motion;
  const std::size_t turns = raw.steady.size(), angles = angle_deg.size();
  motion.angle_deg = angle_deg;
  motion.once = wave_of(raw.steady, angle_deg, 1);
  motion.turns = without_mean(std::move(raw.steady));
  if (motion.is_radial)
    for (auto& turn : motion.turns) turn = without_wave(std::move(turn), angle_deg, motion.once);
  motion.mean.assign(angles, 0.0);
  for (const auto& turn : motion.turns)
    for (std::size_t m = 0; m < angles; ++m) motion.mean[m] += turn[m] / static_cast<double>(turns);
  double squares = 0.0, least = motion.mean.front(), greatest = least;
  for (const auto& turn : motion.turns)
    for (std::size_t m = 0; m < angles; ++m) {
      least = std::min(least, turn[m]);
      greatest = std::max(greatest, turn[m]);
      squares += (turn[m] - motion.mean[m]) * (turn[m] - motion.mean[m]);
    }
  motion.total = greatest - least;
  motion.synchronous = range_of(motion.mean);
  if (motion.is_radial)
    motion.synchronous_zone = zone_width(motion.mean, angle_deg);
  else
    motion.residual_synchronous = range_of(without_wave(motion.mean, angle_deg, motion.once));
  const auto [asynchronous, place] = widest_range(motion.turns);
  motion.asynchronous = asynchronous;
  motion.asynchronous_deg = angle_deg[place];
  motion.asynchronous_drift = widest_range(raw.with_drift).first;
  motion.asynchronous_rms = std::sqrt(squares / static_cast<double>((turns - 1) * angles));
  motion.if_noise = noise.times(motion.asynchronous_rms);
  if (sensor_noise) motion.of_sensor = noise.times(*sensor_noise);
  for (int k = 2; k <= kMostPerTurn; ++k) motion.waves.push_back(wave_of(motion.turns, angle_deg, k));
  return std::move(motion);
}

RawMotion fixed_motion(SpindleMotion motion, Turns turns) {
  const std::vector<double> means = means_of(turns);
  const double middle = 0.5 - 0.5 / static_cast<double>(turns.front().size());
  const Parabola drift = parabola_of(means, middle);
  motion.drift = drift.at(static_cast<double>(turns.size()) - 1.0 + middle) - drift.at(middle);
  for (const double mean : means) motion.turn_means.push_back(mean - means.front());
  Turns steady = without_drift(turns, drift);
  return {std::move(motion), std::move(turns), std::move(steady)};
}

RawMotion rotating_motion(SpindleMotion motion, const RawMotion& x, const RawMotion& y,
                          const std::vector<double>& angle_deg) {
  motion.is_fixed = false;
  const auto along = [&](double a, double b, std::size_t m) {
    const double angle = kTurn * angle_deg[m] / kFullTurn_deg;
    return a * std::cos(angle) + b * std::sin(angle);
  };
  return {std::move(motion), combined(without_mean(x.with_drift), without_mean(y.with_drift), along),
          combined(without_mean(x.steady), without_mean(y.steady), along)};
}

}  // namespace

double largest_range_of_noise(std::size_t draws, std::size_t places) {
  constexpr double kStep = 0.05, kFurthest = 9.0, kWidest = 18.0;
  const auto count = static_cast<std::size_t>(2.0 * kFurthest / kStep),
             ranges = static_cast<std::size_t>(kWidest / kStep);
  std::vector<double> below(count + ranges);  // the normal distribution
  for (std::size_t i = 0; i < below.size(); ++i)
    below[i] = 0.5 * std::erfc((kFurthest - kStep * static_cast<double>(i)) / std::numbers::sqrt2);
  // E = ∫ 1 − F(w)^places dw, F(w) = n ∫ φ(x)·(Φ(x + w) − Φ(x))^(n − 1) dx
  const double n = static_cast<double>(draws);
  double expected = 0.0;
  for (std::size_t w = 0; w < ranges; ++w) {
    double within = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = kStep * static_cast<double>(i) - kFurthest;
      within += n * std::exp(-0.5 * x * x) / std::sqrt(kTurn) * std::pow(below[i + w] - below[i], n - 1.0) * kStep;
    }
    expected += (w == 0 ? 0.5 : 1.0) * kStep * (1.0 - std::pow(std::min(1.0, within), static_cast<double>(places)));
  }
  return expected;
}

SpindleTest spindle_test_of(const SpindleTrace& trace) {
  const double usual = median_of(steps_of(trace.turn));
  const std::size_t turns = whole_turns(trace);
  const std::size_t angles = static_cast<std::size_t>(std::lround(std::min(kMostAngles, 1.0 / usual)));
  std::vector<double> angle_deg;
  for (std::size_t m = 0; m < angles; ++m) {
    const double on_deg = kFullTurn_deg * static_cast<double>(m) / static_cast<double>(angles);
    angle_deg.push_back(folded_deg(trace.falling ? trace.first_deg - on_deg : trace.first_deg + on_deg));
  }
  const UnitNoise noise{largest_range_of_noise(turns, angles),
                        largest_range_of_noise(angles, 1) / std::sqrt(static_cast<double>(turns))};
  SpindleTest test{trace.source, turns, angles, trace.falling, trace.has_origin, trace.speed_rpm, {}, trace.notes};
  const auto add = [&](const RawMotion& raw, std::optional<double> sensor_noise) {
    test.motions.push_back(evaluated(raw, angle_deg, noise, sensor_noise));
  };
  const auto grid = [&](SpindleSensor sensor) { return resampled(trace, trace.of(sensor), turns, angles); };
  using enum SpindleSensor;
  // Both directions and, where there are two, the rotating one.
  const auto add_directions = [&](const SpindleMotion& kind, std::string_view id, std::string_view title,
                                  const auto& turns_of, std::optional<double> sensor_noise) {
    std::vector<RawMotion> fixed;
    for (const bool second : {false, true}) {
      const std::optional<Turns> values = turns_of(second);
      if (!values) continue;
      SpindleMotion motion = kind;
      motion.id = fmt::format("{}_{}", id, second ? 'y' : 'x');
      motion.title = fmt::format("{}, fixed direction {}", title, second ? 'Y' : 'X');
      fixed.push_back(fixed_motion(std::move(motion), *values));
      add(fixed.back(), sensor_noise);
    }
    if (fixed.size() < 2) return;
    SpindleMotion motion = kind;
    motion.id = fmt::format("{}_rotating", id);
    motion.title = fmt::format("{}, rotating direction", title);
    add(rotating_motion(std::move(motion), fixed[0], fixed[1], angle_deg), sensor_noise);
  };
  add_directions(
      {}, "radial", "radial",
      [&](bool second) -> std::optional<Turns> {
        if (trace.of(second ? y : x).empty()) return std::nullopt;
        return grid(second ? y : x);
      },
      trace.noise_um);
  if (!trace.of(z).empty())
    add(fixed_motion({.id = "axial", .title = "axial", .is_radial = false}, grid(z)), trace.noise_um);
  if (trace.planes_mm) {
    const double um_per_m = kMmPerM / *trace.planes_mm;
    const auto tilt = [&](bool second) -> std::optional<Turns> {
      if (trace.of(second ? y2 : x2).empty()) return std::nullopt;
      return combined(grid(second ? y2 : x2), grid(second ? y : x),
                      [&](double far, double near, std::size_t) { return (far - near) * um_per_m; });
    };
    add_directions({.is_tilt = true}, "tilt", "tilt", tilt,
                   trace.noise_um ? std::optional(*trace.noise_um * std::numbers::sqrt2 * um_per_m) : std::nullopt);
  }
  if (turns < kUsualTurns)
    test.notes.push_back(
        fmt::format("{} turns are fewer than {}. The asynchronous value grows with the number of turns: "
                    "state it with the value.",
                    turns, kUsualTurns));
  return test;
}

namespace {

/// A curve over the angles of another, linear between its own.
std::vector<double> at_angles_of(const SpindleMotion& other, const SpindleMotion& motion, bool falling) {
  const double count = static_cast<double>(motion.mean.size());
  std::vector<double> values;
  for (const double angle_deg : other.angle_deg) {
    const double ahead_deg = falling ? motion.angle_deg.front() - angle_deg : angle_deg - motion.angle_deg.front();
    const double place = folded_deg(ahead_deg) / kFullTurn_deg * count;
    const auto low = static_cast<std::size_t>(place);
    values.push_back(std::lerp(motion.mean[low % motion.mean.size()], motion.mean[(low + 1) % motion.mean.size()],
                               place - static_cast<double>(low)));
  }
  return values;
}

}  // namespace

Result<std::vector<SpindleSeparation>> separated(const SpindleTest& first, const SpindleTest& second) {
  const auto refused = [&](std::string message) { return problem_at(second.source, 0, 0, std::move(message)); };
  for (const SpindleTest* test : {&first, &second})
    if (!test->has_origin)
      return problem_at(
          test->source, 0, 0,
          "expected a column angle_deg or index: a reversal compares both recordings at the same angle of "
          "the spindle, and time does not give it");
  if (first.falling != second.falling)
    return refused(fmt::format("expected the direction of rotation of {}, found the other one", first.source));
  std::vector<SpindleSeparation> all;
  for (const SpindleMotion& one : first.motions) {
    if (!one.is_radial || !one.is_fixed || one.is_tilt) continue;
    const auto other = std::ranges::find(second.motions, one.id, &SpindleMotion::id);
    if (other == second.motions.end()) continue;
    SpindleSeparation separation{.id = one.id, .angle_deg = one.angle_deg};
    const std::vector<double> turned = at_angles_of(one, *other, first.falling);
    for (std::size_t m = 0; m < turned.size(); ++m) {
      separation.spindle_um.push_back((one.mean[m] - turned[m]) / 2.0);
      separation.ball_um.push_back((one.mean[m] + turned[m]) / 2.0);
    }
    separation.synchronous_um = range_of(separation.spindle_um);
    separation.synchronous_zone_um = zone_width(separation.spindle_um, one.angle_deg);
    separation.form_um = range_of(separation.ball_um);
    separation.form_zone_um = zone_width(separation.ball_um, one.angle_deg);
    separation.sigma_um = 0.5 * std::hypot(one.asynchronous_rms / std::sqrt(static_cast<double>(first.turns)),
                                           other->asynchronous_rms / std::sqrt(static_cast<double>(second.turns)));
    all.push_back(std::move(separation));
  }
  if (all.empty())
    return refused(fmt::format("expected a radial sensor that {} has too, x_um or y_um, found none", first.source));
  return all;
}

}  // namespace ecs::laser
