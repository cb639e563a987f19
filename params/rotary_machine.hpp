// The rotary axes of a machine file (docs/five_axes.md). machine.hpp has its linear axes, all that a unit deals with.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kinematics/joint_chain.hpp"
#include "params/machine.hpp"

namespace ecs::params {

/// One rotary axis (kinematics/machine_pose.hpp).
struct MachineRotaryAxis {
  std::array<double, 2> travel_deg{};  ///< lower end, upper end; lower < upper; 360 apart: whole turns
  Vector3 direction{};                 ///< of positive rotation of the tool against the workpiece, length 1
  Vector3 pivot_mm{};                  ///< a point on its axis, all axes at 0
  friend bool operator==(const MachineRotaryAxis&, const MachineRotaryAxis&) = default;
};

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

}  // namespace ecs::params
