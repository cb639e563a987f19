#include "commissioning/unit/status.hpp"

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/json.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/fault.hpp"
#include "core/memory_image.hpp"
#include "core/mode_word.hpp"
#include "laser/map/error_map.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::commissioning {
namespace {

using protocol::Block;
using protocol::Registers;

constexpr int kFormat = 1;
constexpr std::uint16_t kIdentityOfProtocol1 = 32;  ///< registers; what was added behind them reads as not known

Result<void> decode(StatusSnapshot& snapshot) {
  ECS_TRY(identity, protocol::value_in<protocol::Identity>(snapshot.identity_registers));
  ECS_TRY(status, protocol::value_in<protocol::UnitStatus>(snapshot.status_registers));
  snapshot.identity = identity;
  snapshot.status = status;
  for (const Registers& block : snapshot.event_blocks) {
    ECS_TRY(page, protocol::value_in<protocol::EventPage>(block));
    for (const protocol::HostEvent& event : page.events)
      if (event.number != 0) snapshot.events.push_back(event);
  }
  if (!snapshot.lines_registers.empty()) {
    ECS_TRY(lines, protocol::value_in<protocol::ControlLines>(snapshot.lines_registers));
    snapshot.lines = lines;
  }
  if (!snapshot.rotary_registers.empty()) {
    ECS_TRY(rotary, protocol::value_in<protocol::RotarySample>(snapshot.rotary_registers));
    snapshot.rotary = rotary;
  }
  return protocol::take_pointers(snapshot.pointer_registers, snapshot.status);
}

/// The value at a pointer; nothing if no table of the image holds that address.
std::optional<SelectedValue> value_at(protocol::UnitClient& client, ByteView head, Address bank, std::size_t curve,
                                      Address address) {
  const ImageView image(head);
  const std::uint32_t tables = std::min(image.table_count(), kMostTables);
  for (std::uint32_t i = 0; i < tables && directory_offset(image.format()) + (i + 1) * kEntryBytes <= head.size();
       ++i) {
    const TableEntry entry = image.entry(i);
    if (index_of(entry.component) != curve || entry.declared_zero) continue;
    const Address first = bank + image.value_offset(entry.first_value);
    if (address < first || address >= first + 2 * entry.count) continue;
    const auto bytes = client.read_memory(address, 2);
    if (!bytes) return std::nullopt;
    const auto counts = static_cast<std::int16_t>(load_big<std::uint16_t>(*bytes, 0));
    return SelectedValue{counts, counts * entry.resolution};
  }
  return std::nullopt;
}

void read_selected(protocol::UnitClient& client, StatusSnapshot& snapshot) {
  const protocol::UnitStatus& status = snapshot.status;
  constexpr std::uint32_t kHeadBytes = directory_offset() + kMostTables * kEntryBytes;
  if (status.active_bank == protocol::Bank::none ||
      status.image_length_bytes < directory_offset(kFormatWithoutIdentity))
    return;
  const Address bank = address_of(status.active_bank);
  std::optional<std::vector<std::uint8_t>> head;
  for (std::size_t curve = 0; curve < kCurves; ++curve) {
    const Address address = status.pointers[curve].address;
    if (address == protocol::kUnused) continue;
    if (!head) {
      auto bytes = client.read_memory(bank, std::min(kHeadBytes, status.image_length_bytes));
      if (!bytes || load_big<std::uint32_t>(*bytes, prefix_at::magic) != kImageMagic) return;
      head = std::move(*bytes);
    }
    snapshot.selected[curve] = value_at(client, *head, bank, curve, address);
  }
}

/// Empty: it is no list of this many registers.
Registers registers_in(const Json& list, const Block& block) {
  Registers registers;
  if (!list.is_array() || list.size() != block.count) return registers;
  for (const Json& word : list) {
    if (!word.is_number_unsigned() || word.get<std::uint64_t>() > 0xFFFF) return {};
    registers.push_back(word.get<std::uint16_t>());
  }
  return registers;
}

Result<Registers> registers_at(const Json& raw, const char* key, const Block& block, const std::string& name) {
  const auto found = raw.find(key);
  Registers registers = found == raw.end() ? Registers() : registers_in(*found, block);
  const bool is_older = registers.empty() && block == protocol::kIdentity && found != raw.end();
  if (is_older) registers = registers_in(*found, {block.first, kIdentityOfProtocol1});
  if (is_older && !registers.empty()) registers.resize(block.count, 0);
  if (registers.size() == block.count) return registers;
  return problem_at(name, 0, 0, "raw.{}: expected {} registers of 0 to 65535", key, block.count);
}

/// Files of before have no events.
Result<std::vector<Registers>> event_blocks_in(const Json& raw, const std::string& name) {
  std::vector<Registers> blocks;
  const auto list = raw.find("events");
  if (list == raw.end() || !list->is_array()) return blocks;
  for (const Json& one : *list) {
    blocks.push_back(registers_in(one, protocol::kEvents));
    if (blocks.back().size() != protocol::kEvents.count)
      return problem_at(name, 0, 0, "raw.events: expected lists of {} registers of 0 to 65535",
                        protocol::kEvents.count);
  }
  return blocks;
}

void take_selected(const Json& raw, StatusSnapshot& snapshot) {
  const auto list = raw.find("selected");
  if (list == raw.end() || !list->is_array() || list->size() != kCurves) return;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const Json& one = (*list)[i];
    if (!one.is_array() || one.size() != 2 || !one[0].is_number_integer() || !one[1].is_number()) continue;
    snapshot.selected[i] = SelectedValue{one[0].get<std::int16_t>(), one[1].get<double>()};
  }
}

Json raw_json(const StatusSnapshot& snapshot) {
  Json selected = Json::array();
  for (const auto& value : snapshot.selected)
    selected.push_back(value ? Json::array({value->counts, number_or_null(value->value)}) : Json(nullptr));
  Json raw = object_of("identity"_is(snapshot.identity_registers), "status"_is(snapshot.status_registers),
                       "pointers"_is(snapshot.pointer_registers), "lines"_is(snapshot.lines_registers),
                       "selected"_is(selected), "events"_is(snapshot.event_blocks));
  if (!snapshot.rotary_registers.empty()) raw["rotary"] = snapshot.rotary_registers;
  return raw;
}

}  // namespace

Result<StatusSnapshot> take_snapshot(protocol::UnitClient& client, const std::string& link, std::size_t events) {
  StatusSnapshot snapshot;
  snapshot.taken = now_utc();
  snapshot.link = link;
  const auto read = [&client](const Block& block) { return client.link().ask(protocol::kEcho, Registers{0}, block); };
  for (const auto& [block, into] : {std::pair{protocol::kIdentity, &snapshot.identity_registers},
                                    std::pair{protocol::kStatus, &snapshot.status_registers},
                                    std::pair{protocol::kPointers, &snapshot.pointer_registers}}) {
    ECS_TRY(registers, read(block));
    *into = std::move(registers);
  }
  if (auto lines = read(protocol::kControlLines)) snapshot.lines_registers = std::move(*lines);
  ECS_TRY(identity, protocol::value_in<protocol::Identity>(snapshot.identity_registers));
  ECS_TRY(rotary, client.rotary(identity));
  if (any_axis(rotary)) snapshot.rotary_registers = protocol::registers_of(rotary, 0);
  ECS_TRY(blocks, client.event_blocks(events));
  snapshot.event_blocks = std::move(blocks);
  ECS_DO(decode(snapshot));
  read_selected(client, snapshot);
  return snapshot;
}

Json json_with_registers(const StatusSnapshot& snapshot) {
  Json object = object_of("ecs_status"_is(kFormat));
  object.update(status_cell(snapshot).json);
  object["raw"] = raw_json(snapshot);
  return object;
}

Result<void> write_snapshot(const std::filesystem::path& path, const StatusSnapshot& snapshot) {
  return write_file(path, json_with_registers(snapshot).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<StatusSnapshot> parse_snapshot(std::string_view text, const std::string& name) {
  if (auto why = why_no_text(text, name)) return tl::unexpected(std::move(*why));
  const Json object = Json::parse(text, nullptr, false);
  if (object.is_discarded() || !object.is_object() || !object.contains("ecs_status"))
    return problem_at(name, 0, 0, "expected a status file (JSON) written by `ecs utility status --save`");
  if (object["ecs_status"] != kFormat)
    return problem_at(name, 0, 0, "expected a status file of format {}, found format {}: use a newer ecs", kFormat,
                      one_line(object["ecs_status"]));
  const auto raw = object.find("raw");
  if (raw == object.end() || !raw->is_object()) return problem_at(name, 0, 0, "expected the registers under \"raw\"");
  StatusSnapshot snapshot;
  snapshot.taken = text_at(object, "taken");
  snapshot.link = text_at(object, "link");
  for (const auto& [key, block, into] : {std::tuple{"identity", protocol::kIdentity, &snapshot.identity_registers},
                                         std::tuple{"status", protocol::kStatus, &snapshot.status_registers},
                                         std::tuple{"pointers", protocol::kPointers, &snapshot.pointer_registers}}) {
    ECS_TRY(registers, registers_at(*raw, key, block, name));
    *into = std::move(registers);
  }
  if (const auto lines = raw->find("lines"); lines != raw->end())  // files of before have none
    snapshot.lines_registers = registers_in(*lines, protocol::kControlLines);
  if (const auto rotary = raw->find("rotary"); rotary != raw->end())
    snapshot.rotary_registers = registers_in(*rotary, protocol::kRotary);
  ECS_TRY(blocks, event_blocks_in(*raw, name));
  snapshot.event_blocks = std::move(blocks);
  if (const auto decoded = decode(snapshot); !decoded) return problem_at(name, 0, 0, decoded.error().message);
  take_selected(*raw, snapshot);
  return snapshot;
}

Result<StatusSnapshot> read_snapshot(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_snapshot(text, path.string());
}

namespace {

using protocol::AxisStatus;
using protocol::Bank;
using protocol::TestOutcome;
using protocol::UnitStatus;

std::string_view name_of_outcome(TestOutcome outcome) {
  if (outcome == TestOutcome::passed) return "passed";
  return outcome == TestOutcome::failed ? "failed" : "not run";
}
std::string_view name_of_bank(Bank bank) {
  if (bank == Bank::A) return "A";
  return bank == Bank::B ? "B" : "none";
}

bool has_address(Fault fault) {
  return fault == Fault::ram_test || fault == Fault::block_check || fault == Fault::commit_record;
}

Cell hex_cell(std::uint32_t number) { return cell_of(fmt::format("{:08X}", number)); }

/// Of a rotary axis the letter is the address.
std::string axis_at_fault(const UnitStatus& status) {
  if (status.fault_axis) return std::string(1, letter_of(*status.fault_axis));
  const bool may_be_rotary = status.fault == Fault::axis_module || status.fault == Fault::position_jump;
  if (!may_be_rotary || status.fault_address < 'A' || status.fault_address > 'C') return {};
  return std::string(1, static_cast<char>(status.fault_address));
}

Cell fault_cell(const UnitStatus& status) {
  const FaultText text = ecs::text_of(status.fault);
  const std::string address = hex_address(status.fault_address);
  const std::string axis = axis_at_fault(status);
  const std::string where = status.fault == Fault::block_check ? "; in the memory bank that begins at " : "; address ";
  std::string input;
  const auto is_of = [&](std::size_t which) { return status.fault_address == which + 1; };
  if (status.fault == Fault::live_input || status.fault == Fault::unknown_input)
    input = is_of(kLoadInput)        ? "; the load"
            : is_of(kDeviationInput) ? "; the deviation"
            : is_of(kToolInput)      ? "; the tool: it is not in the table, or a copy of the table is damaged"
                                     : fmt::format("; input {}", status.fault_address);
  return record_cell("fault {number} ({name}): {meaning}{address}{axis}{input}. What to do: {action}",
                     "name"_is(text.name), "number"_is(static_cast<int>(status.fault)), "meaning"_is(text.meaning),
                     "action"_is(text.action),
                     "address"_is(has_address(status.fault) ? Cell{address, where + address} : null_cell()),
                     "axis"_is(axis.empty() ? null_cell() : Cell{axis, "; axis " + axis}), "input"_shown(input));
}

Cell ram_test_cell(const UnitStatus& status) {
  const std::string address = hex_address(status.ram_test_address);
  return record_cell(
      "RAM test     {outcome}{address}\n", "outcome"_is(name_of_outcome(status.ram_test)),
      "address"_is(status.ram_test == TestOutcome::failed ? Cell{address, " at " + address} : null_cell()));
}

Cell block_check_cell(const UnitStatus& status) {
  const bool made = status.block_check_expected != 0 || status.block_check_found != 0;  // both zero until the first
  const bool agrees = status.block_check_expected == status.block_check_found;
  const std::string differ = fmt::format("they differ. What to do: {}", text_of(Fault::block_check).action);
  return record_cell(!made    ? "checksum     not computed\n"
                     : agrees ? "checksum     {found} (CRC-32), agrees with the stored one\n"
                              : "checksum     expected {expected}, found {found} (CRC-32): {agrees}\n",
                     "expected"_is(made ? hex_cell(status.block_check_expected) : null_cell()),
                     "found"_is(made ? hex_cell(status.block_check_found) : null_cell()),
                     "agrees"_is(made ? Cell{agrees, agrees ? "" : differ} : null_cell()));
}

Cell map_cell(const UnitStatus& status) {
  const std::string_view bank = name_of_bank(status.active_bank);
  const bool has_tables = status.image_length_bytes > directory_offset();  // which begins behind the parameters
  return record_cell(status.active_bank == Bank::none ? "active map   {bank}\n"
                     : has_tables ? "active map   bank {bank}, {bytes} bytes, commit no. {commit_sequence}\n"
                                  : "active map   none: only parameters (bank {bank}, {bytes} bytes, commit no. "
                                    "{commit_sequence})\n",
                     "bank"_is(status.active_bank == Bank::none ? null_cell(bank) : cell_of(bank)),
                     "bytes"_is(status.image_length_bytes), "commit_sequence"_is(status.commit_sequence));
}

Cell axis_cell(Axis letter, const AxisStatus& axis) {
  const bool failed = axis.datum_failure != DatumFailure::none;
  const std::string_view failure = ecs::name_of(axis.datum_failure), advice = advice_for(axis.datum_failure);
  return record_cell(
      "{axis:<5} {referenced:<11} {datum_stage:<15} {position_mm:>11}  {last_approach:<9} {relay_closed}\n"
      "{datum_failure}{datum_advice}",
      "axis"_shown(std::string(1, letter_of(letter))), "referenced"_is(axis.referenced, "yes", "no"),
      "datum_stage"_is(ecs::name_of(axis.datum_stage)),
      "datum_failure"_is(failure, failed ? fmt::format("      datum failed: {}; ", failure) : ""),
      "datum_advice"_is(failed ? Cell{advice, fmt::format("{}\n", advice)} : null_cell()),
      "position_mm"_is(axis.position_mm, 4), "last_approach"_is(approach_cell(axis.last_approach)),
      "relay_closed"_is(axis.relay_closed, "closed", "open"));
}

Cell axes_cell(const StatusSnapshot& snapshot) {
  Cell axes{Json::object(), "axis  referenced  datum stage     position/mm  approach  relay\n"};
  for (const Axis axis : kAllAxes) {
    if (!snapshot.identity.axis_present[index_of(axis)]) continue;
    const Cell one = axis_cell(axis, snapshot.status.axes[index_of(axis)]);
    axes.json[std::string(1, letter_of(axis))] = one.json;
    axes.text += one.text;
  }
  return axes;
}

Cell pointer_cell(Component component, const protocol::CurvePointer& pointer,
                  const std::optional<SelectedValue>& selected) {
  return record_cell(
      "{component}   {index:>5}  {address}  {value:>9} {unit:<5}{description}\n", "component"_is(name_of(component)),
      "description"_is(laser::description_of(component)), "index"_is(pointer.index),
      "address"_is(hex_address(pointer.address)), "counts"_is(selected ? cell_of(selected->counts) : null_cell()),
      "value"_is(selected ? number_cell(selected->value, 2) : null_cell("unknown")), "unit"_is(unit_of(component)));
}

Cell pointers_cell(const StatusSnapshot& snapshot) {
  Cell pointers{Json::array(),
                fmt::format("address pointers after {} periods of compensation: the values selected last\n(with linear "
                            "interpolation the value at or below the position)\ncurve  index  address       value\n",
                            snapshot.status.pointers_at_tick)};
  for (std::size_t i = 0; i < kCurves; ++i)
    if (const auto& pointer = snapshot.status.pointers[i]; pointer.address != protocol::kUnused)
      pointers.add(pointer_cell(static_cast<Component>(i), pointer, snapshot.selected[i]));
  if (pointers.json.empty()) pointers.text = "no value of the map is applied at present\n";
  return pointers;
}

Cell unit_cell(const StatusSnapshot& snapshot) {
  const auto& id = snapshot.identity;
  std::string axes;
  for (const Axis axis : kAllAxes)
    if (id.axis_present[index_of(axis)]) axes += letter_of(axis);
  return record_cell(
      "unit {serial_number} ({name}){of_machine}, firmware {firmware}, memory modules in the unit: {memory_modules}\n",
      "serial_number"_is(text_cell(id.serial_number)), "name"_is(text_cell(id.unit_name)),
      "firmware"_is(fmt::format("{}.{}", id.firmware_major, id.firmware_minor)),
      "protocol_version"_is(id.protocol_version), "axes"_is(axes), "memory_modules"_is(id.memory_modules),
      "capacity_values"_is(id.capacity_values),
      "of_machine"_shown(id.machine.empty() ? "" : " on machine " + id.machine), "machine"_is(text_cell(id.machine)),
      "configuration"_is(id.configuration == 0 ? null_cell() : cell_of(fmt::format("{:08X}", id.configuration))));
}

/// In the order of protocol::UnitError, short enough for a row.
constexpr std::array<std::string_view, protocol::kUnitErrorCount> kErrorNames{"none",
                                                                              "not in integration mode",
                                                                              "address unknown",
                                                                              "address protected",
                                                                              "bad argument",
                                                                              "unknown command",
                                                                              "nothing staged",
                                                                              "check mismatch",
                                                                              "image refused",
                                                                              "busy",
                                                                              "axis absent",
                                                                              "not referenced",
                                                                              "unit fault",
                                                                              "stopped",
                                                                              "time out",
                                                                              "token expired",
                                                                              "other machine",
                                                                              "session unknown",
                                                                              "late",
                                                                              "overtaken",
                                                                              "other version",
                                                                              "not armed",
                                                                              "wrong code",
                                                                              "a wrong code just before"};

/// "select tool 7", "set axis position (X 1 mm)"
std::string arguments_text(const protocol::HostEvent& event) {
  using protocol::CommandCode;
  const bool is_tool = event.code == CommandCode::select_tool || event.code == CommandCode::remove_tool ||
                       event.code == CommandCode::set_tool || event.code == CommandCode::stage_tool;
  return is_tool ? " " + event.text : fmt::format(" ({})", event.text);
}

Cell event_cell(const protocol::HostEvent& event) {
  const bool writes = event.code == protocol::CommandCode::none;
  const bool failed = event.error != protocol::UnitError::none;
  const std::string_view why = kErrorNames[static_cast<std::size_t>(event.error)];
  const bool is_end = event.code == protocol::CommandCode::arm && event.error == protocol::UnitError::time_out;
  return record_cell(
      is_end ? "{number:>4}  {time:<20}  {host:<16}  unit clock {unit_time_s} s{times}\n      write access ended: its "
               "time was over; `ecs unit arm` grants it again\n"
             : "{number:>4}  {time:<20}  {host:<16}  unit clock {unit_time_s} s{times}\n      {what}{arguments}: "
               "{result}{error}\n",
      "number"_is(event.number),
      "time"_is(event.unix_time_s == 0 ? null_cell("time of day unknown") : cell_of(utc_of(event.unix_time_s))),
      "unit_time_s"_is(event.unit_time_s), "starts"_is(event.starts), "host"_is(text_cell(event.host)),
      "what"_is(writes ? "write memory" : protocol::name_of(event.code)),
      "arguments"_is(event.text.empty() ? null_cell() : Cell{event.text, arguments_text(event)}),
      "result"_is(protocol::name_of(event.state)),
      "times"_is(event.times, event.times > 1 ? fmt::format(", {} times in a row", event.times) : ""),
      "error"_is(failed ? Cell{why, fmt::format(", {}", why)} : null_cell()));
}

/// The three newest, where there are any.
std::string newest_events_text(const std::vector<protocol::HostEvent>& events) {
  constexpr std::size_t kShown = 3;
  if (events.empty()) return {};
  const std::size_t shown = std::min(kShown, events.size());
  const std::vector<protocol::HostEvent> newest(events.end() - static_cast<std::ptrdiff_t>(shown), events.end());
  return "\n" + events_cell(newest).text;
}

}  // namespace

std::string_view name_of(Approach approach) {
  if (approach == Approach::forward) return "forward";
  return approach == Approach::reverse ? "reverse" : "unknown";
}

Cell approach_cell(Approach approach) {
  return approach == Approach::unknown ? null_cell(name_of(approach)) : cell_of(name_of(approach));
}

std::string unreferenced_text(const protocol::MonitorSample& sample) {
  std::string axes;
  for (const Axis axis : kAllAxes)
    if (const protocol::AxisSample& a = sample.axes[index_of(axis)]; a.present && !a.referenced)
      axes += fmt::format("{}{}", axes.empty() ? "" : ", ", letter_of(axis));
  return axes.empty() ? "" : axes + " not referenced: counted from switch-on, or from the position entered";
}

Cell rotary_axes_cell(const protocol::RotarySample& sample) {
  Cell axes{Json::object(), {}};
  for (const protocol::RotaryAxisSample& axis : sample.axes) {
    if (axis.letter == '\0') continue;
    const std::string letter(1, axis.letter);
    const Cell one = record_cell("{axis:<5} {angle_deg:>10}  {approach}\n", "axis"_shown(letter),
                                 "angle_deg"_is(axis.sensed ? number_cell(axis.angle_deg, 4) : null_cell("unknown")),
                                 "approach"_is(approach_cell(axis.approach)));
    axes.json[letter] = one.json;
    axes.text += one.text;
  }
  if (!axes.text.empty()) axes.text = "axis   angle/deg  approach\n" + axes.text;
  return axes;
}

Cell rotary_compensation_cell(const protocol::RotarySample& sample, UnitMode mode) {
  if (!any_axis(sample) || mode != UnitMode::compensating) return null_cell();
  const Vector3& um = sample.compensation_um;
  return record_cell("share of the rotary axes in the compensation: X {X} um, Y {Y} um, Z {Z} um\n",
                     "X"_is(um[0], fmt::format("{:+.2f}", um[0])), "Y"_is(um[1], fmt::format("{:+.2f}", um[1])),
                     "Z"_is(um[2], fmt::format("{:+.2f}", um[2])));
}

Cell battery_cell(const protocol::ControlLines& lines) {
  constexpr double kSecondsPerDay = 86'400.0;
  const bool low = lines.battery == protocol::BatteryState::low;
  return {low ? "low" : "good",
          fmt::format("{}, {:.1f} days old{}", low ? "low" : "good", lines.battery_age_s / kSecondsPerDay,
                      low ? "; replace it while the unit is switched on, or its map is lost" : "")};
}

Cell control_cell(const protocol::ControlLines& lines) {
  if (!lines.control_on_wired)
    return null_cell("not known whether it is on: its \"power on\" signal is not wired to the unit");
  return {lines.control_on, lines.control_on ? "on" : "off: every axis has to be referenced again when it is back"};
}

std::string fault_sentence(const UnitStatus& status) { return fault_cell(status).text; }
std::string axes_text(const StatusSnapshot& snapshot) {
  return axes_cell(snapshot).text + rotary_axes_cell(snapshot.rotary).text +
         rotary_compensation_cell(snapshot.rotary, snapshot.status.mode).text;
}
std::string pointers_text(const StatusSnapshot& snapshot) { return pointers_cell(snapshot).text; }
std::string memory_text(const UnitStatus& status) {
  return ram_test_cell(status).text + block_check_cell(status).text + map_cell(status).text;
}

Cell events_cell(const std::vector<protocol::HostEvent>& events) {
  if (events.empty()) return {Json::array(), "events       none\n"};
  const bool with_hash = std::ranges::any_of(
      events, [](const protocol::HostEvent& event) { return event.text.find("SHA ") != std::string::npos; });
  return list_cell(events, event_cell,
                   with_hash ? "events by the connected computers (SHA: first six digits of the SHA-256)\n"
                             : "events by the connected computers\n");
}

std::string mode_in_words(UnitMode mode) {
  const std::string name(word_of(mode));
  return mode == UnitMode::integration ? name + " (positions are counted, compensation off)" : name;
}

Cell status_cell(const StatusSnapshot& snapshot) {
  const UnitStatus& s = snapshot.status;
  Cell fault = fault_cell(s);
  const bool checked = s.block_check_expected == s.block_check_found;
  if (s.fault == Fault::none)
    fault.text = checked ? "no fault" : "no stored fault, but the axis memory is damaged: see the checksum below";
  const auto& lines = snapshot.lines;
  const auto row = [](std::string_view name, Cell cell) {
    cell.text = fmt::format("{:<13}{}\n", name, cell.text);
    return cell;
  };
  Cell events = events_cell(snapshot.events);
  events.text = newest_events_text(snapshot.events);
  const Cell rotary = rotary_axes_cell(snapshot.rotary), rotary_um = rotary_compensation_cell(snapshot.rotary, s.mode);
  Cell cell = record_cell(
      "{unit}status of {taken}\nmode         "
      "{mode}\n{fault}\n\n{ram_test}{block_check}{map}{battery}{control_on}{loop}, "
      "watchdog trips {watchdog_trips}\nup for       {uptime_s} s\n\n{axes}{rotary}\n{pointers}{events}",
      "taken"_is(text_cell(snapshot.taken)), "link"_is(text_cell(snapshot.link)), "unit"_is(unit_cell(snapshot)),
      "mode"_is(ecs::name_of(s.mode), mode_in_words(s.mode)), "fault"_is(std::move(fault)),
      "ram_test"_is(ram_test_cell(s)), "block_check"_is(block_check_cell(s)), "map"_is(map_cell(s)),
      "battery"_is(lines ? row("battery", battery_cell(*lines)) : null_cell()),
      "battery_age_s"_is(lines ? cell_of(lines->battery_age_s) : null_cell()),
      "control_on"_is(lines ? row("control", control_cell(*lines)) : null_cell()),
      "loop"_is(record_cell("loop         period {period_us} us, {overruns} overruns; {ticks} periods since power-up",
                            "period_us"_is(s.loop_period_us), "overruns"_is(s.loop_overruns), "ticks"_is(s.ticks))),
      "uptime_s"_is(s.uptime_s), "watchdog_trips"_is(s.watchdog_trips), "axes"_is(axes_cell(snapshot)),
      "rotary"_shown(rotary.text + rotary_um.text), "pointers_at_tick"_is(s.pointers_at_tick),
      "pointers"_is(pointers_cell(snapshot)), "events"_is(std::move(events)));
  if (any_axis(snapshot.rotary)) {
    cell.json["rotary_axes"] = rotary.json;
    cell.json["rotary_compensation_um"] = rotary_um.json;
  }
  return cell;
}

namespace {

Json value_of(const params::Field& field, const UnitParameters& parameters) {
  const auto number = params::number_of(field, parameters);
  if (field.type == params::FieldType::truth) return number && *number != 0.0;
  if (field.type == params::FieldType::integer && number) return static_cast<long long>(*number);
  if (field.type == params::FieldType::number) return number_or_null(number);
  return params::text_of(field, parameters);
}

bool is_shown(const params::Field& field, const UnitParameters& parameters) {
  return !field.axis || parameters.axis_present[index_of(*field.axis)];
}

}  // namespace

Cell parameters_cell(const UnitParameters& parameters) {
  Json object = Json::object();
  for (const params::Field& field : params::fields()) object[field.key] = value_of(field, parameters);
  std::string text;
  for (const params::Group group :
       {params::Group::configuration, params::Group::compensation, params::Group::datuming}) {
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", params::name_of(group));
    for (const params::Field& field : params::fields())
      if (field.group == group && is_shown(field, parameters))
        text += fmt::format("  {:<40} {:>14}{}{}\n", field.key, params::text_of(field, parameters),
                            field.unit.empty() ? "" : " ", field.unit);
  }
  return {std::move(object), std::move(text)};
}

Cell differences_cell(const std::vector<params::Difference>& differences, std::string_view key_a,
                      std::string_view key_b, std::string_view name_a, std::string_view name_b) {
  Cell list{Json::array(), params::to_text(differences, name_a, name_b)};
  for (const params::Difference& d : differences)
    list.json.push_back(
        object_of("key"_is(d.key), "unit"_is(text_cell(d.unit)), FieldKey(key_a)(d.a), FieldKey(key_b)(d.b)));
  return list;
}

}  // namespace ecs::commissioning
