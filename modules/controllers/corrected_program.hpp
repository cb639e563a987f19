// A part program corrected in advance (pre-calibrated and post-process compensation, thesis 1.4.2.2): what its blocks
// do, the compensation along every move, the program with shifted ends and divided moves. Everything else in it stays
// byte for byte. Does not live here: text and words (part_program.hpp), where the compensation comes from and what is
// said of the result (program_verb.cpp).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/maps/machine_map.hpp"
#include "modules/controllers/part_program.hpp"

namespace ecs::controllers {

using commissioning::MachinePlace;

/// Where the tool is: axis positions with their approaches, and the same in program coordinates.
struct ProgramPlace {
  MachinePlace machine;  ///< unknown approach: the mean of both counts
  Vector3 program_mm{};
};

/// Compensation = −error at places [um], as many; nothing where it is not known.
using CompensationAt = std::function<Result<std::vector<std::optional<Vector3>>>(const std::vector<ProgramPlace>&)>;

struct ProgramSettings {
  std::map<int, Vector3> work_offset_mm;      ///< by 54 … 59: machine coordinates of the program's zero point
  std::map<int, double> tool_length_mm;       ///< by H: added to Z while G43 is active, subtracted with G44
  PerAxis<std::optional<double>> start_mm{};  ///< before the first block, machine coordinates; absent: not known
  std::optional<Vector3> zero_at_mm;          ///< program coordinates at which the correction counts as zero
  PerAxis<bool> present{true, true, true};
  PerAxis<double> deadband_mm{};  ///< travel back that counts as a change of direction (core/tick.hpp)
  PerAxis<std::optional<std::array<double, 2>>> travel_mm{};  ///< absent: not known
  double tolerance_um = 1.0;                                  ///< of a piece from the corrected path; above 0
  int decimals = 4;        ///< at least, of a corrected word in mm; one more in inches
  double sample_mm = 1.0;  ///< distance of the places along a move at which the compensation is evaluated; above 0
};

/// A place along the feed moves and holes of the program, for predictions.
struct ProgramSample {
  ProgramPlace place;         ///< nominal: where the tool should be
  Vector3 off_um{};           ///< corrected command − nominal
  Vector3 compensation_um{};  ///< that was aimed at
};

/// Lines that were kept as they are, by the reason.
struct UncorrectedLines {
  std::string why;
  std::vector<int> lines;
};

struct CorrectedProgram {
  std::string text;
  std::size_t moves = 0;         ///< blocks that move an axis
  std::size_t corrected = 0;     ///< of these, the ones whose end was shifted or that were divided
  std::size_t blocks_added = 0;  ///< pieces of divided moves
  std::size_t arcs_kept = 0;     ///< compensation constant along them, within the tolerance
  std::size_t arcs_divided = 0;  ///< into straight pieces
  Vector3 largest_um{};          ///< correction, by size
  Vector3 rounding_um{};         ///< largest difference of a written coordinate from the computed one
  std::vector<UncorrectedLines> uncorrected;
  std::vector<std::string> notes;
};

/// Corrects every move: end' = end + compensation(end), the approach of each axis sensed as the unit does it, along the
/// corrected path with the mean of both approaches: it is there that the axes go. Straight feed moves are divided where
/// the compensation leaves a straight line by more than the tolerance; arcs are kept, moved as a whole, where it is
/// constant within the tolerance, else they become lines; of rapids and holes of cycles (G73, G74, G81 … G86, G89) the
/// ends are corrected. Words are added to blocks for axes that do not move but whose compensation changes. Incremental
/// words are differences of the rounded ends: nothing adds up. The compensation of a point is that of its nominal
/// position. Known: G0–G4, G8, G9, G15, G17–G21, G28, G30, G40, G43, G44, G49, G50, G53–G59, G61, G62, G64, G69–G71,
/// G80, G90, G91, G93–G99 and the cycles. Every other G code, tool radius compensation, calls, rotary words, arcs that
/// do not close and the like are refused, every line with its column (`bad_input`): a part would be wrong.
/// @param comment  for the first line, without parentheses; empty: none is written
/// @param seen     each sample in the order of the path
[[nodiscard]] Result<CorrectedProgram> corrected_program(const PartProgram& program, const ProgramSettings& settings,
                                                         const CompensationAt& compensation, const std::string& comment,
                                                         const std::function<void(const ProgramSample&)>& seen = {});

}  // namespace ecs::controllers
