// What the unit does on commands over the link (docs/unit.md, "commands").
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "core/mode_word.hpp"
#include "ecs_emulator/unit/unit.hpp"

namespace ecs::emulator {
namespace {

using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;
using protocol::UnitError;

CommandResult done(std::uint32_t value = 0, std::string text = {}) {
  return {0, CommandState::done, UnitError::none, 1000, value, std::move(text)};
}
CommandResult busy(std::uint16_t per_mille = 0, std::string text = {}) {
  return {0, CommandState::busy, UnitError::none, per_mille, 0, std::move(text)};
}
CommandResult refused(UnitError error, std::string text = {}) {
  return {0, CommandState::refused, error, 0, 0, std::move(text)};
}
CommandResult failed(UnitError error, std::string text = {}) {
  return {0, CommandState::failed, error, 0, 0, std::move(text)};
}

/// Why an image is refused; fits the text of a command result.
std::string sentence_on(const ImageVerdict& verdict) {
  const bool one_table = verdict.fault == ImageFault::bad_entry || verdict.fault == ImageFault::duplicate_table;
  const std::string which = one_table ? fmt::format(" (table {})", verdict.table + 1) : std::string();
  return fmt::format("the image {}{}", text_of(verdict.fault), which);
}

}  // namespace

protocol::UnitError Unit::read_memory(Address address, std::span<std::uint8_t> out) {
  const auto size = static_cast<std::uint32_t>(out.size());
  if (!memory_.exists(address, size)) return UnitError::address_unknown;
  const ByteView bytes = memory_.view(address, size);
  std::copy(bytes.begin(), bytes.end(), out.begin());
  return UnitError::none;
}

protocol::UnitError Unit::may_write(Address address, std::uint32_t bytes) {
  if (!powered_) return UnitError::unit_fault;
  if (mode_ != UnitMode::integration) return UnitError::not_in_integration_mode;
  if (!memory_.exists(address, bytes)) return UnitError::address_unknown;
  if (!in_axis_memory(address))
    return memory_.writable(address, bytes) ? UnitError::none : UnitError::address_protected;
  if (in_active_bank(memory_, address)) return UnitError::address_protected;
  return staging_ ? UnitError::none : UnitError::no_staging;
}

protocol::UnitError Unit::write_memory(Address address, std::span<const std::uint8_t> bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  if (const UnitError error = may_write(address, size); error != UnitError::none) return error;
  memory_.write(address, bytes);
  if (user_software_) user_software_->host_wrote(address, size);
  watch_supply();
  return UnitError::none;
}

protocol::CommandResult Unit::begin(const Command& command) {
  if (!powered_) return refused(UnitError::unit_fault, "no power");
  if (command.code == CommandCode::set_input) return set_input(command);
  if (command.code == CommandCode::select_tool || command.code == CommandCode::set_tool ||
      command.code == CommandCode::remove_tool)
    return change_tools(command);
  if (command.code == CommandCode::begin_tools || command.code == CommandCode::stage_tool ||
      command.code == CommandCode::commit_tools)
    return gather_tools(command);
  if (command.code == CommandCode::try_squareness) return try_squareness(command.squareness_um_per_m);
  silent_s_ = 0.0;
  if (mode_ == UnitMode::halted) return refused(UnitError::unit_fault, "halted: switch the unit off and on");
  if (command.code == CommandCode::stop) return stop();
  if (command.code == CommandCode::enter_integration) {
    if (mode_ != UnitMode::integration) enter_integration();
    isolate();
    return done();
  }
  if (mode_ != UnitMode::integration)
    return refused(UnitError::not_in_integration_mode, fmt::format("the unit is {}", word_of(mode_)));
  result_ = begin_in_integration(command);
  watch_supply();
  if (!powered_) return refused(UnitError::unit_fault, "no power");
  return result_;
}

protocol::CommandResult Unit::begin_in_integration(const Command& command) {
  switch (command.code) {
    case CommandCode::enter_compensation:
      entering_compensation_ = true;
      return busy();
    case CommandCode::set_axis_position:
    case CommandCode::output_compensation:
    case CommandCode::test_datum:
    case CommandCode::record_datum:
      return begin_on_axis(command);
    case CommandCode::output_off:
      isolate();
      return done();
    case CommandCode::begin_staging:
      return begin_staging(command.staging_from);
    case CommandCode::commit_staged:
      return commit(command.length, command.digest);
    case CommandCode::abandon_staged:
      staging_ = false;
      return done();
    case CommandCode::run_user_software:
      return run_user_software(command.address, command.argument);
    case CommandCode::run_ram_test: {
      const auto failing = test_axis_memory(memory_);
      ram_test_ = failing ? protocol::TestOutcome::failed : protocol::TestOutcome::passed;
      ram_test_address_ = failing.value_or(0);
      return done(failing.value_or(protocol::kUnused));
    }
    case CommandCode::clear_fault:
      fault_ = Fault::none;
      fault_axis_.reset();
      fault_address_ = 0;
      return done();
    case CommandCode::reset_unit:
      restart_ = true;
      return done();
    default:
      return refused(UnitError::unknown_command);
  }
}

protocol::CommandResult Unit::begin_on_axis(const Command& command) {
  if (!present(command.axis)) return refused(UnitError::axis_absent);
  const std::size_t i = index_of(command.axis);
  if (command.code == CommandCode::set_axis_position) {
    if (!(std::abs(command.position_mm) <= kLargestPosition_mm))
      return refused(UnitError::bad_argument,
                     fmt::format("expected a position within ±{:.0f} mm", kLargestPosition_mm));
    origins_[i].counts = modules_[i].counts();
    origins_[i].position_mm = command.position_mm;
    return done();
  }
  if (command.code == CommandCode::output_compensation) return output(command);
  isolate();
  if (command.code == CommandCode::test_datum) {
    datum_test_ = DatumTest{command.axis, {}, 0.0};
    origins_[i].referenced = false;
    return busy(0, "reference the axis now");
  }
  recorder_.emplace(command.axis, parameters_.loop_period_us, parameters_.axes[i].position_scale_um_per_count);
  return busy();
}

protocol::CommandResult Unit::output(const Command& command) {
  const std::size_t i = index_of(command.axis);
  const AxisParameters& axis = parameters_.axes[i];
  if (!(std::abs(command.output_um) <= axis.output_limit_um))
    return refused(UnitError::bad_argument,
                   fmt::format("expected within the output limit of {} um", axis.output_limit_um));
  const double counts = command.output_um * axis.output_scale_counts_per_um * axis.compensation_polarity;
  if (std::abs(counts) > kMostDacCounts)
    return refused(UnitError::bad_argument, "beyond the range of the D/A converter: check the output scale");
  isolate();
  drives_[i] = {static_cast<std::int32_t>(std::lround(counts)), command.relay_on};
  return done();
}

/// In every mode: the loop judges the value (core/thermal.hpp), as it does that of a wire.
protocol::CommandResult Unit::set_input(const Command& command) {
  const std::size_t i = command.input;
  if (i < kTemperatureInputs && !settings_.sensors[i].empty())
    return refused(UnitError::bad_argument, fmt::format("temperature input {} is wired to a sensor", i + 1));
  if (i == kLoadInput && !(command.input_value >= 0.0 && command.input_value <= kGreatestLoad_kg))
    return refused(UnitError::bad_argument, fmt::format("expected a load of 0 to {:.0f} kg", kGreatestLoad_kg));
  if (i == kDeviationInput && deviation_wired_)
    return refused(UnitError::bad_argument, "an instrument on the machine is wired to this input");
  if (i == kDeviationInput && !(std::abs(command.input_value) <= kLargestDeviation_um))
    return refused(UnitError::bad_argument,
                   fmt::format("expected a deviation within ±{:.0f} um", kLargestDeviation_um));
  const ThermalSettings& limits = map_->thermal.settings;
  if (i < kTemperatureInputs &&
      !(command.input_value >= limits.least_degC && command.input_value <= limits.greatest_degC))
    return refused(UnitError::bad_argument,
                   fmt::format("expected {:.6g} to {:.6g} degC", limits.least_degC, limits.greatest_degC));
  inputs_[i] = {command.input_value, true, inputs_[i].number + 1};
  return done();
}

/// It acts on the map as it is compiled, and is gone with it.
protocol::CommandResult Unit::try_squareness(const Vector3& um_per_m) {
  constexpr double kLargest_um_per_m = 10'000.0;
  if (mode_ != UnitMode::compensating) return refused(UnitError::bad_argument, "the unit does not compensate");
  for (const double value : um_per_m)
    if (!(std::abs(value) <= kLargest_um_per_m))
      return refused(UnitError::bad_argument,
                     fmt::format("expected squareness values within ±{:.0f} um/m", kLargest_um_per_m));
  squareness_target_um_per_m_ = um_per_m;
  squareness_changes_ = true;
  return done();
}

/// In every mode: the output follows no faster than the parameters allow.
protocol::CommandResult Unit::change_tools(const Command& command) {
  if (mode_ == UnitMode::halted) return refused(UnitError::unit_fault, "halted: switch the unit off and on");
  const bool select = command.code == CommandCode::select_tool;
  if (command.tool > kGreatestToolNumber || (command.tool == 0 && !select))
    return refused(UnitError::bad_argument,
                   fmt::format("expected a tool number from {} to {}", select ? 0 : 1, kGreatestToolNumber));
  const bool known = command.tool == 0 || tool_of(tools_, command.tool) != nullptr;
  if (command.code != CommandCode::set_tool && !known)
    return refused(UnitError::bad_argument, fmt::format("tool {} is not in the table", command.tool));
  if (select && wires_.tool) return refused(UnitError::bad_argument, "the control selects the tool by its wires");
  if (command.code == CommandCode::remove_tool && command.tool == tools_.selected)
    return refused(UnitError::bad_argument, "this tool is selected");
  if (command.code == CommandCode::set_tool && !in_range(command.tool_offset_mm, parameters_))
    return refused(UnitError::bad_argument, "beyond compensation.tool_range_mm of the parameters");
  ToolTable next = tools_;
  if (select)
    next.selected = command.tool;
  else if (command.code == CommandCode::remove_tool)
    (void)remove_tool(next, command.tool);
  else if (!put_tool(next, {command.tool, command.tool_offset_mm}))
    return refused(UnitError::bad_argument, fmt::format("the table is full: {} tools", kMostTools));
  return put_in_force(next);
}

/// Stored whole in the slot that is not in force, and in force only then.
protocol::CommandResult Unit::put_in_force(const ToolTable& tools) {
  tools_ = tools;
  store_tools();
  if (!powered_) return refused(UnitError::unit_fault, "no power");
  if (std::exchange(tools_lost_, false) && fault_ == Fault::live_input && fault_address_ == kToolInput + 1) {
    fault_ = Fault::none;
    fault_address_ = 0;
  }
  select_tool();
  return done();
}

/// A whole table, beside the one in force until it is complete.
protocol::CommandResult Unit::gather_tools(const Command& command) {
  if (mode_ == UnitMode::halted) return refused(UnitError::unit_fault, "halted: switch the unit off and on");
  if (command.code == CommandCode::begin_tools) {
    staged_tools_.emplace();
    return done();
  }
  if (!staged_tools_) return refused(UnitError::no_staging, "begin a table of tools first");
  if (command.code == CommandCode::stage_tool) {
    if (command.tool == 0 || command.tool > kGreatestToolNumber)
      return refused(UnitError::bad_argument, fmt::format("expected a tool number from 1 to {}", kGreatestToolNumber));
    if (!put_tool(*staged_tools_, {command.tool, command.tool_offset_mm}))
      return refused(UnitError::bad_argument, fmt::format("the table is full: {} tools", kMostTools));
    return done();
  }
  const ToolTable staged = *std::exchange(staged_tools_, std::nullopt);
  const auto count =
      std::count_if(staged.tools.begin(), staged.tools.end(), [](const Tool& t) { return t.number != 0; });
  if (static_cast<std::uint32_t>(count) != command.length || protocol::tools_digest(staged) != command.digest)
    return refused(UnitError::check_mismatch, "the table of tools is not the one sent; the one before stays in force");
  for (const Tool& tool : staged.tools)
    if (tool.number != 0 && !in_range(tool.offset_mm, parameters_))
      return refused(UnitError::bad_argument,
                     fmt::format("tool {} is beyond compensation.tool_range_mm of the parameters", tool.number));
  if (tools_.selected != 0 && !wires_.tool && tool_of(staged, tools_.selected) == nullptr)
    return refused(UnitError::bad_argument, fmt::format("tool {} is selected, and not in the table", tools_.selected));
  return put_in_force({tools_.sequence, tools_.selected, staged.tools});
}

protocol::CommandResult Unit::begin_staging(protocol::StagingFrom from) {
  const Address bank = inactive_bank(memory_);
  const std::uint32_t size = bank_bytes(memory_.modules());
  const auto active = active_image(memory_);
  if (from == protocol::StagingFrom::active && !active) return refused(UnitError::no_staging, "no active map to copy");
  if (from == protocol::StagingFrom::active) {
    const ByteView bytes = memory_.view(active->first, size);
    memory_.write(bank, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  } else if (from == protocol::StagingFrom::cleared) {
    memory_.write(bank, std::vector<std::uint8_t>(size, 0));
  }
  staging_ = true;
  return done(bank);
}

/// Why what is staged is no image that this unit can take; `done` if it is.
protocol::CommandResult Unit::commit_refused(std::uint32_t length, std::uint64_t digest) {
  if (!staging_) return refused(UnitError::no_staging);
  const Address bank = inactive_bank(memory_);
  const std::uint32_t size = bank_bytes(memory_.modules());
  if (length == 0 || length > size) return refused(UnitError::bad_argument, fmt::format("a bank has {} bytes", size));
  if (protocol::short_digest(protocol::digest_of(memory_.view(bank, length))) != digest)
    return refused(UnitError::check_mismatch);
  const ImageVerdict verdict = check_image(memory_.view(bank, length));
  if (verdict.fault != ImageFault::none) return refused(UnitError::image_refused, sentence_on(verdict));
  if (verdict.total_bytes != length)
    return refused(UnitError::image_refused, fmt::format("the image has {} bytes", verdict.total_bytes));
  const IdentityFault identity =
      identity_fault(memory_.view(bank, length), own_identity_of(memory_, settings_.serial_number));
  if (identity != IdentityFault::none)
    return refused(UnitError::other_machine, fmt::format("the image {}", text_of(identity)));
  const auto parameters = ImageView(memory_.view(bank, length)).parameters();
  if (!parameters || parameters->memory_modules > memory_.modules())
    return refused(UnitError::image_refused, fmt::format("this rack has {} memory module(s)", memory_.modules()));
  if (const auto machine = ImageView(memory_.view(bank, length)).rotary())
    if (const auto lacking = rotary_inputs_.lacking(*machine))
      return refused(UnitError::image_refused, fmt::format("this rack has no input for axis {}", *lacking));
  return done();
}

protocol::CommandResult Unit::commit(std::uint32_t length, std::uint64_t digest) {
  if (CommandResult verdict = commit_refused(length, digest); verdict.state != CommandState::done) return verdict;
  const Address bank = inactive_bank(memory_);
  const auto active = active_image(memory_);
  const ByteView records = memory_.view(kCommitRecords.first, kCommitRecords.size);
  const std::vector<std::uint8_t> records_before(records.begin(), records.end());
  const std::uint32_t slot = next_commit_slot(records);
  const Commit commit{active ? active->commit.sequence + 1 : 1, bank == kBankA.first ? 0u : 1u, length,
                      ImageView(memory_.view(bank, length)).check()};
  std::array<std::uint8_t, kCommitSlotBytes> bytes{};
  encode_commit(commit, bytes);
  memory_.write(kCommitRecords.first + slot * kCommitSlotBytes, bytes);
  memory_.write(kCommitRecords.first + (1 - slot) * kCommitSlotBytes, std::array<std::uint8_t, kCommitSlotBytes>{});
  staging_ = false;
  isolate();
  const auto now_active = active_image(memory_);
  if (!now_active || now_active->commit != commit)
    return failed(UnitError::unit_fault, "the commit record could not be stored");
  if (on_commit_ && !memory_.power_failed() && !on_commit_()) {
    // The record in force before comes back before the new one goes, so that there is one if the supply fails
    // meanwhile. Nobody knows what the battery holds now, so it is written once more.
    for (const std::uint32_t which : {1 - slot, slot})
      memory_.write(kCommitRecords.first + which * kCommitSlotBytes,
                    ByteView(records_before).subspan(which * kCommitSlotBytes, kCommitSlotBytes));
    if (!memory_.power_failed()) (void)on_commit_();
    return failed(UnitError::unit_fault, "the battery memory cannot be written; the old map stays active");
  }
  take_over(commit);
  return done(commit.sequence);
}

/// Computed anew only where memory has changed, so that the loop waits for it once.
protocol::ImageDigest Unit::active_digest() {
  if (digest_version_ == memory_.version()) return digest_;
  const auto active = active_image(memory_);
  digest_ =
      active ? protocol::digest_of(memory_.view(active->first, active->commit.image_bytes)) : protocol::ImageDigest{};
  digest_version_ = memory_.version();
  return digest_;
}

/// What follows from another active map.
void Unit::take_over(const Commit& commit) {
  reload_parameters();
  for (Origin& origin : origins_) origin.referenced = false;
  tick_ = {};
  map_test_ = {Fault::none, 0, std::nullopt, commit.image_check, commit.image_check};
  const bool of_map = fault_ == Fault::block_check || fault_ == Fault::no_map || fault_ == Fault::bad_parameters ||
                      fault_ == Fault::map_not_for_parameters || fault_ == Fault::commit_record;
  if (!of_map) return;
  fault_ = Fault::none;
  fault_axis_.reset();
  fault_address_ = 0;
}

protocol::CommandResult Unit::run_user_software(Address start, std::uint32_t argument) {
  if (!UserSoftware::may_start_at(start))
    return refused(UnitError::bad_argument, fmt::format("programs start at an even address from 0x{:06X} to 0x{:06X}",
                                                        kUserPrograms, kSystemRam.first + kSystemRam.size - 2));
  user_software_.emplace(memory_, start, argument);
  user_software_since_ = ticks_;
  return busy();
}

/// One period of the program's time.
protocol::CommandResult Unit::user_software_step() {
  MachineInputs inputs;
  inputs.periods = static_cast<std::uint32_t>(ticks_ - user_software_since_);
  for (const Axis a : kAllAxes) {
    if (!present(a)) continue;
    inputs.position_um[index_of(a)] = static_cast<std::int32_t>(std::lround(position_mm(a) * 1000.0));
    inputs.present |= 1u << index_of(a);
  }
  user_software_->step(inputs, period_s());
  if (user_software_->end() == UserEnd::running) return busy();
  user_software_->keep_registers();
  CommandResult result =
      user_software_->end() == UserEnd::returned
          ? done(user_software_->registers().d[0], fmt::format("{} instructions", user_software_->instructions()))
          : failed(user_software_->end() == UserEnd::too_long ? UnitError::time_out : UnitError::unit_fault,
                   user_software_->why());
  if (user_software_->end() != UserEnd::returned)
    raise(Fault::user_software, std::nullopt, user_software_->registers().pc);
  user_software_.reset();
  return result;
}

protocol::CommandResult Unit::stop() {
  const bool running = datum_test_ || recorder_ || entering_compensation_ || user_software_;
  if (user_software_) user_software_->keep_registers();
  user_software_.reset();
  datum_test_.reset();
  recorder_.reset();
  entering_compensation_ = false;
  if (!running) return done();
  result_ = failed(UnitError::stopped);
  return done();
}

protocol::CommandResult Unit::progress() { return result_; }

/// One period in integration mode: the command under way, if any.
void Unit::command_step() {
  if (entering_compensation_) {
    entering_compensation_ = false;
    enter_compensation();
    result_ = mode_ == UnitMode::datuming ? done(0, "reference the machine now")
                                          : failed(UnitError::unit_fault, std::string(text_of(fault_).meaning));
  } else if (user_software_) {
    result_ = user_software_step();
  } else if (recorder_) {
    recorder_->take(modules_[index_of(recorder_->axis())], memory_);
    result_ = recorder_->finished() ? done(kDatumRecordAddress) : busy(recorder_->per_mille());
    if (recorder_->finished()) recorder_.reset();
  } else if (datum_test_) {
    DatumTest& test = *datum_test_;
    const std::size_t i = index_of(test.axis);
    test.watch.step(parameters_.axes[i].datum, modules_[i], mm_per_count(test.axis), period_s());
    test.waited_s += period_s();
    watches_[i] = test.watch;
    if (test.watch.done()) {
      origins_[i] = {std::llround(test.watch.state().datum_travelled_mm / mm_per_count(test.axis)),
                     marker_position_mm(parameters_.axes[i].datum), true};
      result_ = done(0, fmt::format("{} referenced", letter_of(test.axis)));
    } else if (test.watch.final_failure() != DatumFailure::none) {
      result_ = failed(UnitError::unit_fault, fmt::format("{}", name_of(test.watch.final_failure())));
    } else if (test.waited_s > kDatumTest_s) {
      result_ = failed(UnitError::time_out, "the axis was not referenced");
    } else {
      result_ = busy(0, std::string(name_of(test.watch.state().stage)));
      return;
    }
    datum_test_.reset();
  }
}

}  // namespace ecs::emulator
