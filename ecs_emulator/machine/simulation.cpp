#include "ecs_emulator/machine/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <sched.h>

#include "base/clock.hpp"
#include "core/thermal.hpp"

namespace ecs::emulator {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kStartAnew_s = 0.25;

std::int64_t nanoseconds(const timespec& t) { return t.tv_sec * kSecond_ns + t.tv_nsec; }
timespec timespec_of(std::int64_t ns) { return {ns / kSecond_ns, ns % kSecond_ns}; }

timespec now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time;
}

}  // namespace

RealTime::RealTime() : due_(now()) {
  const sched_param lowest{.sched_priority = sched_get_priority_min(SCHED_FIFO)};
  record_.fifo = sched_setscheduler(0, SCHED_FIFO, &lowest) == 0;
}

void RealTime::wait(double period_s) {
  const auto period_ns = static_cast<std::int64_t>(std::llround(period_s * 1e9));
  const std::int64_t due_ns = nanoseconds(due_) + period_ns;
  due_ = timespec_of(due_ns);
  if (nanoseconds(now()) < due_ns)
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due_, nullptr) != 0) {
    }
  const std::int64_t late_ns = nanoseconds(now()) - due_ns;
  ++record_.periods;
  record_.worst_late_us = std::max(record_.worst_late_us, static_cast<double>(late_ns) * 1e-3);
  if (late_ns >= period_ns) ++record_.missed;
  if (static_cast<double>(late_ns) * 1e-9 <= kStartAnew_s) return;
  record_.missed += static_cast<std::uint64_t>(late_ns / period_ns) - 1;
  due_ = now();
}

bool RealTime::is_behind(double period_s) const {
  return static_cast<double>(nanoseconds(now()) - nanoseconds(due_)) * 1e-9 >= period_s;
}

namespace {

constexpr int kSteady = 20;              ///< periods without a change of the output that count as settled
constexpr double kSettle_s = 2.0;        ///< the longest time that an axis gets to settle
constexpr double kPauseEvery_s = 0.004;  ///< real time
constexpr std::uint64_t kTicksBetweenLooks = 64;

WorkshopMachine seeded(WorkshopMachine description, std::uint64_t seed) {
  description.settings.seed = seed;
  return description;
}

bool same(const Drives& a, const Drives& b) {
  for (std::size_t i = 0; i < kAxes; ++i)
    if (a[i].dac_counts != b[i].dac_counts || a[i].relay_closed != b[i].relay_closed) return false;
  return true;
}

}  // namespace

Simulation::Simulation(const WorkshopMachine& description, TrueErrors errors, std::uint64_t seed)
    : description_(seeded(description, seed)),
      machine_(description_),
      errors_(std::move(errors)),
      heat_(errors_.heat(), machine_.travel_mm(), seed),
      geometry_{machine_.chain(), params::measurement_lines_of(description.machine),
                description.settings.tool_offset_mm},
      seed_(seed),
      random_(seed_of(seed, 1000, 0)) {
  errors_.put_on({machine_.chain(), geometry_.lines_mm, machine_.datum_mm()});
  rewire();
}

void Simulation::rewire() {
  if (description_.settings.tool_wires) wires_.tool = tool_;
  if (description_.settings.power_on_wire) wires_.power_on = control_on_;
  if (unit_ != nullptr) unit_->control(wires_);
}

bool Simulation::has_tool(std::uint16_t number) const {
  const auto& tools = description_.settings.tools;
  return number == 0 ||
         std::any_of(tools.begin(), tools.end(), [&](const MagazineTool& tool) { return tool.number == number; });
}

void Simulation::change_tool(std::uint16_t number) {
  tool_ = number;
  geometry_.tool_offset_mm = description_.settings.tool_offset_mm;
  for (const MagazineTool& tool : description_.settings.tools)
    if (number != 0 && tool.number == number) geometry_.tool_offset_mm = tool.offset_mm;
  rewire();
}

void Simulation::switch_control(bool on) {
  if (control_on_ && !on) machine_.stop();
  control_on_ = on;
  rewire();
}

Vector3 Simulation::carriages_mm() const {
  Vector3 place_mm{};
  for (const Axis a : kAllAxes)
    if (machine_.has(a)) place_mm[index_of(a)] = machine_.axis(a).position_mm();
  return place_mm;
}

void Simulation::tick() {
  if (!heat_.rubs()) {
    step();
  } else {
    const Vector3 from_mm = carriages_mm();
    step();
    heat_.moved(from_mm, carriages_mm(), period_s());
  }
  heat_.advance(machine_.time_s());
}

/// The rack's input module reads the machine's sensors.
void Simulation::sense() {
  const double now_s = machine_.time_s();
  if (const auto along = description_.settings.deviation) {
    constexpr int kSettled = 5;  // looks at an axis that stands, after which it follows its command no more
    const double command_mm = machine_.command_mm()[index_of(*along)];
    still_looks_ = command_mm == deviation_at_mm_ ? still_looks_ + 1 : 0;
    deviation_at_mm_ = command_mm;
    if (still_looks_ >= kSettled) shown_um_ = tool_now(false).error_um[index_of(*along)];
    wires_.deviation_um = deviation_fails_ ? std::nullopt : std::optional(shown_um_);
    unit_->control(wires_);
  }
  unit_->sense(sensors_degC(now_s), now_s - sensed_s_);
  sensed_s_ = now_s;
}

void Simulation::step() {
  if (real_time_) real_time_->wait(period_s());
  const auto between = static_cast<std::uint64_t>(std::max(1L, std::lround(kThermalStep_s / period_s())));
  const bool wanted = unit_ != nullptr && (unit_->senses() || description_.settings.deviation);
  if (wanted && ticks_ % between == 0) sense();
  if (unit_ != nullptr && !description_.machine.rotary_configuration.empty()) unit_->turned(machine_.rotary_wires());
  const Drives drives = unit_ == nullptr ? Drives{} : unit_->tick(machine_.signals());
  steady_ticks_ = same(drives, drives_) ? steady_ticks_ + 1 : 0;
  drives_ = drives;
  machine_.step(drives_, period_s());
  ++ticks_;
}

bool Simulation::pause() {
  if (!pause_) return true;
  if (real_time_) return pause_();
  if (ticks_ % kTicksBetweenLooks != 0) return true;
  const double now_s = steady_s();
  if (now_s < next_pause_s_) return true;
  const bool go_on = pause_();
  next_pause_s_ = steady_s() + kPauseEvery_s;
  return go_on;
}

void Simulation::idle_tick() {
  const double time_s = machine_.time_s();
  step();
  machine_.set_clock(time_s);
}

bool Simulation::at_rest() const { return machine_.settled() && steady_ticks_ >= kSteady; }

void Simulation::come_to_rest() {
  double used_s = 0.0;
  while (used_s < kSettle_s && !at_rest()) {
    idle_tick();
    used_s += period_s();
  }
  if (at_rest()) machine_.rest(drives_);
}

bool Simulation::settle(double limit_s, double& used_s, const std::function<void()>& each) {
  while (used_s < limit_s && !at_rest()) {
    tick();
    if (each) each();
    used_s += period_s();
    if (!pause()) return false;
  }
  if (at_rest()) machine_.rest(drives_);
  return true;
}

bool Simulation::run_while(const std::function<bool()>& going, const std::function<void()>& each) {
  while (going()) {
    tick();
    if (each) each();
    if (pause()) continue;
    machine_.stop();
    return false;
  }
  return true;
}

bool Simulation::move_to(const Vector3& target_mm, double feed_mm_min, const std::function<void()>& each) {
  machine_.move_to(target_mm, feed_mm_min);
  if (!run_while([this] { return !machine_.arrived(); }, each)) return false;
  double used_s = 0.0;
  return settle(kSettle_s, used_s, each);
}

/// Nothing moves, and the unit reads its inputs as often as ever.
void Simulation::pass(double seconds) {
  const double end_s = machine_.time_s() + seconds;
  while (machine_.time_s() < end_s - 1e-9) {
    machine_.wait(std::min(kThermalStep_s, end_s - machine_.time_s()));
    heat_.advance(machine_.time_s());
    sense();
  }
}

bool Simulation::dwell(double seconds, const std::function<void()>& each) {
  double used_s = 0.0;
  if (!settle(seconds, used_s, each)) return false;
  while (used_s < seconds && (real_time_ || (unit_ != nullptr && !unit_->quiet()))) {
    tick();
    used_s += period_s();
    if (!pause()) return false;
  }
  // What the unit adds changes meanwhile with its inputs; the machine follows at the end.
  if (unit_ != nullptr && unit_->senses() && used_s < seconds - kSettle_s) {
    pass(seconds - kSettle_s - used_s);
    steady_ticks_ = 0;
    used_s = seconds - kSettle_s;
    if (!settle(seconds, used_s, each)) return false;
  }
  if (used_s < seconds) machine_.wait(seconds - used_s);
  heat_.advance(machine_.time_s());
  return true;
}

bool Simulation::run_for(double seconds) {
  const double end_s = machine_.time_s() + seconds - 0.5 * period_s();
  while (machine_.time_s() < end_s) {
    tick();
    if (!pause()) return false;
  }
  return true;
}

void Simulation::draw_scatter(const MachineState& state, const Vector3& target_mm) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (stops_[a] && stops_[a]->target_mm == target_mm[a] && stops_[a]->pass == state.pass[a]) continue;
    stops_[a] = Stop{target_mm[a], state.pass[a]};
    for (std::size_t c = 6 * a; c < 6 * a + 6; ++c) {
      const double deviation = errors_.reading_scatter()[c];
      stop_scatter_[c] = deviation > 0.0 ? deviation * random_.normal() : 0.0;
    }
  }
}

ToolPose Simulation::tool_at(const MachineState& state, const Vector3& target_mm, bool scatter) {
  ComponentValues errors = errors_.at(state, heat_);
  if (scatter) {
    draw_scatter(state, target_mm);
    const ComponentValues pass = errors_.pass_scatter(state, machine_.travel_mm(), seed_);
    for (std::size_t c = 0; c < kCurves; ++c) errors[c] += pass[c] + stop_scatter_[c];
  }
  ToolPose pose = tool_pose(geometry_, errors, state.position_mm);
  for (const Axis a : kAllAxes)
    if (machine_.has(a)) pose.error_um[index_of(a)] += (state.position_mm[index_of(a)] - target_mm[index_of(a)]) * 1e3;
  return pose;
}

TurningPose Simulation::turned_tool(const Vector3& tool_offset_mm) const {
  const TurningGeometry geometry = turning_geometry_of(description_.machine, tool_offset_mm);
  const MachineState state = machine_.state();
  const RotaryState rotary = machine_.rotary_state();
  TurningPose pose =
      turning_pose(geometry, errors_.at(state, heat_), errors_.rotary_at(rotary), state.position_mm, rotary.angle_deg);
  const Vector3 asked_mm = turning_pose(geometry, {}, {}, machine_.command_mm(), rotary.angle_deg).nominal_mm;
  for (std::size_t d = 0; d < kAxes; ++d) pose.error_um[d] += (pose.nominal_mm[d] - asked_mm[d]) * 1e3;
  pose.nominal_mm = asked_mm;
  return pose;
}

std::vector<NamedTemperature> Simulation::sensors_degC(double time_s) const {
  auto all = errors_.temperatures(time_s);
  for (NamedTemperature& shown : all) shown.second = std::round(shown.second * 100.0) / 100.0;
  for (NamedTemperature& shown : heat_.readings(time_s)) all.push_back(std::move(shown));
  return all;
}

ToolPose Simulation::tool_now(bool scatter) { return tool_at(machine_.state(), machine_.command_mm(), scatter); }

}  // namespace ecs::emulator
