// The state of a unit at one moment, with the registers it came in: taken live, kept in a file, decoded again later.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
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
  std::vector<protocol::HostEvent> events;                       ///< the oldest first
  // as they came
  protocol::Registers identity_registers;
  protocol::Registers status_registers;
  protocol::Registers pointer_registers;
  std::vector<protocol::Registers> event_blocks{};
};

/// Reads identity, status, pointers and what these point at, and the newest events. Writes nothing.
[[nodiscard]] Result<StatusSnapshot> take_snapshot(protocol::UnitClient& client, const std::string& link,
                                                   std::size_t events = 0);

/// One JSON object: the decoded values for readers, and under "raw" the registers, which alone are read back.
[[nodiscard]] Result<void> write_snapshot(const std::filesystem::path& path, const StatusSnapshot& snapshot);
[[nodiscard]] Result<StatusSnapshot> parse_snapshot(std::string_view text, const std::string& name);
[[nodiscard]] Result<StatusSnapshot> read_snapshot(const std::filesystem::path& path);

}  // namespace ecs::commissioning
