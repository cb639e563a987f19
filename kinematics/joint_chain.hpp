// The kinematic chain of a machine with linear axes X, Y, Z and up to two rotary axes A, B, C.
// Does not live here: the three-axis chain that a unit compensates (core/chain.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/chain.hpp"
#include "core/component.hpp"

namespace ecs::kinematics {

/// An axis that moves: linear along, or rotary about, X, Y, Z. The first three have the numbers of core's Axis.
enum class Joint : std::uint8_t { X, Y, Z, A, B, C };

inline constexpr std::size_t kJoints = 6;
inline constexpr std::size_t kMostRotary = 2;
inline constexpr std::size_t kMostLetters = kAxes + kMostRotary;

template <class T>
using PerJoint = std::array<T, kJoints>;

[[nodiscard]] constexpr std::size_t index_of(Joint joint) { return static_cast<std::size_t>(joint); }
[[nodiscard]] constexpr bool is_rotary(Joint joint) { return joint >= Joint::A; }
[[nodiscard]] constexpr Joint joint_of(Axis axis) { return static_cast<Joint>(ecs::index_of(axis)); }
/// The direction along which, or about which, it moves where nothing else is said.
[[nodiscard]] constexpr Axis direction_of(Joint joint) { return static_cast<Axis>(index_of(joint) % kAxes); }
[[nodiscard]] constexpr char letter_of(Joint joint) { return "XYZABC"[index_of(joint)]; }
[[nodiscard]] constexpr std::optional<Joint> joint_of(char letter) {
  for (std::size_t j = 0; j < kJoints; ++j)
    if ("XYZABC"[j] == letter) return static_cast<Joint>(j);
  return std::nullopt;
}

struct ChainJoint {
  Joint joint = Joint::X;
  bool carries_workpiece = false;  ///< a letter before the T
  friend constexpr bool operator==(const ChainJoint&, const ChainJoint&) = default;
};

/// Every axis from the workpiece to the tool: that of "XYACTZ" is C A Y X | Z (ISO 10791-6: w C' A' Y' X' b Z t).
struct JointChain {
  std::array<ChainJoint, kMostLetters> joints{};
  std::size_t count = 0;

  [[nodiscard]] constexpr const ChainJoint* begin() const { return joints.data(); }
  [[nodiscard]] constexpr const ChainJoint* end() const { return joints.data() + count; }
  [[nodiscard]] constexpr bool has(Joint joint) const {
    for (const ChainJoint& one : *this)
      if (one.joint == joint) return true;
    return false;
  }
  [[nodiscard]] constexpr std::size_t rotary_count() const {
    std::size_t rotary = 0;
    for (const ChainJoint& one : *this) rotary += is_rotary(one.joint) ? 1u : 0u;
    return rotary;
  }
  friend constexpr bool operator==(const JointChain&, const JointChain&) = default;
};

/// What is wrong with a configuration, as what was expected; nothing: it is a chain. Letters as in core/chain.hpp, with
/// A, B, C among them: exactly one T, at least one of X, Y, Z, none twice, at most two rotary axes.
[[nodiscard]] std::optional<std::string> fault_of(std::string_view configuration);

/// Nothing if fault_of() finds one.
[[nodiscard]] std::optional<JointChain> joint_chain_of(std::string_view configuration);

/// The letters without those of rotary axes: the chain that a unit compensates.
[[nodiscard]] std::string linear_configuration(std::string_view configuration);

/// As ISO 10791-6 writes it, from the workpiece over the bed to the tool: "w C' A' Y' X' b Z t".
[[nodiscard]] std::string iso_notation(const JointChain& chain);

}  // namespace ecs::kinematics
