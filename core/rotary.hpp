// Rotary axes in the loop (thesis 9.4): up to two of A, B, C that carry the workpiece or the tool, each beyond every
// linear axis of its side. The unit corrects X, Y, Z, so all is reckoned in the frame of the linear axes: with the axis
// next to them (`inner`, turned by R), the one beyond it (`outer`) and arms counted from the pivots
//   E = δ_inner + Q δ_outer + (ε_inner + Q ε_outer) × arm      Q = R of a head, R⁻¹ of a table
// A head that bends as its axis next to the tool tilts adds to δ_inner (the machine) and to δ_outer (the tool).
// A head also turns the tool offset, at which the rotations of the linear axes act. Directions may be oblique.
// Does not live here: the bytes (memory_image.hpp), the tick (tick.hpp), chains in general (kinematics/).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/axis.hpp"
#include "core/bytes.hpp"
#include "core/parameters.hpp"
#include "core/thermal.hpp"

namespace ecs {

inline constexpr std::size_t kRotaryInputs = 2;
template <class T>
using PerRotary = std::array<T, kRotaryInputs>;

/// A rotary axis as the unit needs it. Angles are those of the tool against the workpiece, right-handed.
struct RotaryAxis {
  char letter = '\0';                ///< A, B or C; '\0': no axis
  double deg_per_count = 1e-3;       ///< sign = wiring polarity; not 0, below half a turn
  double deadband_deg = 2e-3;        ///< minimum angle to qualify as a move
  Vector3 direction{0.0, 0.0, 1.0};  ///< of positive rotation, all axes at 0, length 1
  Vector3 pivot_mm{};                ///< a point on the axis, all axes at 0
  std::array<double, 6> location{};  ///< location *errors* XO. YO. ZO. [um] AO. BO. CO. [um/m]
  double zero_deg = 0.0;             ///< angle at 0 counts of its transducer, which is absolute
  friend bool operator==(const RotaryAxis&, const RotaryAxis&) = default;
};

/// The six curves of one axis, on one grid. Straight between the values; beyond the ends of a table that is no whole
/// turn the nearer end holds.
struct RotaryCurves {
  double start_deg = 0.0;
  double increment_deg = 10.0;  ///< such that 1,440 to 3,600 equal cells make a turn and each value begins one
  std::uint32_t count = 0;      ///< of values of each curve; 0: all six are zero
  std::array<double, 6> resolution{0.01, 0.01, 0.01, 0.01, 0.01, 0.01};  ///< um or um/m per count
  /// Reverse, forward; 6 × count × 2 bytes: compensation = value × resolution, curve after curve EX. … EC.
  std::array<ByteView, 2> values{};
};

/// How a machine bends while the axis next to the tool tilts a head by b: *errors* s sin b + c (1 - cos b), s along X,
/// Y, Z, then c.
struct RotaryBending {
  std::array<double, 6> of_machine{};  ///< um, in directions that no rotary axis turns
  std::array<double, 6> of_tool{};     ///< um for each metre of tool offset, in directions that the axis beneath turns
  friend bool operator==(const RotaryBending&, const RotaryBending&) = default;
};

/// What a unit with rotary axes has beyond its parameters.
struct RotarySetup {
  std::array<char, 8> configuration{};  ///< with the rotary axes: "XYACTZ", zero-terminated
  PerRotary<RotaryAxis> axes{};         ///< in any order
  PerRotary<RotaryCurves> tables{};     ///< in the same
  RotaryBending bending{};
};

/// Why rotary axes cannot be compensated.
enum class RotaryFault : std::uint8_t {
  none,
  other_chain,    ///< the configuration is not that of the parameters with the letters of the axes
  turned_linear,  ///< a rotary axis moves a linear one
  part_of_model,  ///< scope, convention or interpolation are not those of the whole model
  no_tool_range,  ///< a head turns the tool, but the map need not hold what only a tool levers
  bad_axis,
  bad_table,
  uneven_table,  ///< no number of cells fits its increment
  no_head        ///< bending without a head that could tilt
};
[[nodiscard]] std::string_view text_of(RotaryFault fault) noexcept;

/// Curves, cosine and sine at the beginning of a cell, and what they grow by for each 2^-32 of it, in the order
/// EX EA EY EB EZ EC cos sin: um, and um for each mm of an arm.
struct alignas(64) RotaryCell {
  std::array<double, 8> value{};
  std::array<double, 8> slope{};
};

/// One axis as the tick needs it: a turn in equal cells, so many that each value of the table begins one. Cosine and
/// sine are straight within a cell: with the fewest cells they are up to 2.4e-6 too small.
struct RotaryAxisWorking {
  static constexpr std::uint32_t kFewestCells = 1440, kMostCells = 3600;
  char letter = '\0';
  std::uint64_t turn_per_count = 0;  ///< in 2^-64 of a turn: angles overflow to 0 after a turn
  std::int64_t deadband_counts = 0;
  std::uint64_t start = 0;  ///< angle at which the first cell begins, in 2^-64 of a turn
  std::uint64_t cells = 1;
  std::array<std::array<RotaryCell, 2>, kMostCells> cell{};  ///< while the counts fall, and rise
};

/// A vector that follows the angle of an axis: constant, and what comes for its cosine and sine.
using TurnedLanes = std::array<Lanes, 3>;

/// The working form, in places: 0 the inner axis, or the table where a head is there as well; 1 the other one, and a
/// head of one axis.
struct RotaryWorking {
  enum class Arrangement : std::uint8_t { none, tables, heads, table_and_head };
  static constexpr std::size_t kOblique = 3;
  static constexpr std::uint32_t kWays = 22;

  Arrangement arrangement = Arrangement::none;
  /// Of the tick: direction of the inner axis, X, Y or Z or kOblique, and 0 of tables, 4 of heads, and of heads 4 more
  /// if the machine bends and 8 more if the tool does; 20 of table and head, 21 if it bends.
  std::uint32_t way = 0;
  alignas(16) std::array<double, 2> um_per_mm{};  ///< twice: of a linear axis's rotation of 1 um/m
  Vector3 inner_axis{0.0, 0.0, 1.0};              ///< the sine of the inner cells is that of Q about this direction
  alignas(16) TurnedLanes arm_mm{};               ///< of the tool, by the axis at place 1
  alignas(16) TurnedLanes machine_bend_um{};      ///< compensation of bending, by the same; beside a table 0
  alignas(16) TurnedLanes tool_bend_um{};         ///< the same as the inner axis turns it; beside a table all bending
  RotaryBending bending{};                        ///< that they compensate
  Vector3 table_arm_mm{};                         ///< of the table beside a head: without the arm of the tool
  Vector3 turned_from_mm{};                       ///< pivot from which that axis turns the tool
  Vector3 turned_about{0.0, 0.0, 1.0};            ///< its direction
  Vector3 arm_from_mm{};                          ///< pivot from which arms count
  PerRotary<RotaryAxisWorking> axes{};            ///< by place

  [[nodiscard]] bool turns_tool() const noexcept { return arrangement >= Arrangement::heads; }
};

/// What is impossible in axes, bending and tables whatever the parameters are: bad_axis, bad_table, uneven_table; else
/// none.
[[nodiscard]] RotaryFault own_fault_of(const RotarySetup& machine) noexcept;

/// An angle of any size in 2^-64 of a turn.
[[nodiscard]] std::uint64_t turn_of(double deg) noexcept;

/// Builds the working form. Allocation-free. On refusal `working` has no rotary axis.
[[nodiscard]] RotaryFault compile_rotary_axes(const RotarySetup& machine, const UnitParameters& parameters,
                                              RotaryWorking& working) noexcept;
/// Arms of another tool.
void set_rotary_tool(RotaryWorking& working, const Vector3& tool_offset_mm) noexcept;

/// What the loop remembers of rotary axes from tick to tick, by place.
struct RotaryTickState {
  PerRotary<std::uint64_t> turn_at_0{};  ///< angle from `start` where the transducer shows 0 counts
  PerRotary<std::uint64_t> turn{};       ///< angle from `start`, in 2^-64 of a turn
  PerRotary<std::int64_t> extreme_counts{};
  PerRotary<std::uint64_t> counts_rise{};  ///< approach as the transducer shows it, 0 or 1
  /// 0 A B C: rotation by thermal rows that acts at a tool which a head turns, um/m.
  alignas(16) Lanes thermal_turn{};
};

}  // namespace ecs
