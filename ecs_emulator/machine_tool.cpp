#include "ecs_emulator/machine_tool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ecs_emulator/random.hpp"

namespace ecs::emulator {
namespace {

constexpr double kClearOfSwitch_mm = 30.0;

/// The largest speed along a path of direction `part` at which no axis exceeds its own limit.
template <class Limit>
double limit_on_path(const PerAxis<std::optional<AxisOfMachine>>& axes, const Vector3& part, Limit limit) {
  double most = std::numeric_limits<double>::max();
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes[a] && part[a] != 0.0) most = std::min(most, limit(axes[a]->settings()) / std::abs(part[a]));
  return most;
}

}  // namespace

double start_position_mm(const params::MachineAxis& axis, const AxisSettings& settings) {
  const AxisOfMachine placed(axis, settings, 0.0, 0);
  const auto [low_mm, high_mm] = placed.switch_mm();
  return settings.reference_direction == Approach::reverse ? high_mm + kClearOfSwitch_mm : low_mm - kClearOfSwitch_mm;
}

MachineTool::MachineTool(const WorkshopMachine& description)
    : chain_(params::chain_of(description.machine).value_or(Chain{})), load_kg_(description.settings.load_kg) {
  for (const Axis a : kAllAxes) {
    if (!chain_.has(a)) continue;
    const std::size_t i = index_of(a);
    const auto& facts = *description.machine.axes[i];
    const auto& settings = description.settings.axes[i];
    command_mm_[i] = start_position_mm(facts, settings);
    axes_[i].emplace(facts, settings, command_mm_[i], seed_of(description.settings.seed, 2000, i));
  }
  stop();
}

void MachineTool::stop() {
  start_mm_ = target_mm_ = command_mm_;
  length_mm_ = done_mm_ = speed_mm_s_ = 0.0;
}

void MachineTool::move_to(const Vector3& target_mm, double feed_mm_min) {
  stop();
  Vector3 part{};
  double square = 0.0;
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (!axes_[a]) continue;
    target_mm_[a] = target_mm[a];
    part[a] = target_mm_[a] - start_mm_[a];
    square += part[a] * part[a];
  }
  length_mm_ = std::sqrt(square);
  if (length_mm_ == 0.0) return;
  for (double& p : part) p /= length_mm_;
  const double rapid = limit_on_path(axes_, part, [](const AxisSettings& s) { return s.rapid_mm_min / 60.0; });
  most_mm_s_ = feed_mm_min > 0.0 ? std::min(feed_mm_min / 60.0, rapid) : rapid;
  acceleration_mm_s2_ = limit_on_path(axes_, part, [](const AxisSettings& s) { return s.acceleration_mm_s2; });
  feed_mm_min_ = most_mm_s_ * 60.0;
}

void MachineTool::advance_path(double period_s) {
  if (arrived()) return;
  const double left_mm = length_mm_ - done_mm_;
  const double braking_mm_s = std::sqrt(2.0 * acceleration_mm_s2_ * left_mm);
  speed_mm_s_ = std::min({speed_mm_s_ + acceleration_mm_s2_ * period_s, most_mm_s_, braking_mm_s});
  done_mm_ = std::min(done_mm_ + speed_mm_s_ * period_s, length_mm_);
  if (length_mm_ - done_mm_ < 1e-6) done_mm_ = length_mm_;
  for (std::size_t a = 0; a < kAxes; ++a)
    command_mm_[a] = arrived() ? target_mm_[a] : std::lerp(start_mm_[a], target_mm_[a], done_mm_ / length_mm_);
}

void MachineTool::step(const Drives& drives, double period_s) {
  advance_path(period_s);
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) axes_[a]->step(command_mm_[a], drives[a], period_s);
  time_s_ += period_s;
}

void MachineTool::rest(const Drives& drives) {
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) axes_[a]->rest(command_mm_[a], drives[a]);
}

bool MachineTool::settled() const {
  if (!arrived()) return false;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a] && !axes_[a]->settled(command_mm_[a])) return false;
  return true;
}

Signals MachineTool::signals() const {
  Signals signals;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) signals[a] = axes_[a]->signals();
  return signals;
}

MachineState MachineTool::state() const {
  MachineState state;
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (!axes_[a]) continue;
    state.position_mm[a] = axes_[a]->position_mm();
    state.approach[a] = axes_[a]->approach();
    state.travel_since_reversal_mm[a] = axes_[a]->travel_since_reversal_mm();
    state.pass[a] = axes_[a]->pass();
  }
  state.feed_mm_min = arrived() ? 0.0 : feed_mm_min_;
  state.load_kg = load_kg_;
  state.time_s = time_s_;
  return state;
}

PerAxis<std::array<double, 2>> MachineTool::travel_mm() const {
  PerAxis<std::array<double, 2>> travel{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) travel[a] = axes_[a]->facts().travel_mm;
  return travel;
}

Vector3 MachineTool::datum_mm() const {
  Vector3 datum{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) datum[a] = axes_[a]->facts().datum_mm;
  return datum;
}

}  // namespace ecs::emulator
