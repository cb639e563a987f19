#include "base/moved_targets.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ecs {
namespace {

/// ISO 230-2 asks that r covers the periods to be expected; a tenth of the step is the least, 0.3 keeps the order.
constexpr double kMost = 0.3;
constexpr double kUmPerMm = 1000.0;

std::int64_t in_um(double mm) { return std::llround(mm * kUmPerMm); }

/// SplitMix64 (Steele, Lea, Flood 2014): neighbouring numbers give unrelated ones.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

/// −1 … 1, another for each target of each line.
double share_of(std::uint64_t line, std::size_t target) {
  return static_cast<double>(static_cast<std::int64_t>(mixed(line + target))) / 9223372036854775808.0;
}

/// Whether targets on a grid were laid out on it. All numbers are on the grid of their last digit: there neighbours are
/// far apart, beyond the 25 turns from one to the next up to which periods are sought (half a step is one), or seldom a
/// single step. On a line with a part in finer steps they are within that.
/// @param targets_mm  ascending, on the grid
bool is_layout(const std::vector<double>& targets_mm, double step_mm) {
  constexpr double kMostSteps = 50.0, kLeastOfOneStep = 0.25;
  const auto gaps = static_cast<double>(targets_mm.size() - 1);
  if (targets_mm.back() - targets_mm.front() > kMostSteps * step_mm * gaps) return false;
  double single = 0.0;
  for (std::size_t i = 1; i < targets_mm.size(); ++i)
    if (std::round((targets_mm[i] - targets_mm[i - 1]) / step_mm) == 1.0) single += 1.0;
  return single >= kLeastOfOneStep * gaps;
}

}  // namespace

std::optional<double> even_step_mm(std::vector<double> targets_mm) {
  constexpr double kOff = 0.02, kSame_mm = 1e-3;
  std::sort(targets_mm.begin(), targets_mm.end());
  const auto same = [](double a, double b) { return b - a < kSame_mm; };
  targets_mm.erase(std::unique(targets_mm.begin(), targets_mm.end(), same), targets_mm.end());
  if (targets_mm.size() < 3) return std::nullopt;
  double shortest_mm = targets_mm.back() - targets_mm.front();
  for (std::size_t i = 1; i < targets_mm.size(); ++i)
    shortest_mm = std::min(shortest_mm, targets_mm[i] - targets_mm[i - 1]);
  const double length_mm = targets_mm.back() - targets_mm.front();
  const double step_mm = length_mm / std::max(1.0, std::round(length_mm / shortest_mm));
  const bool even = std::all_of(targets_mm.begin(), targets_mm.end(), [&](double target_mm) {
    const double steps = (target_mm - targets_mm.front()) / step_mm;
    return std::abs(steps - std::round(steps)) <= kOff;
  });
  return even && is_layout(targets_mm, step_mm) ? std::optional(step_mm) : std::nullopt;
}

std::vector<double> moved_targets(std::vector<double> targets_mm) {
  if (targets_mm.size() < 3) return targets_mm;
  const auto line = mixed(static_cast<std::uint64_t>(in_um(targets_mm.front()))) ^
                    mixed(static_cast<std::uint64_t>(in_um(targets_mm[1])) + targets_mm.size());
  std::vector<double> moved = targets_mm;
  for (std::size_t i = 1; i + 1 < moved.size(); ++i) {
    const double gap_mm =
        std::min(std::abs(targets_mm[i] - targets_mm[i - 1]), std::abs(targets_mm[i + 1] - targets_mm[i]));
    moved[i] = std::round((targets_mm[i] + kMost * gap_mm * share_of(line, i)) * kUmPerMm) / kUmPerMm;
  }
  return moved;
}

}  // namespace ecs
