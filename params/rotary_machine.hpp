// The rotary axes of a machine file (docs/five_axes.md). machine.hpp has its linear axes, all that a unit deals with.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kinematics/machine_pose.hpp"
#include "params/machine.hpp"

namespace ecs::params {

struct RotaryMachine {
  Machine machine;                                     ///< the linear axes; its chain has their letters only
  std::string configuration;                           ///< as in the file: "XYACTZ"
  PerAxis<std::optional<MachineRotaryAxis>> rotary{};  ///< A, B, C: those of the configuration
};

/// The same file as parse_machine(), with the same problems: a letter without its table, a table without its letter, a
/// travel, pivot or direction that is missing or none.
[[nodiscard]] Result<RotaryMachine> parse_rotary_machine(std::string_view text, const std::string& name);
[[nodiscard]] Result<RotaryMachine> read_rotary_machine(const std::filesystem::path& path);

[[nodiscard]] bool has_rotary_axes(const RotaryMachine& machine);
/// The chain of all axes that exist.
[[nodiscard]] std::optional<kinematics::JointChain> joint_chain_of(const RotaryMachine& machine);

/// Chain, terms, directions, pivots and measurement lines; nothing if the machine has no rotary axes.
[[nodiscard]] std::optional<kinematics::JointMachine> joint_machine_of(const Machine& machine);

}  // namespace ecs::params
