// The state of a unit at one moment, with the registers it came in: taken live, kept in a file, decoded again later; in
// words and as JSON, and its parameters as a table.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "core/parameters.hpp"
#include "params/fields.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// The value that an address pointer points at, as stored and in its unit.
struct SelectedValue {
  std::int16_t counts = 0;
  double value = 0.0;  ///< um, or um/m for angles; compensation
};

struct StatusSnapshot {
  std::string taken;  ///< ISO 8601, UTC
  std::string link;   ///< as --link takes it; empty: unknown
  protocol::Identity identity;
  protocol::UnitStatus status;
  std::array<std::optional<SelectedValue>, kCurves> selected{};  ///< of the pointers in use, where they could be read
  std::optional<protocol::ControlLines> lines;                   ///< nothing: the unit has none (firmware before 1.1)
  protocol::RotarySample rotary{};                               ///< no axis: none in the map, or firmware before 1.2
  std::vector<protocol::HostEvent> events;                       ///< the oldest first
  // as they came
  protocol::Registers identity_registers;
  protocol::Registers status_registers;
  protocol::Registers pointer_registers;
  protocol::Registers lines_registers{};   ///< empty: none
  protocol::Registers rotary_registers{};  ///< the same
  std::vector<protocol::Registers> event_blocks{};
};

/// Reads identity, status, pointers and what these point at, and the newest events. Writes nothing.
[[nodiscard]] Result<StatusSnapshot> take_snapshot(protocol::UnitClient& client, const std::string& link,
                                                   std::size_t events = 0);

/// One JSON object: the decoded values for readers, and under "raw" the registers, which alone are read back.
[[nodiscard]] Result<void> write_snapshot(const std::filesystem::path& path, const StatusSnapshot& snapshot);
[[nodiscard]] Result<StatusSnapshot> parse_snapshot(std::string_view text, const std::string& name);
[[nodiscard]] Result<StatusSnapshot> read_snapshot(const std::filesystem::path& path);

/// "forward", "reverse", "unknown"
[[nodiscard]] std::string_view name_of(Approach approach);
/// Unknown: null in JSON.
[[nodiscard]] Cell approach_cell(Approach approach);
/// What the positions of axes without reference are; empty: there are none.
[[nodiscard]] std::string unreferenced_text(const protocol::MonitorSample& sample);

/// All of it; lines of at most 80 columns.
[[nodiscard]] Cell status_cell(const StatusSnapshot& snapshot);
/// What hosts did to the unit, or tried, a line each.
[[nodiscard]] Cell events_cell(const std::vector<protocol::HostEvent>& events);
/// The same as a status file holds it: marked as one, with the registers under "raw".
[[nodiscard]] Json json_with_registers(const StatusSnapshot& snapshot);
// parts of its text
[[nodiscard]] std::string axes_text(const StatusSnapshot& snapshot);        ///< a row for each axis, rotary ones too
[[nodiscard]] std::string pointers_text(const StatusSnapshot& snapshot);    ///< a row for each curve in use
[[nodiscard]] std::string memory_text(const protocol::UnitStatus& status);  ///< RAM test, checksum, active map

/// By letter: angle and approach. Text only where the unit has rotary axes, a row for each.
[[nodiscard]] Cell rotary_axes_cell(const protocol::RotarySample& sample);
/// What they add along X, Y, Z; null and no text while they add nothing because the unit does not compensate.
[[nodiscard]] Cell rotary_compensation_cell(const protocol::RotarySample& sample, UnitMode mode);

/// "good, 12.3 days old", with what to do where it is low; "good" or "low" in JSON.
[[nodiscard]] Cell battery_cell(const protocol::ControlLines& lines);
/// "on", "off: …" with what follows; in JSON null where no wire says it.
[[nodiscard]] Cell control_cell(const protocol::ControlLines& lines);

/// The fault in plain words, its place if it has one, and what to do next. @pre fault is not none
[[nodiscard]] std::string fault_sentence(const protocol::UnitStatus& status);

/// In JSON every field by its key: a number, true or false, or text. In the text a line for each field of a present
/// axis or of no axis: key, value, unit; grouped as in thesis 5.3.
[[nodiscard]] Cell parameters_cell(const UnitParameters& parameters);

/// Key, unit and both values of each. @param key_a, key_b  of the values in JSON  @param name_a, name_b  in the text
[[nodiscard]] Cell differences_cell(const std::vector<params::Difference>& differences, std::string_view key_a,
                                    std::string_view key_b, std::string_view name_a, std::string_view name_b);

}  // namespace ecs::commissioning
