#include "ecs_emulator/unit/unit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ecs::emulator {

Unit::Unit(const UnitSettings& settings)
    : settings_(settings), memory_(settings.memory_modules), map_(std::make_unique<CompiledMap>()) {}

void Unit::power(bool on) {
  powered_ = false;
  isolate();
  if (!on) return;
  memory_.power_back();
  if (memory_.changed() && on_commit_ && !on_commit_()) return;
  powered_ = true;
  start_up();
}

/// The supply fails in the middle of a write to axis memory, if the workshop has arranged it so.
void Unit::watch_supply() {
  if (memory_.power_failed()) power(false);
}

/// Erases every commit record but the one in force: a commit that power has interrupted is completed.
void Unit::tidy_commit_records() {
  const ByteView records = memory_.view(kCommitRecords.first, kCommitRecords.size);
  if (damaged_slot(records) || state_of_slot(records, 0) != state_of_slot(records, 1)) return;
  if (state_of_slot(records, 0) == SlotState::blank) return;
  memory_.write(kCommitRecords.first + next_commit_slot(records) * kCommitSlotBytes,
                std::array<std::uint8_t, kCommitSlotBytes>{});
}

/// A damaged record beside a sound one is no reason to stop, but is reported until a map is committed; of the tools
/// until a host has changed their table or selected one.
void Unit::report_damaged_records() {
  const auto damaged = damaged_record(memory_);
  if (fault_ != Fault::none || (!damaged && !tools_lost_)) return;
  fault_ = damaged ? Fault::commit_record : Fault::live_input;
  fault_address_ = damaged.value_or(kToolInput + 1);
}

void Unit::start_up() {
  memory_.power_up();
  ++starts_;
  mode_ = UnitMode::starting;
  (void)active_digest();
  fault_ = Fault::none;
  fault_address_ = 0;
  fault_axis_.reset();
  ram_test_ = protocol::TestOutcome::not_run;
  map_test_ = {};
  for (AxisModule& module : modules_) module.power_up();
  origins_ = {};
  watches_ = {};
  tick_ = {};
  for (InputValue& input : inputs_) input.present = false;
  if (const auto stored = stored_thermal(memory_.view(kThermalRecord.first, kThermalRecord.size)))
    clock_s_ = std::max(clock_s_, stored->clock_s);
  const ByteView tool_record = memory_.view(kToolRecord.first, kToolRecord.size);
  const auto tools = stored_tools(tool_record);
  tools_ = tools.value_or(ToolTable{});
  tools_lost_ = protocol::damaged_tool_slots(tool_record) > 0;
  staged_tools_.reset();
  isolate();
  ticks_ = 0;
  uptime_s_ = silent_s_ = 0.0;
  outputs_ended_ms_.reset();
  overruns_ = 0;
  watchdog_trips_ = 0;
  staging_ = entering_compensation_ = restart_ = false;
  datum_test_.reset();
  recorder_.reset();
  user_software_.reset();
  result_ = {};
  hung_ = false;
  hung_s_ = 0.0;
  tidy_commit_records();
  report_damaged_records();
  reload_parameters();
}

void Unit::reload_parameters() {
  const auto image = stored_image(memory_);
  const auto rotary = image ? image->rotary() : std::nullopt;
  rotary_axes_ = rotary ? rotary->axes : PerRotary<RotaryAxis>{};
  const auto stored = image ? image->parameters() : std::nullopt;
  parameters_ = stored.value_or(UnitParameters{});
  if (stored) return;
  for (std::size_t a = 0; a < kAxes; ++a) parameters_.axis_present[a] = settings_.axis_modules[a].has_value();
}

/// A host that has gone away leaves no axis under a compensation of its own.
void Unit::watch_host() {
  if (silent_s_ < kOutputHold_s) return;
  if (std::none_of(drives_.begin(), drives_.end(), [](const AxisDrive& drive) { return drive.relay_closed; })) return;
  isolate();
  outputs_ended_ms_ = clock().ms;
}

/// Relays off and every D/A converter to zero.
void Unit::isolate() { drives_ = {}; }

void Unit::enter_integration() {
  if (mode_ == UnitMode::compensating) store_thermal();
  isolate();
  mode_ = UnitMode::integration;
  report_damaged_records();
}

void Unit::raise(Fault fault, std::optional<Axis> axis, Address address) {
  fault_ = fault;
  fault_axis_ = axis;
  fault_address_ = address;
  enter_integration();
}

void Unit::enter_compensation() {
  isolate();
  fault_ = Fault::none;
  fault_address_ = 0;
  fault_axis_.reset();
  staging_ = false;
  const auto failing = test_axis_memory(memory_);
  ram_test_ = failing ? protocol::TestOutcome::failed : protocol::TestOutcome::passed;
  ram_test_address_ = failing.value_or(0);
  if (failing) return raise(Fault::ram_test, std::nullopt, *failing);
  reload_parameters();
  map_test_ = test_map(memory_, settings_.axis_modules, *map_);
  if (map_test_.fault != Fault::none) return raise(map_test_.fault, map_test_.axis, map_test_.address);
  const auto rotary = ImageView(memory_.view(map_test_.address, bank_bytes(memory_.modules()))).rotary();
  if (const auto lacking = rotary ? rotary_inputs_.lacking(*rotary) : std::nullopt)
    return raise(Fault::axis_module, std::nullopt, static_cast<Address>(*lacking));
  rotary_inputs_.use(rotary, map_->rotary);
  watches_ = {};
  for (Origin& origin : origins_) origin.referenced = false;
  mode_ = UnitMode::datuming;
}

double Unit::mm_per_count(Axis axis) const {
  return parameters_.axes[index_of(axis)].position_scale_um_per_count * 1e-3;
}

double Unit::position_mm(Axis axis) const {
  const Origin& origin = origins_[index_of(axis)];
  return origin.position_mm +
         static_cast<double>(modules_[index_of(axis)].counts() - origin.counts) * mm_per_count(axis);
}

bool Unit::present(Axis axis) const {
  return parameters_.axis_present[index_of(axis)] && settings_.axis_modules[index_of(axis)];
}

double Unit::output_um(Axis axis) const {
  const AxisParameters& its = parameters_.axes[index_of(axis)];
  return drives_[index_of(axis)].dac_counts / its.output_scale_counts_per_um * its.compensation_polarity;
}

Drives Unit::tick(const Signals& signals) {
  if (!powered_) return {};
  if (restart_) start_up();
  for (std::size_t a = 0; a < kAxes; ++a) modules_[a].take(signals[a]);
  uptime_s_ += period_s();
  silent_s_ += period_s();
  if (hung_) {
    hang_step();
    return drives_;
  }
  ++ticks_;
  switch (mode_) {
    case UnitMode::starting:
      wait_for_link();
      break;
    case UnitMode::integration:
      watch_host();
      command_step();
      break;
    case UnitMode::datuming:
      datum_step();
      break;
    case UnitMode::compensating:
      compensate_step();
      break;
    case UnitMode::halted:
      break;
  }
  watch_supply();
  return drives_;
}

bool Unit::quiet() const {
  if (!powered_ || mode_ == UnitMode::halted) return true;
  if (hung_ || mode_ == UnitMode::starting || restart_) return false;
  if (mode_ == UnitMode::datuming)
    return std::none_of(watches_.begin(), watches_.end(), [](const DatumWatch& watch) { return watch.counting(); });
  if (mode_ == UnitMode::compensating && (tool_changes_ || squareness_changes_)) return false;
  if (mode_ == UnitMode::compensating)
    return std::all_of(at_limit_s_.begin(), at_limit_s_.end(), [](double seconds) { return seconds == 0.0; });
  const bool driven =
      std::any_of(drives_.begin(), drives_.end(), [](const AxisDrive& drive) { return drive.relay_closed; });
  return !driven && !entering_compensation_ && result_.state != protocol::CommandState::busy;
}

void Unit::hang_step() {
  hung_s_ += period_s();
  if (hung_s_ < kWatchdog_s || mode_ == UnitMode::halted) return;
  ++watchdog_trips_;
  raise(Fault::watchdog);
  mode_ = UnitMode::halted;
}

void Unit::wait_for_link() {
  if (settings_.link == LinkSense::integrate) return enter_integration();
  if (settings_.link == LinkSense::compensate || uptime_s_ >= kLinkWait_s) enter_compensation();
}

bool Unit::transducers_sound() {
  for (const Axis a : kAllAxes) {
    const AxisModule& module = modules_[index_of(a)];
    if (!present(a)) continue;
    if (!module.transducer_ok()) {
      raise(Fault::axis_module, a);
      return false;
    }
    if (std::abs(static_cast<double>(module.step()) * mm_per_count(a)) > kFastest_mm_s * period_s()) {
      raise(Fault::position_jump, a);
      return false;
    }
  }
  const auto of_rotary = rotary_inputs_.fault(period_s());
  if (of_rotary) raise(of_rotary->fault, std::nullopt, static_cast<Address>(of_rotary->letter));
  return !of_rotary;
}

void Unit::turned(const RotaryWires& wires) { rotary_inputs_.take(wires); }

/// An axis that has not moved yet counts as having come forward.
void Unit::begin_rotary() {
  if (has_rotary())
    start_rotary(map_->rotary, rotary_, rotary_inputs_.counts(), rotary_inputs_.angles_deg(),
                 {Approach::forward, Approach::forward});
}

bool Unit::go_to_tool(double most_um) {
  if (has_rotary()) return change_tool(*map_, tick_, thermal_, rotary_, tool_target_mm_, most_um);
  return change_tool(*map_, tick_, thermal_, tool_target_mm_, most_um);
}

/// The work of this period is not done when it ends.
bool Unit::late() {
  const bool late = extra_us_ > parameters_.loop_period_us;
  if (slow_periods_ > 0 && --slow_periods_ == 0) extra_us_ = 0.0;
  late_in_a_row_ = late ? late_in_a_row_ + 1 : 0;
  overruns_ += late ? 1u : 0u;
  return late;
}

void Unit::datum_step() {
  if (!wires_.power_on.value_or(true)) return;
  if (!transducers_sound()) return;
  bool all_done = true;
  for (const Axis a : kAllAxes) {
    if (!present(a)) continue;
    const DatumParameters& datum = parameters_.axes[index_of(a)].datum;
    DatumWatch& watch = watches_[index_of(a)];
    watch.step(datum, modules_[index_of(a)], mm_per_count(a), period_s());
    if (watch.final_failure() != DatumFailure::none) return raise(Fault::datum_sequence, a);
    all_done = all_done && watch.done();
    Origin& origin = origins_[index_of(a)];
    if (!watch.done() || origin.referenced) continue;
    origin.counts = std::llround(watch.state().datum_travelled_mm / mm_per_count(a));
    origin.position_mm = marker_position_mm(datum);
    origin.referenced = true;
  }
  if (all_done) begin_compensating();
}

void Unit::begin_compensating() {
  PerAxis<std::int64_t> counts{};
  Vector3 position{};
  PerAxis<Approach> approach{};
  for (const Axis a : kAllAxes) {
    const std::size_t i = index_of(a);
    counts[i] = modules_[i].counts();
    position[i] = position_mm(a);
    const double speed = modules_[i].speed() * mm_per_count(a);
    approach[i] = speed == 0.0 ? watches_[i].state().direction : (speed > 0.0 ? Approach::forward : Approach::reverse);
  }
  start(tick_, counts, position, approach);
  begin_rotary();
  begin_thermal();
  tool_target_mm_ = parameters_.tool_offset_mm;
  squareness_changes_ = false;
  (void)change_squareness(*map_, tick_, {parameters_.C0Y_um_per_m, parameters_.B0Z_um_per_m, parameters_.A0Z_um_per_m},
                          std::numeric_limits<double>::infinity());
  select_tool();
  (void)go_to_tool(std::numeric_limits<double>::infinity());
  at_limit_s_ = {};
  late_in_a_row_ = 0;
  mode_ = UnitMode::compensating;
  if (tool_known_)
    watch_unknown_inputs();
  else
    report_unknown_tool();
  if (mode_ == UnitMode::compensating) compensate_step();
}

void Unit::compensate_step() {
  if (late()) {  // the output of the period before holds
    if (late_in_a_row_ >= kMostLatePeriods) raise(Fault::loop_overrun);
    return;
  }
  if (!transducers_sound()) return;
  PerAxis<std::int64_t> counts{};
  for (std::size_t a = 0; a < kAxes; ++a) counts[a] = modules_[a].counts();
  const double most_um = parameters_.tool_rate_um_per_s * period_s();
  if (tool_changes_) tool_changes_ = !go_to_tool(most_um);
  if (squareness_changes_) squareness_changes_ = !change_squareness(*map_, tick_, squareness_target_um_per_m_, most_um);
  if (has_rotary())
    ecs::tick(*map_, tick_, counts, thermal_.acting, rotary_, rotary_inputs_.counts());
  else if (map_->thermal.count > 0)
    ecs::tick(*map_, tick_, counts, thermal_.acting);
  else
    ecs::tick(*map_, tick_, counts);
  for (const Axis a : kAllAxes) {
    const std::size_t i = index_of(a);
    if (!present(a)) continue;
    at_limit_s_[i] = tick_.at_limit[i] ? at_limit_s_[i] + period_s() : 0.0;
    if (at_limit_s_[i] > kOutputLimit_s) return raise(Fault::compensation_output, a);
    drives_[i] = {tick_.dac_counts[i], true};
  }
}

namespace {

/// "t_spindle_degC" is the column of the sensor "spindle".
bool is_column_of(std::string_view column, std::string_view sensor) {
  constexpr std::string_view kBefore = "t_", kBehind = "_degC";
  return column.size() == kBefore.size() + sensor.size() + kBehind.size() && column.starts_with(kBefore) &&
         column.ends_with(kBehind) && column.substr(kBefore.size(), sensor.size()) == sensor;
}

}  // namespace

bool Unit::senses() const {
  const bool follows = mode_ == UnitMode::compensating && (map_->thermal.count > 0 || !tool_known_);
  return follows || deviation_wired_ ||
         std::any_of(settings_.sensors.begin(), settings_.sensors.end(),
                     [](const std::string& sensor) { return !sensor.empty(); });
}

void Unit::sense(const std::vector<NamedTemperature>& shown, double seconds) {
  clock_s_ += seconds;
  if (!powered_) return;
  for (std::size_t i = 0; i < kTemperatureInputs; ++i) {
    const auto its = std::find_if(shown.begin(), shown.end(), [&](const NamedTemperature& one) {
      return is_column_of(settings_.sensors[i], one.first);
    });
    if (its == shown.end()) continue;
    const FailedSensor& failed = failures_[i];
    const bool stuck = failed.failure == SensorFailure::stuck;
    inputs_[i] = {stuck ? failed.stuck_at : its->second + failed.by_degC, failed.failure != SensorFailure::open,
                  inputs_[i].number + 1};
  }
  if (mode_ != UnitMode::compensating || hung_) return;
  watch_unknown_inputs();
  if (mode_ != UnitMode::compensating || map_->thermal.count == 0) return;
  if (step_thermal(map_->thermal, thermal_, inputs_, tick_.position_mm, seconds)) report_doubtful_input();
  if (has_rotary()) follow_thermal(*map_, thermal_, rotary_);
  if (clock_s_ - stored_s_ >= kThermalStored_s) store_thermal();
}

/// Rows go on from what they had come to in the battery-backed memory, if that belongs to this map.
void Unit::begin_thermal() {
  if (map_->thermal.count == 0) {
    thermal_ = {};
    return;
  }
  const auto stored = stored_thermal(memory_.view(kThermalRecord.first, kThermalRecord.size));
  const bool of_this_map = stored && stored->image_check == map_test_.expected;
  stored_s_ = clock_s_;
  if (ecs::begin_thermal(map_->thermal, thermal_, inputs_, tick_.position_mm, of_this_map ? &*stored : nullptr,
                         of_this_map ? clock_s_ - stored->clock_s : 0.0))
    report_doubtful_input();
  if (has_rotary()) follow_thermal(*map_, thermal_, rotary_);
}

/// No reason to stop: the terms of that input keep their value and fade out.
void Unit::report_doubtful_input() {
  const auto doubtful = std::find_if(thermal_.inputs.begin(), thermal_.inputs.end(),
                                     [](const ThermalState::Input& input) { return is_doubtful(input.state); });
  fault_ = Fault::live_input;
  fault_axis_.reset();
  fault_address_ = static_cast<Address>(doubtful - thermal_.inputs.begin() + 1);
}

/// The selected one, if the table has it and the parameters allow it.
const Tool* Unit::usable_tool() const {
  const Tool* const tool = tools_.selected == 0 ? nullptr : tool_of(tools_, tools_.selected);
  return tool != nullptr && in_range(tool->offset_mm, parameters_) ? tool : nullptr;
}
bool Unit::knows_tool() const { return !tools_lost_ && (usable_tool() != nullptr || tools_.selected == 0); }

/// Which tool acts from now on, by the wires of the control or by what a host has selected. An unknown number changes
/// nothing of it.
void Unit::select_tool() {
  if (wires_.tool && *wires_.tool != tools_.selected) {
    tools_.selected = *wires_.tool;
    if (!tools_lost_) store_tools();  // the damage stays to be seen
  }
  const Tool* const tool = usable_tool();
  tool_known_ = knows_tool();
  if (tool_known_) tool_target_mm_ = tool != nullptr ? tool->offset_mm : parameters_.tool_offset_mm;
  tool_changes_ = mode_ == UnitMode::compensating;
  if (mode_ == UnitMode::compensating && !tool_known_) report_unknown_tool();
}

void Unit::report_unknown_tool() {
  fault_ = Fault::live_input;
  fault_axis_.reset();
  fault_address_ = kToolInput + 1;
  watch_unknown_inputs();
}

/// By how much the output may be wrong, at the present place, because a tool or the load is not known.
double Unit::unknown_input_um() const {
  Vector3 most_um{};
  if (!tool_known_) {
    double way_mm = 0.0;
    const PerAxis<Vector3> effect = has_rotary() ? tool_effect_um_per_mm(*map_, tick_, thermal_, rotary_)
                                                 : tool_effect_um_per_mm(*map_, tick_, thermal_);
    for (std::size_t l = 0; l < kAxes; ++l) {
      const double furthest_mm = parameters_.tool_range_mm[l] + std::abs(map_->tool_offset_mm[l]);
      for (std::size_t o = 0; o < kAxes; ++o) most_um[o] += std::abs(effect[l][o]) * furthest_mm;
      way_mm = std::hypot(way_mm, furthest_mm);
    }
    if (has_rotary()) {
      const Vector3 bend = tool_bend_um_per_mm(*map_, rotary_);
      for (std::size_t o = 0; o < kAxes; ++o) most_um[o] += std::abs(bend[o]) * way_mm;
    }
  }
  for (std::size_t k = 0; k < map_->thermal.count; ++k) {
    const ThermalWorking::Row& row = map_->thermal.rows[k];
    if (row.source != kLoadInput || thermal_.inputs[kLoadInput].has_value) continue;
    const Lanes of_one = value_um(row.of_one, tick_.position_mm);
    for (std::size_t o = 0; o < kAxes; ++o) most_um[o] += std::abs(of_one[o]) * parameters_.load_range_kg;
  }
  return *std::max_element(most_um.begin(), most_um.end());
}

void Unit::watch_unknown_inputs() {
  if (unknown_input_um() > parameters_.unknown_input_limit_um)
    raise(Fault::unknown_input, std::nullopt, (tool_known_ ? kLoadInput : kToolInput) + 1);
}

void Unit::store_tools() {
  ++tools_.sequence;
  std::array<std::uint8_t, kToolTableBytes> slot{};
  encode_tools(tools_, slot);
  const std::uint32_t which = next_tool_slot(memory_.view(kToolRecord.first, kToolRecord.size));
  memory_.write(kToolRecord.first + which * kToolTableBytes, slot);
  watch_supply();
}

/// The control has lost its drives, and with them its place: it references again, and so does the unit.
void Unit::control_lost() {
  if (mode_ == UnitMode::compensating) store_thermal();
  isolate();
  for (Origin& origin : origins_) origin.referenced = false;
  if (mode_ != UnitMode::compensating && mode_ != UnitMode::datuming) return;
  watches_ = {};
  mode_ = UnitMode::datuming;
}

void Unit::control(const ControlWires& wires) {
  const ControlWires before = std::exchange(wires_, wires);
  deviation_wired_ = deviation_wired_ || wires.deviation_um;
  if (!powered_ || hung_) return;
  if (deviation_wired_)
    inputs_[kDeviationInput] = {wires.deviation_um.value_or(0.0), wires.deviation_um.has_value(),
                                inputs_[kDeviationInput].number + 1};
  if (before.power_on.value_or(true) && !wires.power_on.value_or(true)) control_lost();
  if (wires.tool != before.tool) select_tool();
}

protocol::ControlLines Unit::control_lines() {
  using protocol::ToolState;
  protocol::ControlLines lines;
  lines.tool = tools_.selected;
  lines.tool_state = !knows_tool() ? ToolState::unknown : tools_.selected == 0 ? ToolState::none : ToolState::acting;
  if (mode_ == UnitMode::compensating && tool_changes_) lines.tool_state = ToolState::changing;
  lines.tool_offset_mm = mode_ == UnitMode::compensating ? map_->tool_offset_mm : parameters_.tool_offset_mm;
  lines.squareness_um_per_m =
      mode_ == UnitMode::compensating
          ? (squareness_changes_ ? squareness_target_um_per_m_ : map_->squareness_um_per_m)
          : Vector3{parameters_.C0Y_um_per_m, parameters_.B0Z_um_per_m, parameters_.A0Z_um_per_m};
  lines.tools = static_cast<std::uint16_t>(
      std::count_if(tools_.tools.begin(), tools_.tools.end(), [](const Tool& tool) { return tool.number != 0; }));
  lines.tool_wired = wires_.tool.has_value();
  lines.control_on_wired = wires_.power_on.has_value();
  lines.control_on = wires_.power_on.value_or(true);
  lines.deviation = input_status(kDeviationInput);
  lines.compensating_out = mode_ == UnitMode::compensating;
  lines.fault_out = fault_ != Fault::none;
  lines.battery = battery_;
  lines.battery_age_s = static_cast<std::uint32_t>(clock_s_);
  return lines;
}

void Unit::store_thermal() {
  stored_s_ = clock_s_;
  const ByteView region = memory_.view(kThermalRecord.first, kThermalRecord.size);
  const auto before = stored_thermal(region);
  std::array<std::uint8_t, kStoredThermalBytes> slot{};
  encode_thermal({before ? before->sequence + 1 : 1, map_test_.expected, clock_s_, thermal_.lagged}, slot);
  memory_.write(kThermalRecord.first + next_thermal_slot(region) * kStoredThermalBytes, slot);
}

protocol::LiveInputs Unit::live_inputs() {
  protocol::LiveInputs live;
  const bool loops = mode_ == UnitMode::compensating && map_->thermal.count > 0;
  if (loops) {
    live.rows = static_cast<std::uint16_t>(map_->thermal.count);
    const Lanes um = value_um(thermal_.acting, tick_.position_mm);
    live.thermal_um = {um[0], um[1], um[2]};
    if (thermal_.stored_age_s) live.stored_age_s = static_cast<std::uint32_t>(*thermal_.stored_age_s);
  }
  for (std::size_t i = 0; i < live.inputs.size(); ++i) live.inputs[i] = input_status(i);
  return live;
}

protocol::InputStatus Unit::input_status(std::size_t input) const {
  protocol::InputStatus status;
  status.wired =
      input < kTemperatureInputs ? !settings_.sensors[input].empty() : input == kDeviationInput && deviation_wired_;
  if (std::isfinite(inputs_[input].value)) status.value = inputs_[input].value;
  if (mode_ != UnitMode::compensating || map_->thermal.count == 0) return status;
  status.state = thermal_.inputs[input].state;
  status.faults = thermal_.inputs[input].faults;
  return status;
}

protocol::Identity Unit::identity() {
  protocol::Identity identity;
  identity.firmware_major = 1;
  identity.firmware_minor = 2;
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

/// Checksum stored in the commit record, and computed now.
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

protocol::RotarySample Unit::rotary() {
  protocol::RotarySample sample;
  const bool looping = mode_ == UnitMode::compensating && has_rotary();
  if (looping) sample.compensation_um = rotary_compensation_um(*map_, tick_, rotary_);
  for (std::size_t i = 0; i < kRotaryInputs; ++i) {
    const RotaryAxis& axis = rotary_axes_[i];
    if (axis.letter == '\0') continue;
    const auto angle_deg = rotary_inputs_.angle_deg(axis);
    sample.axes[i] = {axis.letter, angle_deg.has_value(), angle_deg.value_or(0.0),
                      looping ? rotary_approach(map_->rotary, rotary_, axis.letter) : Approach::unknown};
  }
  return sample;
}

}  // namespace ecs::emulator
