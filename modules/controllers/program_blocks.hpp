// Blocks of a part program: what their words ask for and set, which of them are refused, and how a block is written
// again with other ends. Internal to the correction of programs. Does not live here: text and words (part_program.hpp),
// the moves (program_path.hpp, corrected_program.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/corrected_program.hpp"
#include "modules/controllers/part_program.hpp"

namespace ecs::controllers {

/// Sums of incremental words stay what a hand would add up, in inches too (1e-6 in is 2.54e-5 mm).
[[nodiscard]] inline double without_noise(double mm) { return std::round(mm * 1e8) / 1e8; }

/// A G code in tenths: 541 of G54.1.
[[nodiscard]] inline int code_of(const ProgramWord& word) { return static_cast<int>(std::lround(word.value * 10.0)); }
/// Of holes: G73 … G89.
[[nodiscard]] bool is_cycle(int code);
/// Whether an M code acts before the motion of its block, and behind it; of others it is not known.
[[nodiscard]] bool is_before_motion(const ProgramWord& m);
[[nodiscard]] bool is_behind_motion(const ProgramWord& m);

/// The words of a line by what they mean; null: it has none such.
struct BlockOfWords {
  PerAxis<const ProgramWord*> axis{}, centre{};
  const ProgramWord* radius = nullptr;
  const ProgramWord* feed = nullptr;
  const ProgramWord* motion = nullptr;   ///< G0 … G3, or a cycle
  const ProgramWord* tool = nullptr;     ///< H
  const ProgramWord* repeats = nullptr;  ///< L or K of a cycle, L of an arc
  const ProgramWord* turns = nullptr;    ///< P of an arc; elsewhere it means other things
  std::vector<const ProgramWord*> g, m;

  [[nodiscard]] bool has(int code) const {
    return std::any_of(g.begin(), g.end(), [&](const ProgramWord* one) { return code_of(*one) == code; });
  }
  [[nodiscard]] bool names_axis() const { return axis[0] || axis[1] || axis[2]; }
  [[nodiscard]] bool has_centre() const { return centre[0] || centre[1] || centre[2]; }
};

/// What the words of the blocks so far have set.
struct ModalState {
  int motion = -1;  ///< in tenths, as code_of(); below 0: none yet
  int plane = 17;
  double unit_mm = 1.0;
  bool incremental = false, inverse_time = false, to_initial = true;
  Vector3 zero_point_mm{};
  double tool_mm = 0.0;

  [[nodiscard]] bool goes_round() const { return motion == 20 || motion == 30; }
  [[nodiscard]] double frame_mm(std::size_t axis) const { return zero_point_mm[axis] + (axis == 2 ? tool_mm : 0.0); }
  [[nodiscard]] Vector3 program_mm(const Vector3& machine_mm) const {
    return {machine_mm[0] - frame_mm(0), machine_mm[1] - frame_mm(1), machine_mm[2] - frame_mm(2)};
  }
};

/// Reads block after block; what is refused is complained about.
class BlockReader {
 public:
  BlockReader(const PartProgram& program, const ProgramSettings& settings);
  /// The words of the next block, which have acted on the state; those of a dwell (G4) do not. Nothing: something was
  /// complained about.
  [[nodiscard]] std::optional<BlockOfWords> read(const ProgramLine& line);
  void complain(const ProgramLine& line, const ProgramWord& word, std::string_view message);

  [[nodiscard]] const ModalState& modal() const { return modal_; }
  [[nodiscard]] const laser::Findings& findings() const { return findings_; }
  /// The first line with a word without a decimal point; 0: none has one.
  [[nodiscard]] int whole_numbers_in() const { return whole_numbers_in_; }

 private:
  [[nodiscard]] BlockOfWords words_of(const ProgramLine& line);
  // False: something was complained about.
  [[nodiscard]] bool check(const ProgramLine& line, const BlockOfWords& block);
  [[nodiscard]] bool remember(const ProgramLine& line, const BlockOfWords& block);
  [[nodiscard]] bool use_offset(const ProgramLine& line, const ProgramWord& word);
  [[nodiscard]] bool use_tool(const ProgramLine& line, const ProgramWord& word, const BlockOfWords& block);

  const ProgramSettings& settings_;
  laser::Findings findings_;
  ModalState modal_;
  int ended_ = 0;  ///< line of M2 or M30
  int whole_numbers_in_ = 0;
};

class LineEdit;

/// Writes block after block of the corrected program, and knows where the control then has the axes.
class BlockWriter {
 public:
  /// @param made  takes the text and what is counted of it; it and the others must outlive this
  BlockWriter(const PartProgram& program, const ProgramSettings& settings, const ModalState& modal,
              CorrectedProgram& made)
      : program_(program), settings_(settings), modal_(modal), made_(made) {}

  /// As the control has the axes, machine coordinates; absent: not known.
  [[nodiscard]] const PerAxis<std::optional<double>>& actual_mm() const { return actual_; }
  /// The same, 0 where it is not known.
  [[nodiscard]] Vector3 place_mm() const {
    return {actual_[0].value_or(0.0), actual_[1].value_or(0.0), actual_[2].value_or(0.0)};
  }
  /// An axis that goes where no corrected word sends it.
  void set_actual(std::size_t axis, std::optional<double> place_mm) { actual_[axis] = place_mm; }
  /// G80: the next block needs a motion word.
  void forget_motion() { written_motion_ = -1; }

  /// A line as it is.
  void keep(const ProgramLine& line);
  /// The same; its motion word acts.
  void keep(const ProgramLine& line, const BlockOfWords& block);
  /// The same, with the motion word that it needs.
  void keep_in_motion(const ProgramLine& line, const BlockOfWords& block);
  /// A block and the pieces behind it.
  /// @param aims_mm  ends of the pieces, machine coordinates
  /// @param shares   of each in the move
  /// @param motion   of the pieces: that of the block, or lines in place of an arc
  /// @return where the control has the axes behind each piece
  std::vector<Vector3> write(const ProgramLine& line, const BlockOfWords& block, const std::vector<Vector3>& aims_mm,
                             const std::vector<double>& shares, int motion);
  /// @param bottom_mm  of the holes of this cycle as the control has it; set where the block names it
  void write_hole(const ProgramLine& line, const BlockOfWords& block, const Vector3& aim_mm,
                  std::optional<double>& bottom_mm);

 private:
  /// The word that sends an axis there, and where it then is; nothing: an axis that is not named stays.
  /// @param actual_mm  where the control has it
  [[nodiscard]] std::optional<std::string> coordinate(const ProgramLine& line, Axis axis, double aim_mm,
                                                      const ProgramWord* original, std::optional<double>& actual_mm);
  void send(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, Axis axis, double aim_mm,
            std::optional<double>& actual_mm);
  /// The motion word of a block in which the control would not have the motion that it needs.
  void write_motion_word(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, int motion);
  /// Empty: no axis moves by as much as its last digit.
  [[nodiscard]] std::string piece_to(const ProgramLine& line, const Vector3& aim_mm);

  const PartProgram& program_;
  const ProgramSettings& settings_;
  const ModalState& modal_;
  CorrectedProgram& made_;
  PerAxis<std::optional<double>> actual_{};
  int written_motion_ = -1;  ///< that the control has in the corrected program
};

}  // namespace ecs::controllers
