#include "commissioning/unit/status_view.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "core/fault.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {
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

bool has_address(Fault fault) { return fault == Fault::ram_test || fault == Fault::block_check; }

Json fault_json(const UnitStatus& status) {
  const FaultText text = ecs::text_of(status.fault);
  return Json{{"name", text.name},
              {"number", static_cast<int>(status.fault)},
              {"meaning", text.meaning},
              {"action", text.action},
              {"address", has_address(status.fault) ? Json(hex_address(status.fault_address)) : Json(nullptr)},
              {"axis", status.fault_axis ? Json(std::string(1, letter_of(*status.fault_axis))) : Json(nullptr)}};
}

/// Both numbers are zero until the first check.
bool block_check_made(const UnitStatus& status) {
  return status.block_check_expected != 0 || status.block_check_found != 0;
}

Json block_check_json(const UnitStatus& status) {
  if (!block_check_made(status)) return Json{{"expected", nullptr}, {"found", nullptr}, {"agrees", nullptr}};
  return Json{{"expected", fmt::format("{:08X}", status.block_check_expected)},
              {"found", fmt::format("{:08X}", status.block_check_found)},
              {"agrees", status.block_check_expected == status.block_check_found}};
}

Json axis_json(const AxisStatus& axis) {
  return Json{
      {"referenced", axis.referenced},
      {"datum_stage", ecs::name_of(axis.datum_stage)},
      {"datum_failure", ecs::name_of(axis.datum_failure)},
      {"datum_advice", axis.datum_failure == DatumFailure::none ? Json(nullptr) : Json(advice_for(axis.datum_failure))},
      {"position_mm", axis.referenced ? number_or_null(axis.position_mm) : Json(nullptr)},
      {"last_approach", name_of(axis.last_approach)},
      {"relay_closed", axis.relay_closed}};
}

bool in_use(const protocol::CurvePointer& pointer) { return pointer.address != protocol::kUnused; }

Json pointers_json(const StatusSnapshot& snapshot) {
  Json out = Json::array();
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto& pointer = snapshot.status.pointers[i];
    if (!in_use(pointer)) continue;
    const auto component = static_cast<Component>(i);
    const auto& selected = snapshot.selected[i];
    out.push_back({{"component", name_of(component)},
                   {"description", laser::description_of(component)},
                   {"index", pointer.index},
                   {"address", hex_address(pointer.address)},
                   {"counts", selected ? Json(selected->counts) : Json(nullptr)},
                   {"value", selected ? number_or_null(selected->value) : Json(nullptr)},
                   {"unit", unit_of(component)}});
  }
  return out;
}

}  // namespace

std::string_view name_of(Approach approach) {
  if (approach == Approach::forward) return "forward";
  return approach == Approach::reverse ? "reverse" : "unknown";
}

std::string fault_sentence(const UnitStatus& status) {
  const FaultText text = ecs::text_of(status.fault);
  std::string sentence = fmt::format("fault {} ({}): {}", static_cast<int>(status.fault), text.name, text.meaning);
  if (has_address(status.fault)) sentence += fmt::format("; address {}", hex_address(status.fault_address));
  if (status.fault_axis) sentence += fmt::format("; axis {}", letter_of(*status.fault_axis));
  return fmt::format("{}. What to do: {}", sentence, text.action);
}

std::string axes_text(const StatusSnapshot& snapshot) {
  std::string text = "axis  referenced  datum stage     position/mm  approach  relay\n";
  for (const Axis axis : kAllAxes) {
    if (!snapshot.identity.axis_present[index_of(axis)]) continue;
    const AxisStatus& a = snapshot.status.axes[index_of(axis)];
    text += fmt::format("{:<5} {:<11} {:<15} {:>11}  {:<9} {}\n", letter_of(axis), a.referenced ? "yes" : "no",
                        ecs::name_of(a.datum_stage), a.referenced ? fmt::format("{:.4f}", a.position_mm) : "unknown",
                        name_of(a.last_approach), a.relay_closed ? "closed" : "open");
    if (a.datum_failure != DatumFailure::none)
      text += fmt::format("      datum failed: {}; {}\n", ecs::name_of(a.datum_failure), advice_for(a.datum_failure));
  }
  return text;
}

std::string pointers_text(const StatusSnapshot& snapshot) {
  std::string rows;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto& pointer = snapshot.status.pointers[i];
    if (!in_use(pointer)) continue;
    const auto component = static_cast<Component>(i);
    const auto& selected = snapshot.selected[i];
    rows += fmt::format("{}   {:>5}  {}  {:>9} {:<5}{}\n", name_of(component), pointer.index,
                        hex_address(pointer.address), selected ? fmt::format("{:.2f}", selected->value) : "unknown",
                        unit_of(component), laser::description_of(component));
  }
  if (rows.empty()) return "address pointers: none in use\n";
  return fmt::format(
      "address pointers at tick {}: the values selected last (with linear\ninterpolation the value at or below the "
      "position)\ncurve  index  address       value\n{}",
      snapshot.status.pointers_at_tick, rows);
}

std::string memory_text(const UnitStatus& status) {
  std::string text = fmt::format("RAM test     {}", name_of_outcome(status.ram_test));
  if (status.ram_test == TestOutcome::failed) text += fmt::format(" at {}", hex_address(status.ram_test_address));
  if (block_check_made(status))
    text += fmt::format("\nblock check  expected {:08X}, found {:08X}{}\n", status.block_check_expected,
                        status.block_check_found,
                        status.block_check_expected == status.block_check_found ? "" : ": they differ");
  else
    text += "\nblock check  not run\n";
  return text + fmt::format("active map   bank {}, {} bytes, commit {}\n", name_of_bank(status.active_bank),
                            status.image_length_bytes, status.commit_sequence);
}

Json json_of(const StatusSnapshot& snapshot) {
  const auto& id = snapshot.identity;
  const UnitStatus& s = snapshot.status;
  Json axes = Json::object();
  std::string present;
  for (const Axis axis : kAllAxes) {
    if (!id.axis_present[index_of(axis)]) continue;
    present += letter_of(axis);
    axes[std::string(1, letter_of(axis))] = axis_json(s.axes[index_of(axis)]);
  }
  const bool failed = s.ram_test == TestOutcome::failed;
  return Json{
      {"taken", text_or_null(snapshot.taken)},
      {"link", text_or_null(snapshot.link)},
      {"unit",
       {{"serial_number", text_or_null(id.serial_number)},
        {"name", text_or_null(id.unit_name)},
        {"firmware", fmt::format("{}.{}", id.firmware_major, id.firmware_minor)},
        {"protocol_version", id.protocol_version},
        {"axes", present},
        {"memory_modules", id.memory_modules},
        {"capacity_values", id.capacity_values}}},
      {"mode", ecs::name_of(s.mode)},
      {"fault", fault_json(s)},
      {"ram_test",
       {{"outcome", name_of_outcome(s.ram_test)},
        {"address", failed ? Json(hex_address(s.ram_test_address)) : Json(nullptr)}}},
      {"block_check", block_check_json(s)},
      {"map",
       {{"bank", s.active_bank == Bank::none ? Json(nullptr) : Json(name_of_bank(s.active_bank))},
        {"bytes", s.image_length_bytes},
        {"commit_sequence", s.commit_sequence}}},
      {"loop", {{"period_us", number_or_null(s.loop_period_us)}, {"overruns", s.loop_overruns}, {"ticks", s.ticks}}},
      {"uptime_s", s.uptime_s},
      {"watchdog_trips", s.watchdog_trips},
      {"axes", axes},
      {"pointers_at_tick", s.pointers_at_tick},
      {"pointers", pointers_json(snapshot)}};
}

std::string text_of(const StatusSnapshot& snapshot) {
  const auto& id = snapshot.identity;
  const UnitStatus& s = snapshot.status;
  std::string text = fmt::format("unit {} ({}), firmware {}.{}, {} memory module(s)\nstatus of {}\n", id.serial_number,
                                 id.unit_name, id.firmware_major, id.firmware_minor, id.memory_modules, snapshot.taken);
  text += fmt::format("mode         {}\n", ecs::name_of(s.mode));
  text += s.fault == Fault::none ? std::string("no fault\n") : fault_sentence(s) + "\n";
  text += "\n" + memory_text(s);
  text += fmt::format("loop         {} us, {} ticks, {} overruns, watchdog trips {}\nup for       {} s\n",
                      s.loop_period_us, s.ticks, s.loop_overruns, s.watchdog_trips, s.uptime_s);
  return text + "\n" + axes_text(snapshot) + "\n" + pointers_text(snapshot);
}

}  // namespace ecs::commissioning
