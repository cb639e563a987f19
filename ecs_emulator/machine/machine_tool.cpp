#include "ecs_emulator/machine/machine_tool.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {
namespace {

constexpr double kUsualPitch_mm = 10.0;
constexpr double kSpeedReserve = 1.2;    ///< of the drive above rapid
constexpr double kStandingLags = 2.0;    ///< this many times 1/Kv near the place asked for: it stands
constexpr double kNear_pulses = 1.0;     ///< from the place asked for
constexpr double kStandingPulses = 3.0;  ///< speed that this many pulses in the counter ask for

}  // namespace

ServoParameters servo_parameters_for(const params::MachineAxis& axis, const AxisSettings& settings) {
  ServoParameters p;
  const double regulator = p.regulator_gain * p.tacho_V_s_per_rad;
  p.screw_mm_per_rad = axis.screw_pitch_mm.value_or(kUsualPitch_mm) / (2.0 * std::numbers::pi);
  p.encoder_pulses_per_rad = p.screw_mm_per_rad * 1000.0 / axis.resolution_um;
  const double fastest_rad_s = kSpeedReserve * settings.rapid_mm_min / 60.0 / p.screw_mm_per_rad;
  p.tacho_V_s_per_rad = p.preamplifier * p.dac_limit_V / fastest_rad_s;
  p.regulator_gain = regulator / p.tacho_V_s_per_rad;
  p.dac_V_per_pulse = settings.kv_per_s * p.tacho_V_s_per_rad / (p.preamplifier * p.encoder_pulses_per_rad);
  p.friction_Nm = settings.friction_Nm;
  p.breakaway_Nm = settings.breakaway_Nm;
  p.slip_rad_s = settings.slip_mm_s / p.screw_mm_per_rad;
  return p;
}

AxisServo::AxisServo(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm)
    : feedback_(settings.feedback),
      pulses_per_mm_(1000.0 / axis.resolution_um),
      drive_(servo_parameters_for(axis, settings)),
      slide_(settings.slide, start_mm),
      start_mm_(start_mm),
      standing_s_(kStandingLags / settings.kv_per_s),
      command_mm_(start_mm) {}

void AxisServo::drive_step(double command_mm, double added_pulses, PositionTransducer& transducer) {
  const double asked_pulses = std::floor(command_mm * pulses_per_mm_ + 0.5);
  counter_pulses_ = asked_pulses - static_cast<double>(transducer.counts());
  drive_.step_on_counter(counter_pulses_, added_pulses * drive_.parameters().dac_V_per_pulse);
  slide_.follow(nut_mm());
  transducer.follow(measured_mm(), drive_.parameters().step_s);
}

void AxisServo::step(double command_mm, double added_um, double seconds, PositionTransducer& transducer) {
  const bool same = command_mm == command_mm_ && added_um == added_um_;
  if (at_rest_ && same) return;
  at_rest_ = false;
  if (!same) still_s_ = 0.0;
  const double from_mm = command_mm_;
  command_mm_ = command_mm;
  added_um_ = added_um;
  owed_s_ += seconds;
  const auto steps = static_cast<int>(owed_s_ / drive_.parameters().step_s + 1e-6);
  owed_s_ -= steps * drive_.parameters().step_s;
  const double added_pulses = added_um * 1e-3 * pulses_per_mm_;
  for (int k = 1; k <= steps; ++k)
    drive_step(k == steps ? command_mm : from_mm + (command_mm - from_mm) * k / steps, added_pulses, transducer);
  judge_standing(added_pulses, seconds);
}

void AxisServo::judge_standing(double added_pulses, double seconds) {
  const ServoParameters& p = drive_.parameters();
  const double slow_rad_s = kStandingPulses * p.dac_V_per_pulse * p.preamplifier / p.tacho_V_s_per_rad;
  const bool near = std::abs(counter_pulses_ + added_pulses) <= kNear_pulses;
  const bool slow = std::abs(drive_.speed_rad_s()) <= slow_rad_s;
  still_s_ = near && slow ? still_s_ + seconds : 0.0;
  if (still_s_ < standing_s_) return;
  at_rest_ = true;
  still_s_ = owed_s_ = 0.0;
  drive_.stand();
}

namespace {

constexpr double kStill_mm = 1e-8;    ///< motion below this in one period is none
constexpr double kArrived_mm = 1e-6;  ///< 1 nm from the command
constexpr double kStill_um = 2e-4;    ///< change of the compensation in one period
/// The switch edge lies this part of a marker pitch before the datum marker, so that scatter cannot swap markers.
constexpr double kSwitchPlace = 0.4;

}  // namespace

AxisOfMachine::AxisOfMachine(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm,
                             std::uint64_t seed)
    : facts_(axis),
      settings_(settings),
      transducer_(settings.transducer, axis.transducer, axis.resolution_um, start_mm, seed),
      command_mm_(start_mm),
      position_mm_(start_mm),
      ideal_mm_(start_mm),
      extreme_mm_(start_mm) {
  if (settings.drive == DriveKind::servo) servo_.emplace(axis, settings, start_mm);
}

/// The axis turns when the command has turned and the carriage follows it, not when it settles or is compensated.
void AxisOfMachine::watch_direction(double command_mm) {
  if (command_mm != command_mm_) asked_ = command_mm > command_mm_ ? Approach::forward : Approach::reverse;
  const double onward = approach_ == Approach::reverse ? -1.0 : 1.0;
  const double further_mm = (servo_mm() - extreme_mm_) * onward;
  if (further_mm > 0.0) {
    travel_mm_ += further_mm;
    extreme_mm_ = servo_mm();
  } else if (asked_ != approach_ && -further_mm > turn_mm()) {
    approach_ = asked_;
    travel_mm_ = -further_mm;
    extreme_mm_ = servo_mm();
    ++pass_;
  }
}

double AxisOfMachine::turn_mm() const { return servo_ ? facts_.resolution_um * 1e-3 : kStill_mm; }

void AxisOfMachine::watch_marker(double from_mm, double to_mm) {
  const auto turn = [&](double at_mm) { return std::floor((at_mm - datum_marker_mm()) / settings_.marker_pitch_mm); };
  marker_mm_.reset();
  if (marker_lost_ || transducer_lost_ || turn(from_mm) == turn(to_mm)) return;
  marker_mm_ = datum_marker_mm() + std::max(turn(from_mm), turn(to_mm)) * settings_.marker_pitch_mm;
}

double AxisOfMachine::asked_um(const AxisDrive& drive) const {
  return drive.relay_closed ? drive.dac_counts * settings_.dac_um_per_count : 0.0;
}

void AxisOfMachine::drive_to(double command_mm, double asked_um, double period_s) {
  const double part = -std::expm1(-settings_.kv_per_s * period_s);
  change_um_ = (asked_um - compensation_um_) * part;
  compensation_um_ += change_um_;
  if (servo_) {
    servo_->step(command_mm, asked_um, period_s, transducer_);
    position_mm_ = servo_->position_mm();
    return;
  }
  ideal_mm_ += (command_mm - ideal_mm_) * part;
  position_mm_ = ideal_mm_ + compensation_um_ * 1e-3;
  transducer_.follow(position_mm_, period_s);
}

void AxisOfMachine::step(double command_mm, const AxisDrive& drive, double period_s) {
  const double from_mm = measured_mm();
  drive_to(command_mm, asked_um(drive), period_s);
  watch_direction(command_mm);
  command_mm_ = command_mm;
  watch_marker(from_mm, measured_mm());
}

bool AxisOfMachine::settled(double command_mm) const {
  const bool arrived = servo_ ? servo_->at_rest() : std::abs(command_mm - ideal_mm_) < kArrived_mm;
  return arrived && std::abs(change_um_) < kStill_um;
}

void AxisOfMachine::rest(double command_mm, const AxisDrive& drive) {
  compensation_um_ = asked_um(drive);
  if (servo_) return;
  ideal_mm_ = command_mm;
  position_mm_ = ideal_mm_ + compensation_um_ * 1e-3;
  transducer_.follow(position_mm_, 0.0);
}

void AxisOfMachine::referenced() { transducer_.referenced(); }

std::int64_t AxisOfMachine::wired(std::int64_t counts) const { return settings_.count_polarity * counts + miscounted_; }

AxisSignals AxisOfMachine::signals() const {
  AxisSignals signals;
  signals.counts = wired(transducer_.counts());
  signals.switch_closed = on_switch() == (settings_.switch_polarity > 0);
  signals.marker = marker_mm_.has_value();
  if (marker_mm_) signals.marker_counts = wired(transducer_.counts_at(*marker_mm_));
  signals.transducer_ok = !transducer_lost_;
  return signals;
}

double AxisOfMachine::datum_marker_mm() const { return facts_.datum_mm - settings_.null_offset_mm; }

std::array<double, 2> AxisOfMachine::switch_mm() const {
  const double onward = static_cast<double>(static_cast<std::int8_t>(settings_.reference_direction));
  const double gap_mm = kSwitchPlace * settings_.marker_pitch_mm;
  const double width_mm = settings_.switch_width_mm;
  // Distances from the datum marker, counted in the direction of the approach.
  double near_mm = -gap_mm - width_mm;  // fanuc: the switch is left before the marker
  double far_mm = -gap_mm;
  if (settings_.reference_kind == DatumKind::allen_bradley) {  // left again backwards, before the marker
    near_mm = gap_mm;
    far_mm = gap_mm + width_mm;
  } else if (settings_.reference_kind == DatumKind::siemens) {  // the marker comes while on the switch
    near_mm = -gap_mm;
    far_mm = width_mm;
  }
  const double first_mm = datum_marker_mm() + onward * near_mm;
  const double second_mm = datum_marker_mm() + onward * far_mm;
  return {std::min(first_mm, second_mm), std::max(first_mm, second_mm)};
}

bool AxisOfMachine::on_switch() const {
  if (switch_hangs_) return *switch_hangs_;
  const auto [low_mm, high_mm] = switch_mm();
  return position_mm() >= low_mm && position_mm() <= high_mm;
}

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

constexpr double kTurning_deg_s = 90.0;  ///< speed of every rotary axis

RotaryOfMachine::RotaryOfMachine(const params::MachineRotaryAxis& facts)
    : facts_(facts), angle_deg_(std::clamp(0.0, facts.travel_deg[0], facts.travel_deg[1])), target_deg_(angle_deg_) {}

void RotaryOfMachine::step(double period_s) {
  if (arrived()) return;
  approach_ = target_deg_ > angle_deg_ ? Approach::forward : Approach::reverse;
  const double left_deg = target_deg_ - angle_deg_, most_deg = kTurning_deg_s * period_s;
  angle_deg_ = std::abs(left_deg) <= most_deg ? target_deg_ : angle_deg_ + std::copysign(most_deg, left_deg);
}

std::optional<RotarySignals> RotaryOfMachine::signals() const {
  if (!facts_.resolution_deg) return std::nullopt;
  return RotarySignals{std::llround((angle_deg_ - facts_.transducer_zero_deg) / *facts_.resolution_deg),
                       !transducer_lost_};
}

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
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& facts = description.machine.rotary[r]) rotary_[r].emplace(*facts);
}

void MachineTool::stop() {
  path_.stand(Vector3(command_mm()));
  for (auto& rotary : rotary_)
    if (rotary) rotary->stop();
}

void MachineTool::turn_to(const Vector3& angle_deg) {
  for (std::size_t r = 0; r < kAxes; ++r)
    if (rotary_[r]) rotary_[r]->turn_to(angle_deg[r]);
}

bool MachineTool::arrived() const {
  return path_.done() &&
         std::all_of(rotary_.begin(), rotary_.end(), [](const auto& rotary) { return !rotary || rotary->arrived(); });
}

void MachineTool::move_to(const Vector3& target_mm, double feed_mm_min) {
  path_.stand(Vector3(command_mm()));
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
  for (auto& rotary : rotary_)
    if (rotary) rotary->step(period_s);
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

namespace {

/// What each axis states, in its place.
template <class Values, class Axes, class Of>
Values of_each(const Axes& axes, Of of) {
  Values values{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (axes[a]) values[a] = of(*axes[a]);
  return values;
}

}  // namespace

Signals MachineTool::signals() const {
  return of_each<Signals>(axes_, [](const auto& axis) { return axis.signals(); });
}

RotaryWires MachineTool::rotary_wires() const {
  return of_each<RotaryWires>(rotary_, [](const auto& axis) { return axis.signals(); });
}

RotaryState MachineTool::rotary_state() const {
  RotaryState state;
  for (std::size_t r = 0; r < kAxes; ++r) {
    if (!rotary_[r]) continue;
    state.angle_deg[r] = rotary_[r]->angle_deg();
    state.approach[r] = rotary_[r]->approach();
  }
  state.time_s = time_s_;
  return state;
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
  return of_each<PerAxis<std::array<double, 2>>>(axes_, [](const auto& axis) { return axis.facts().travel_mm; });
}

Vector3 MachineTool::datum_mm() const {
  return of_each<Vector3>(axes_, [](const auto& axis) { return axis.facts().datum_mm; });
}

}  // namespace ecs::emulator
