// The rigid-body error model of any chain as one table of terms, rotary axes among them. For a chain of linear axes
// these are the rows of core/terms.hpp (tests/kinematics/joint_terms_test.cpp holds them to each other).
// With the joints from the workpiece to the tool, N_j their motions (rotations about the fixed direction through the
// pivot), o the tool point where all joints are at 0:
//   tool point      P = N_1 N_2 … N_n o
//   error           E = Σ_b R_b [ δ_b + ε_b × L_b ]         orientation   Ω = Σ_b R_b ε_b       (frame of the
//   workpiece) lever           L_b = N_{first beyond b} … N_n o − r_b
// A linear carriage turns with its moving part, a rotary axis moves in the frame of its part that does not turn; so
// what lies beyond b counted towards the tool includes b itself for a linear axis that carries the workpiece and for a
// rotary axis that carries the tool. R_b turns from there to the workpiece; r_b is the measurement line, or the pivot.
// Sources: R. Schultschik, CIRP Annals 25 (1977) 223; S. Ibaraki, W. Knapp, Int. J. Automation Technol. 6 (2012) 110;
// names of ISO 230-1 and ISO 230-7.
#pragma once

#include <array>
#include <cstdint>

#include "core/terms.hpp"
#include "kinematics/joint_chain.hpp"

namespace ecs::kinematics {

/// One row: the error of `moving` in `sense` adds to the tool point along `observed`, in the frame of `moving`.
struct JointTerm {
  Axis observed = Axis::X;
  Joint moving = Joint::X;
  Sense sense = Sense::EX;
  bool has_lever = false;
  Axis lever = Axis::X;  ///< direction of the lever arm, if has_lever
  std::int8_t sign = 1;
  friend constexpr bool operator==(const JointTerm&, const JointTerm&) = default;
};

/// A constant between two linear axes: the motion of `lever` leans, so that it adds along `observed`, in its own frame.
struct SquarenessTerm {
  Axis observed = Axis::X;
  Component component = Component::C0Y;
  Axis lever = Axis::Y;
  std::int8_t sign = 1;
};

struct JointTable {
  std::array<JointTerm, kMostLetters * 9> rows{};  ///< 3 translations, 3 rotations of two directions each
  std::size_t count = 0;
  std::array<SquarenessTerm, 3> squareness{};
  std::size_t squareness_count = 0;
};

/// The terms of a chain, in the order of the joints X Y Z A B C, then senses, then observed directions.
[[nodiscard]] JointTable terms_of(const JointChain& chain);

/// True where the position of `other` is part of the lever arm of `b`: the rule above.
[[nodiscard]] bool is_beyond(const JointChain& chain, Joint b, Joint other, CurveKind curves);

/// The table in core's form. @pre no rotary axis in `chain`
[[nodiscard]] TermTable as_linear_terms(const JointChain& chain, CurveKind curves);

}  // namespace ecs::kinematics
