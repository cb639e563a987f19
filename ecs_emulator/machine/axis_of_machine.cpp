#include "ecs_emulator/machine/axis_of_machine.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {
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

}  // namespace ecs::emulator
