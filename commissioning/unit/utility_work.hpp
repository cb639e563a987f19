// Work on the unit that the verbs of ECS UTILITY and its screens share.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "core/address_map.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

/// The unit's datum routine of one axis.
struct AxisTest {
  Axis axis = Axis::X;
  bool passed = false;
  std::string message;                        ///< why not, and what to do
  DatumFailure failure = DatumFailure::none;  ///< by the unit's status
};
/// A routine that failed is an answer; a lost link and a cancel are problems.
[[nodiscard]] Result<AxisTest> test_datum_of(protocol::UnitClient& client, Axis axis, std::chrono::milliseconds limit,
                                             const protocol::CommandCallback& busy = {});

/// Compensation mode as far as it goes at once: `done` when the unit waits for its axes to be referenced. Where the
/// unit cannot, its own fault in words is the problem.
[[nodiscard]] Result<void> begin_compensation(protocol::UnitClient& client);

/// A register as the unit keeps it after user software has ended: "D0" … "D7", "A0" … "A7", "PC", "SR".
struct KeptRegister {
  std::string name;
  std::uint32_t value = 0;
};
[[nodiscard]] Result<std::vector<KeptRegister>> kept_registers(protocol::UnitClient& client);
/// By name in JSON; in the text four in a row: "D0 00000000   D1 …".
[[nodiscard]] Cell registers_cell(const std::vector<KeptRegister>& registers);
[[nodiscard]] std::string registers_text(const std::vector<KeptRegister>& registers);  ///< the text of it

}  // namespace ecs::commissioning
