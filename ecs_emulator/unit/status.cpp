// What the unit tells about itself: identity, status with the address pointers, the on-line monitor.
#include "ecs_emulator/unit/unit.hpp"

namespace ecs::emulator {

protocol::Identity Unit::identity() {
  protocol::Identity identity;
  identity.firmware_major = 1;
  identity.firmware_minor = 0;
  identity.serial_number = settings_.serial_number;
  identity.unit_name = "ECS unit, virtual workshop";
  identity.memory_modules = memory_.modules();
  for (std::size_t a = 0; a < kAxes; ++a) identity.axis_present[a] = settings_.axis_modules[a].has_value();
  identity.capacity_values = static_cast<std::uint32_t>(memory_.modules() * kValuesPerModule);
  const OwnIdentity own = own_identity_of(memory_, settings_.serial_number);
  identity.machine = own.identity.machine;
  if (own.has_map) identity.configuration = own.identity.configuration;
  return identity;
}

/// Block check stored in the commit record, and computed now.
TestVerdict Unit::block_check_now() const {
  const auto active = active_image(memory_);
  if (!active) return {};
  const ImageVerdict image = check_image(memory_.view(active->first, bank_bytes(memory_.modules())));
  return {Fault::none, active->first, std::nullopt, active->commit.image_check, image.check_found};
}

protocol::UnitStatus Unit::status() {
  protocol::UnitStatus status;
  status.mode = mode_;
  status.fault = fault_;
  status.fault_address = fault_address_;
  status.fault_axis = fault_axis_;
  status.ram_test = ram_test_;
  status.ram_test_address = ram_test_address_;
  const TestVerdict block = mode_ == UnitMode::integration ? block_check_now() : map_test_;
  status.block_check_expected = block.expected;
  status.block_check_found = block.found;
  if (const auto active = active_image(memory_)) {
    status.active_bank = active->commit.bank == 0 ? protocol::Bank::A : protocol::Bank::B;
    status.commit_sequence = active->commit.sequence;
    status.image_length_bytes = active->commit.image_bytes;
  }
  status.loop_period_us = parameters_.loop_period_us;
  status.loop_overruns = overruns_;
  status.ticks = ticks_;
  status.uptime_s = static_cast<std::uint32_t>(uptime_s_);
  status.watchdog_trips = watchdog_trips_;
  for (const Axis a : kAllAxes) {
    const std::size_t i = index_of(a);
    if (!present(a)) continue;
    const DatumState& datum = watches_[i].state();
    status.axes[i] = {origins_[i].referenced, datum.stage,       datum.failure,
                      position_mm(a),         Approach::unknown, drives_[i].relay_closed};
    if (mode_ == UnitMode::compensating) status.axes[i].last_approach = tick_.approach[i];
  }
  if (tick_.ticks == 0) return status;
  const auto active = active_image(memory_);
  if (!active) return status;
  const ImageView image(memory_.view(active->first, active->commit.image_bytes));
  status.pointers_at_tick = tick_.ticks;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto curve = static_cast<Component>(c);
    if (const auto selected = selected_value(*map_, tick_, moving_axis(curve), sense_of(curve)))
      status.pointers[c] = {selected->place, active->first + image.value_offset(selected->image_index)};
  }
  return status;
}

protocol::MonitorSample Unit::monitor() {
  protocol::MonitorSample sample;
  sample.number = ++samples_;
  sample.unit_time_us = static_cast<std::uint64_t>(uptime_s_ * 1e6);
  sample.mode = mode_;
  sample.fault = fault_;
  for (const Axis a : kAllAxes) {
    const std::size_t i = index_of(a);
    if (!present(a)) continue;
    protocol::AxisSample& axis = sample.axes[i];
    axis.present = true;
    axis.position_mm = position_mm(a);
    axis.speed_mm_min = modules_[i].speed() * mm_per_count(a) / period_s() * 60.0;
    axis.referenced = origins_[i].referenced;
    axis.switch_active = modules_[i].switch_closed() == (parameters_.axes[i].datum.switch_polarity > 0);
    axis.marker = modules_[i].take_marker();
    axis.output_counts = drives_[i].dac_counts;
    axis.relay_closed = drives_[i].relay_closed;
    const bool looping = mode_ == UnitMode::compensating;
    axis.compensation_um = looping ? tick_.compensation_um[i] : output_um(a);
    if (looping) axis.approach = tick_.approach[i];
  }
  return sample;
}

}  // namespace ecs::emulator
