#include "ecs_emulator/axis_of_machine.hpp"

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

AxisOfMachine::AxisOfMachine(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm)
    : facts_(axis), settings_(settings), servo_mm_(start_mm) {}

void AxisOfMachine::follow(double command_mm, double part) {
  const double before_mm = servo_mm_;
  servo_mm_ += (command_mm - servo_mm_) * part;
  const double moved_mm = servo_mm_ - before_mm;
  if (std::abs(moved_mm) < kStill_mm) return;
  const Approach direction = moved_mm > 0.0 ? Approach::forward : Approach::reverse;
  if (direction != approach_) {
    approach_ = direction;
    travel_mm_ = 0.0;
    ++pass_;
  }
  travel_mm_ += std::abs(moved_mm);
}

void AxisOfMachine::watch_marker(double from_mm, double to_mm) {
  const auto turn = [&](double at_mm) { return std::floor((at_mm - datum_marker_mm()) / settings_.marker_pitch_mm); };
  marker_mm_.reset();
  if (turn(from_mm) == turn(to_mm)) return;
  marker_mm_ = datum_marker_mm() + std::max(turn(from_mm), turn(to_mm)) * settings_.marker_pitch_mm;
}

double AxisOfMachine::asked_um(const AxisDrive& drive) const {
  return drive.relay_closed ? drive.dac_counts * settings_.dac_um_per_count : 0.0;
}

void AxisOfMachine::step(double command_mm, const AxisDrive& drive, double period_s) {
  const double part = -std::expm1(-settings_.kv_per_s * period_s);
  const double from_mm = position_mm();
  follow(command_mm, part);
  change_um_ = (asked_um(drive) - compensation_um_) * part;
  compensation_um_ += change_um_;
  watch_marker(from_mm, position_mm());
}

bool AxisOfMachine::settled(double command_mm) const {
  return std::abs(command_mm - servo_mm_) < kArrived_mm && std::abs(change_um_) < kStill_um;
}

void AxisOfMachine::rest(double command_mm, const AxisDrive& drive) {
  servo_mm_ = command_mm;
  compensation_um_ = asked_um(drive);
}

std::int64_t AxisOfMachine::counts_at(double position_mm) const {
  const double counts = position_mm * 1000.0 / facts_.resolution_um;
  return settings_.count_polarity * static_cast<std::int64_t>(std::llround(counts)) + miscounted_;
}

AxisSignals AxisOfMachine::signals() const {
  AxisSignals signals;
  signals.counts = counts_at(position_mm());
  signals.switch_closed = on_switch() == (settings_.switch_polarity > 0);
  signals.marker = marker_mm_.has_value() && !transducer_lost_;
  signals.marker_counts = counts_at(marker_mm_.value_or(0.0));
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
  const auto [low_mm, high_mm] = switch_mm();
  return position_mm() >= low_mm && position_mm() <= high_mm;
}

}  // namespace ecs::emulator
