#include "ecs_emulator/machine/machine_tool.hpp"

#include <cmath>

#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {
namespace {

constexpr double kClearOfSwitch_mm = 30.0;

PathLimits limits_of(const WorkshopMachine& description) {
  PathLimits limits;
  for (std::size_t a = 0; a < kAxes; ++a) {
    limits.rapid_mm_s[a] = description.settings.axes[a].rapid_mm_min / 60.0;
    limits.acceleration_mm_s2[a] = description.settings.axes[a].acceleration_mm_s2;
  }
  return limits;
}

}  // namespace

double start_position_mm(const params::MachineAxis& axis, const AxisSettings& settings) {
  const AxisOfMachine placed(axis, settings, 0.0, 0);
  const auto [low_mm, high_mm] = placed.switch_mm();
  return settings.reference_direction == Approach::reverse ? high_mm + kClearOfSwitch_mm : low_mm - kClearOfSwitch_mm;
}

MachineTool::MachineTool(const WorkshopMachine& description)
    : chain_(params::chain_of(description.machine).value_or(Chain{})),
      path_(limits_of(description)),
      load_kg_(description.settings.load_kg) {
  Vector3 place_mm{};
  for (const Axis a : kAllAxes) {
    if (!chain_.has(a)) continue;
    const std::size_t i = index_of(a);
    const auto& facts = *description.machine.axes[i];
    const auto& settings = description.settings.axes[i];
    place_mm[i] = start_position_mm(facts, settings);
    axes_[i].emplace(facts, settings, place_mm[i], seed_of(description.settings.seed, 2000, i));
  }
  path_.stand(place_mm);
}

void MachineTool::stop() { path_.stand(Vector3(command_mm())); }

void MachineTool::move_to(const Vector3& target_mm, double feed_mm_min) {
  stop();
  PathPiece piece;
  piece.to_mm = command_mm();
  piece.feed_mm_min = feed_mm_min;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) piece.to_mm[a] = target_mm[a];
  path_.add({&piece, 1});
}

void MachineTool::step(const Drives& drives, double period_s) {
  path_.step(period_s);
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) axes_[a]->step(command_mm()[a], drives[a], period_s);
  time_s_ += period_s;
}

void MachineTool::rest(const Drives& drives) {
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a]) axes_[a]->rest(command_mm()[a], drives[a]);
}

bool MachineTool::in_position(double window_mm) const {
  if (!arrived()) return false;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a] && !(std::abs(axes_[a]->servo_mm() - command_mm()[a]) <= window_mm)) return false;
  return true;
}

bool MachineTool::settled() const {
  if (!arrived()) return false;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes_[a] && !axes_[a]->settled(command_mm()[a])) return false;
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
  state.feed_mm_min = path_.feed_mm_min();
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
