// Work on the unit that the verbs of ECS UTILITY and its screens share.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "core/address_map.hpp"
#include "core/parameters.hpp"
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

/// "+5 um", "0 um"
[[nodiscard]] std::string um_text(double um);

/// What an output scale should be, from what was put out and what a dial gauge showed.
struct ScaleProposal {
  double counts_per_um = 0.0;  ///< above 0
  int polarity = 1;            ///< compensation polarity
  std::string sentence;        ///< for the user, with the names of the parameters
};
/// @param measured_um  movement of the axis when `um` were put out, signed as the axis's coordinate; a usage problem
/// where no scale follows from them
[[nodiscard]] Result<ScaleProposal> scale_from(const AxisParameters& axis, Axis name, double um, double measured_um);

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
