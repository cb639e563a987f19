// The words for what host and unit tell each other.
#include "protocol/registers/unit_data.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace ecs::protocol {

namespace {

constexpr std::array<std::string_view, kUnitErrorCount> kErrorTexts{
    "no error",
    "the unit is not in integration mode; enter integration mode first",
    "no memory at this address; see the address map of the unit",
    "this memory cannot be written by the host",
    "an argument is out of its range",
    "the unit does not know this command; its firmware may be older than this program",
    "no data have been sent; begin the transfer first",
    "the unit's memory differs from the announced image; send it again",
    "not a map for this unit",
    "another command is running; stop it, or wait until it ends",
    "the unit has no such axis",
    "the axis is not referenced yet; give it a position or run its datum sequence",
    "a fault of the unit; see its status",
    "stopped on request",
    "the unit timed out while waiting",
    "this transfer has ended: another host has started one or sent a map, or the unit was restarted; send the map "
    "again",
    "the image is not for this unit and its machine",
    "the unit no longer knows this host; it was restarted, or many other hosts have used it",
    "the command arrived too late, more than two seconds after it was given; it was not carried out",
    "everything was switched off after this command had been given; it was not carried out",
    "host and unit speak different versions of the protocol",
    "this computer is not armed, so it may only read. Run `ecs unit arm --arm-code CODE`, or add --arm-code CODE to "
    "the command; the unit shows the code",
    "this is not the code shown by the unit",
    "a wrong code was given just before",
    "the keyed check is wrong: the host was armed again, the unit was restarted, or another program uses the host's "
    "name; try again",
};

constexpr std::array<std::string_view, kCommandCount> kCommandNames{"none",
                                                                    "enter integration mode",
                                                                    "enter compensation mode",
                                                                    "set axis position",
                                                                    "output compensation",
                                                                    "output off",
                                                                    "start a transfer",
                                                                    "activate the sent map",
                                                                    "cancel transfer",
                                                                    "test datum routine",
                                                                    "record datum",
                                                                    "run user software",
                                                                    "run RAM test",
                                                                    "clear fault",
                                                                    "reset unit",
                                                                    "check memory",
                                                                    "stop",
                                                                    "arm",
                                                                    "set live input",
                                                                    "select tool",
                                                                    "set tool",
                                                                    "remove tool",
                                                                    "try squareness",
                                                                    "start a table of tools",
                                                                    "stage tool",
                                                                    "replace table of tools"};

}  // namespace

std::string_view text_of(UnitError error) noexcept {
  return kErrorTexts[std::min<std::size_t>(static_cast<std::size_t>(error), kUnitErrorCount - 1)];
}

bool acts_at_once(CommandCode code) noexcept {
  switch (code) {
    case CommandCode::enter_compensation:
    case CommandCode::set_axis_position:
    case CommandCode::output_compensation:
    case CommandCode::test_datum:
    case CommandCode::record_datum:
    case CommandCode::run_user_software:
    case CommandCode::run_ram_test:
    case CommandCode::clear_fault:
    case CommandCode::reset_unit:
    case CommandCode::set_input:
    case CommandCode::select_tool:
    case CommandCode::set_tool:
    case CommandCode::remove_tool:
    case CommandCode::try_squareness:
    case CommandCode::commit_tools:
      return true;
    default:
      return false;
  }
}

bool needs_arming(CommandCode code) noexcept {
  return acts_at_once(code) || code == CommandCode::begin_staging || code == CommandCode::commit_staged ||
         code == CommandCode::begin_tools || code == CommandCode::stage_tool;
}

Vector3 in_tool_steps(const Vector3& offset_mm) noexcept {
  Vector3 rounded{};
  for (std::size_t a = 0; a < kAxes; ++a)
    rounded[a] = static_cast<std::int32_t>(std::lround(offset_mm[a] / kToolStep_mm)) * kToolStep_mm;
  return rounded;
}

std::uint64_t tools_digest(const ToolTable& table) {
  ToolTable sorted{0, 0, table.tools};
  std::sort(sorted.tools.begin(), sorted.tools.end(), [](const Tool& a, const Tool& b) { return a.number < b.number; });
  std::array<std::uint8_t, kToolTableBytes> slot{};
  encode_tools(sorted, slot);
  return short_digest(digest_of(slot));
}

std::size_t damaged_tool_slots(ByteView record) noexcept {
  std::size_t damaged = 0;
  for (std::size_t slot = 0; slot < 2; ++slot) {
    const ByteView bytes = record.subspan(slot * kToolTableBytes, kToolTableBytes);
    std::array<std::uint8_t, kToolRecord.size> alone{};
    std::copy(bytes.begin(), bytes.end(), alone.begin());
    const bool is_used = std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte != 0; });
    if (is_used && !stored_tools(alone)) ++damaged;
  }
  return damaged;
}

ExchangeTerms exchange_terms(std::string_view code, std::string_view serial_number, std::uint32_t session,
                             std::uint16_t minutes) {
  return {std::string(code), fmt::format("ECS host, ECS unit {}", serial_number), fmt::format("{:08x}", session),
          fmt::format("{} min", minutes), std::string(serial_number)};
}

bool switches_off(CommandCode code) noexcept {
  return code == CommandCode::stop || code == CommandCode::output_off || code == CommandCode::enter_integration;
}

std::string_view name_of(ToolState state) noexcept {
  constexpr std::array<std::string_view, kToolStateCount> names{"none", "acting", "changing", "unknown"};
  return names[std::min<std::size_t>(static_cast<std::size_t>(state), names.size() - 1)];
}

std::string_view name_of(CommandState state) noexcept {
  constexpr std::array<std::string_view, 5> names{"idle", "under way", "done", "refused", "failed"};
  return names[std::min<std::size_t>(static_cast<std::size_t>(state), names.size() - 1)];
}

std::string_view name_of(CommandCode code) noexcept {
  return kCommandNames[std::min<std::size_t>(static_cast<std::size_t>(code), kCommandCount - 1)];
}

}  // namespace ecs::protocol
