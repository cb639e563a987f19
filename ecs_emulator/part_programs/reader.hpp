// Part programs as text: blocks of words in the dialect of thesis appendix B (docs/unit.md), read line by
// line. Does not live here: what the blocks do (interpreter.hpp), the program that measures a plan
// (writer.hpp).
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "ecs_emulator/machine/path.hpp"

namespace ecs::emulator {

/// G00 G01 G02 G03.
enum class ProgramMotion : std::uint8_t { rapid, line, clockwise, counterclockwise };

/// Everything that one line asks for; what it does not say is absent.
struct ProgramBlock {
  int line = 0;
  // $REP n and $END
  std::int64_t repeat = 0;  ///< above 0: a loop begins here
  bool loop_end = false;
  std::size_t partner = 0;  ///< place of the other end of the loop
  // preparatory
  std::optional<ProgramMotion> motion;
  std::optional<bool> incremental;  ///< G91: true, G90: false
  std::optional<Plane> plane;       ///< G17 G18 G19
  bool exact_stop = false;          ///< G09
  std::optional<double> dwell_s;    ///< G04
  // dimensions
  PerAxis<std::optional<double>> target_mm{};  ///< X Y Z
  PerAxis<std::optional<double>> centre_mm{};  ///< I J K, from the start of the arc
  std::optional<double> radius_mm;             ///< R; negative: the longer way round
  std::optional<double> feed_mm_min;           ///< F
  // auxiliary
  std::optional<double> spindle_rpm;  ///< S
  std::optional<int> spindle;         ///< M03: 1, M04: -1, M05: 0
  std::optional<int> tool;            ///< T: the next tool
  bool tool_change = false;           ///< M06
  std::optional<bool> trigger;        ///< M08: true, M09: false
  bool stop = false;                  ///< M00
  bool end = false;                   ///< M02 M30

  [[nodiscard]] bool moves() const { return target_mm[0] || target_mm[1] || target_mm[2]; }
  [[nodiscard]] bool has_centre() const { return centre_mm[0] || centre_mm[1] || centre_mm[2]; }
};

struct Program {
  std::string file;                  ///< name for problems
  std::vector<ProgramBlock> blocks;  ///< lines that ask for nothing are left out
};

inline constexpr int kProgramDepth = 16;  ///< loops in loops
inline constexpr std::size_t kProgramLines = 1'000'000;
inline constexpr std::size_t kProgramProblems = 50;  ///< more are not reported

/// Coordinates that add up are kept to the nanometre: sums of incremental moves stay what a hand would add up, 3 times
/// −0.1 is −0.3.
[[nodiscard]] inline double to_nanometre(double mm) { return std::round(mm * 1e6) / 1e6; }

/// Every wrong line is reported at once, with line and column.
[[nodiscard]] Result<Program> parse_program(std::string_view text, const std::string& file);
[[nodiscard]] Result<Program> read_program(const std::filesystem::path& path);

}  // namespace ecs::emulator
