// Smoothing against the published Savitzky-Golay weights, and its judgement of noise and signal.
#include <numbers>
#include <random>

#include "base/random.hpp"
#include "laser/analysis/process.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

constexpr std::size_t kPoints = 13;

Curve impulse_at(std::size_t at) {
  std::vector<Stop> stops;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double value = i == at ? 35.0 : 0.0;
    stops.push_back({10.0 * static_cast<double>(i), {value}, {value}});
  }
  return curve_of(stops);
}

Smoothing five_points() {
  Smoothing how;
  how.window_points = 5;
  return how;
}

/// Five runs each way of a sine with a period of 400 mm plus noise of 1 um.
Curve noisy_sine(double amplitude_um) {
  std::mt19937 random(7);
  NormalDraws noise(0.0, 1.0);
  std::vector<Stop> stops;
  for (int i = 0; i <= 80; ++i) {
    const double at_mm = 10.0 * i;
    const double value = amplitude_um * std::sin(2.0 * std::numbers::pi * at_mm / 400.0);
    Stop stop{at_mm, {}, {}};
    for (int run = 0; run < 5; ++run) {
      stop.forward.push_back(value + 1.0 + noise(random));
      stop.reverse.push_back(value - 1.0 + noise(random));
    }
    stops.push_back(stop);
  }
  return curve_of(stops);
}

}  // namespace

TEST_CASE("five points give the published weights in the middle and at the ends") {
  const auto middle = must(smoothed(impulse_at(6), five_points()));
  const double weights[] = {0.0, 0.0, 0.0, 0.0, -3.0, 12.0, 17.0, 12.0, -3.0, 0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < kPoints; ++i) CHECK(*middle.curve.points[i].forward == Approx(weights[i]));
  const auto end = must(smoothed(impulse_at(0), five_points()));
  CHECK(*end.curve.points[0].reverse == Approx(31.0));
  CHECK(*end.curve.points[1].reverse == Approx(9.0));
  CHECK(*end.curve.points[2].reverse == Approx(-3.0));
}

TEST_CASE("a window in mm takes the same points") {
  Smoothing how;
  how.window_mm = 40.0;
  const auto by_mm = must(smoothed(impulse_at(6), how));
  const auto by_points = smoothed(impulse_at(6), five_points());
  for (std::size_t i = 0; i < kPoints; ++i)
    CHECK(*by_mm.curve.points[i].forward == Approx(*by_points->curve.points[i].forward));
}

TEST_CASE("a parabola on uneven targets passes unchanged") {
  std::vector<Stop> stops;
  for (const double p : {0.0, 7.0, 20.0, 26.0, 45.0, 51.0, 60.0, 88.0})
    stops.push_back({p, {1.0 + 0.5 * p - 0.01 * p * p}, {2.0 - 0.01 * p * p}});
  CHECK(must(smoothed(curve_of(stops), five_points())).removed_peak < 1e-9);
}

TEST_CASE("what was taken away is measured") {
  const auto result = must(smoothed(impulse_at(6), five_points()));
  CHECK(result.removed_peak == Approx(18.0));
  CHECK(result.removed_peak_position_mm == Approx(60.0));
  CHECK(result.removed_rms == Approx(std::sqrt((18.0 * 18.0 + 2.0 * 144.0 + 2.0 * 9.0) / 13.0)));
  CHECK(result.taken == Taken::unknown);
}

TEST_CASE("noise taken from a slow curve is called noise, form taken by a wide window is called signal") {
  const Curve curve = noisy_sine(10.0);
  Smoothing narrow;
  narrow.window_mm = 100.0;
  const auto gentle = must(smoothed(curve, narrow));
  CHECK(gentle.taken == Taken::noise);
  CHECK(*gentle.noise_rms == Approx(1.0 / std::sqrt(5.0)).epsilon(0.05));
  CHECK(*gentle.F == Approx(1.0).epsilon(0.35));
  Smoothing wide;
  wide.window_mm = 500.0;
  const auto harsh = must(smoothed(curve, wide));
  CHECK(harsh.taken == Taken::signal);
  CHECK(*harsh.F > 20.0);
}

TEST_CASE("the 99 percent point of F agrees with the tables") {
  // 11 points take 1 - 0.207 of a degree of freedom from each of 2 × 81 points, about 127; repeats leave 648.
  // Tables: F 0.99 (120, 120) = 1.53 and (120, infinity) = 1.32; linear in 1/m between them 1.36.
  Smoothing how;
  how.window_points = 11;
  CHECK(*must(smoothed(noisy_sine(0.0), how)).F_99 == Approx(1.355).epsilon(0.015));
}

TEST_CASE("mean and reversal smoothed together with one window equal each approach on its own") {
  const Curve curve = noisy_sine(5.0);
  Smoothing apart;
  apart.window_mm = 150.0;
  Smoothing together = apart;
  together.common = true;
  const auto a = smoothed(curve, apart);
  const auto b = must(smoothed(curve, together));
  for (std::size_t i = 0; i < curve.points.size(); ++i)
    CHECK(*a->curve.points[i].reverse == Approx(*b.curve.points[i].reverse));
  CHECK(*a->F == Approx(*b.F));
}

TEST_CASE("a wide window of its own steadies the reversal error and leaves the mean") {
  const Curve curve = noisy_sine(5.0);
  Smoothing how{.window_points = 5, .common = true, .reversal_window_points = 81};
  const auto result = must(smoothed(curve, how));
  for (const CurvePoint& point : result.curve.points) CHECK(std::abs(*point.forward - *point.reverse - 2.0) < 0.6);
}

TEST_CASE("windows that smooth nothing or are not given are refused") {
  const Curve curve = impulse_at(4);
  CHECK(smoothed(curve, Smoothing{}).error().kind == ProblemKind::usage);
  Smoothing how;
  how.window_points = 3;
  CHECK(smoothed(curve, how).error().kind == ProblemKind::refused);
  how.window_points = 5;
  how.reversal_window_mm = 100.0;
  CHECK(smoothed(curve, how).error().kind == ProblemKind::usage);
  Smoothing narrow;
  narrow.window_mm = 5.0;
  CHECK(contains(smoothed(curve, narrow).error().message, "increase it"));
  Smoothing common = five_points();
  common.common = true;
  CHECK_FALSE(smoothed(curve_of({{0.0, {1.0}, {}}, {1.0, {1.0}, {}}}), common).has_value());
}
