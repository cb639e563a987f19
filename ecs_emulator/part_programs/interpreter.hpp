// What a part program does, block after block: loops unrolled, modal words remembered, motions as pieces of a path.
// Nothing moves here: the same interpreter checks a program beforehand and feeds the machine (run.hpp).
#pragma once

#include <functional>
#include <map>
#include <string>

#include "ecs_emulator/machine/path.hpp"
#include "ecs_emulator/part_programs/reader.hpp"

namespace ecs::emulator {

/// Blocks that a program may execute, every pass of a loop counted.
inline constexpr std::size_t kProgramBlocks = 10'000'000;
/// The two radii of an arc may differ by this much; it then winds from one to the other.
inline constexpr double kArcMismatch_mm = 0.005;

/// The range that each axis can be sent to; absent: the machine has no such axis.
using ProgramRange = PerAxis<std::optional<std::array<double, 2>>>;

enum class ProgramTrigger : std::uint8_t {
  none,
  reading,  ///< M08 after M09: the switch closes
  missed,   ///< M08 while the switch is closed already: nothing happens
  reset,    ///< M09
};

/// What one executed block asks for, in the order in which it is done.
struct ProgramStep {
  int line = 0;
  std::optional<double> spindle_rpm;  ///< before the motion; negative: M04; 0: stop, after the motion
  std::optional<PathPiece> motion;
  bool exact_stop = false;  ///< after the motion: rapid, or G09
  std::optional<double> dwell_s;
  ProgramTrigger trigger = ProgramTrigger::none;
  std::optional<int> tool;  ///< M06: into the spindle, after the motion
  bool stop = false;        ///< M00
};

class ProgramInterpreter {
 public:
  using Complain = std::function<void(int line, std::string message)>;

  /// @param program   must outlive the interpreter
  /// @param complain  gets what is wrong with a block, each time that it is executed; the program goes on as if it had
  ///                  been a straight line to its end
  ProgramInterpreter(const Program& program, const Vector3& start_mm, const ProgramRange& range, Complain complain);

  /// The next block that asks for something; nothing at the end, and after kProgramBlocks.
  [[nodiscard]] std::optional<ProgramStep> next();
  [[nodiscard]] std::size_t executed() const { return executed_; }
  [[nodiscard]] const Vector3& place_mm() const { return place_mm_; }

 private:
  void follow_loop(const ProgramBlock& block);
  [[nodiscard]] ProgramStep step_of(const ProgramBlock& block);
  void remember(const ProgramBlock& block);
  [[nodiscard]] std::optional<PathPiece> motion_of(const ProgramBlock& block);
  [[nodiscard]] Vector3 target_of(const ProgramBlock& block) const;
  [[nodiscard]] std::optional<ArcWay> arc_of(const ProgramBlock& block, const Vector3& target_mm) const;
  [[nodiscard]] std::optional<std::array<double, 2>> centre_of(const ProgramBlock& block,
                                                               const Vector3& target_mm) const;
  void check_axes(const ProgramBlock& block, const PathPiece& piece) const;
  void check_range(int line, std::size_t axis, double low_mm, double high_mm) const;
  [[nodiscard]] ProgramTrigger trigger_of(const ProgramBlock& block);
  [[nodiscard]] std::optional<double> spindle_of(const ProgramBlock& block);

  const Program& program_;
  ProgramRange range_;
  Complain complain_;
  std::size_t at_ = 0;
  std::size_t executed_ = 0;
  std::vector<std::int64_t> passes_left_;  ///< of the loops that are open
  Vector3 place_mm_{};
  std::optional<ProgramMotion> motion_;
  bool incremental_ = false;
  Plane plane_ = Plane::XY;
  double feed_mm_min_ = 0.0;
  double spindle_rpm_ = 0.0;
  int spindle_ = 0;
  std::optional<int> next_tool_;
  bool triggered_ = false;
};

/// What a program will do, found out before anything moves.
struct ProgramSummary {
  std::size_t blocks = 0;  ///< executed
  std::size_t readings = 0;
  std::vector<int> missed_lines;  ///< lines of M08 that take no reading, each once, at most 100
  double path_mm = 0.0;
  std::optional<Vector3> first_reading_mm;
  std::map<int, int> tools;  ///< put into the spindle, each with the first line that does
};

/// Runs the whole program without a machine. `bad_input` problem with every line that is wrong, each once.
[[nodiscard]] Result<ProgramSummary> checked_program(const Program& program, const Vector3& start_mm,
                                                     const ProgramRange& range);

}  // namespace ecs::emulator
