#include "ecs_emulator/part_programs/interpreter.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "ecs_emulator/machine/machine_tool.hpp"

namespace ecs::emulator {
namespace {

constexpr double kSmallestRadius_mm = 1e-3;
}  // namespace

ProgramInterpreter::ProgramInterpreter(const Program& program, const Vector3& start_mm, const ProgramRange& range,
                                       Complain complain)
    : program_(program), range_(range), complain_(std::move(complain)), place_mm_(start_mm) {}

void ProgramInterpreter::follow_loop(const ProgramBlock& block) {
  if (block.repeat > 0) {
    passes_left_.push_back(block.repeat);
    ++at_;
  } else if (--passes_left_.back() > 0) {
    at_ = block.partner + 1;
  } else {
    passes_left_.pop_back();
    ++at_;
  }
}

std::optional<ProgramStep> ProgramInterpreter::next() {
  while (at_ < program_.blocks.size() && executed_ < kProgramBlocks) {
    const ProgramBlock& block = program_.blocks[at_];
    ++executed_;
    if (block.repeat > 0 || block.loop_end) {
      follow_loop(block);
      continue;
    }
    at_ = block.end ? program_.blocks.size() : at_ + 1;
    return step_of(block);
  }
  if (at_ < program_.blocks.size())
    complain_(program_.blocks[at_].line,
              fmt::format("the program executes more than {} blocks; make its loops smaller", kProgramBlocks));
  at_ = program_.blocks.size();
  return std::nullopt;
}

ProgramStep ProgramInterpreter::step_of(const ProgramBlock& block) {
  remember(block);
  ProgramStep step;
  step.line = block.line;
  step.spindle_rpm = spindle_of(block);
  step.motion = motion_of(block);
  step.exact_stop = step.motion && (block.exact_stop || motion_ == ProgramMotion::rapid);
  step.dwell_s = block.dwell_s;
  step.trigger = trigger_of(block);
  step.stop = block.stop;
  if (block.tool) next_tool_ = block.tool;
  if (block.tool_change && !next_tool_) complain_(block.line, "M06: expected a tool T before or here");
  if (block.tool_change) step.tool = next_tool_;
  return step;
}

void ProgramInterpreter::remember(const ProgramBlock& block) {
  if (block.motion) motion_ = block.motion;
  if (block.incremental) incremental_ = *block.incremental;
  if (block.plane) plane_ = *block.plane;
  if (block.feed_mm_min) feed_mm_min_ = *block.feed_mm_min;
  const bool rapid = !motion_ || *motion_ == ProgramMotion::rapid;
  if (!block.motion && rapid && block.feed_mm_min && block.moves()) motion_ = ProgramMotion::line;
}

std::optional<double> ProgramInterpreter::spindle_of(const ProgramBlock& block) {
  if (block.spindle_rpm) spindle_rpm_ = *block.spindle_rpm;
  if (block.spindle) spindle_ = *block.spindle;
  if (!block.spindle && !(block.spindle_rpm && spindle_ != 0)) return std::nullopt;
  if (spindle_ != 0 && spindle_rpm_ <= 0.0)
    complain_(block.line, "M03, M04: expected a spindle speed S before or here");
  return spindle_ * spindle_rpm_;
}

ProgramTrigger ProgramInterpreter::trigger_of(const ProgramBlock& block) {
  if (!block.trigger) return ProgramTrigger::none;
  const bool was = triggered_;
  triggered_ = *block.trigger;
  if (!triggered_) return ProgramTrigger::reset;
  return was ? ProgramTrigger::missed : ProgramTrigger::reading;
}

Vector3 ProgramInterpreter::target_of(const ProgramBlock& block) const {
  Vector3 target_mm = place_mm_;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (block.target_mm[a])
      target_mm[a] = incremental_ ? to_nanometre(place_mm_[a] + *block.target_mm[a]) : *block.target_mm[a];
  return target_mm;
}

std::optional<PathPiece> ProgramInterpreter::motion_of(const ProgramBlock& block) {
  const bool round = motion_ == ProgramMotion::clockwise || motion_ == ProgramMotion::counterclockwise;
  const bool centred = block.has_centre() || block.radius_mm;
  if (centred && !round) complain_(block.line, "I J K R: only G02 and G03 accept a centre or a radius");
  if (!block.moves() && !(round && centred)) return std::nullopt;
  if (!motion_) {
    complain_(block.line, "expected G00, G01, G02, G03 or a feed F before the first motion");
    motion_ = ProgramMotion::rapid;
  }
  const bool feed = *motion_ != ProgramMotion::rapid;
  if (feed && !(feed_mm_min_ > 0.0))
    complain_(block.line, "expected a feed F before the first motion that is not rapid");
  else if (feed && feed_mm_min_ < kSlowestFeed_mm_min)
    complain_(block.line, fmt::format("F: expected {} mm/min or more, got {}", kSlowestFeed_mm_min, feed_mm_min_));
  PathPiece piece;
  piece.to_mm = target_of(block);
  piece.feed_mm_min = feed ? feed_mm_min_ : 0.0;
  piece.line = block.line;
  if (round) piece.arc = arc_of(block, piece.to_mm);
  check_axes(block, piece);
  place_mm_ = piece.to_mm;
  return piece;
}

std::optional<std::array<double, 2>> ProgramInterpreter::centre_of(const ProgramBlock& block,
                                                                   const Vector3& target_mm) const {
  const auto axes = axes_of(plane_);
  const std::size_t u = index_of(axes[0]);
  const std::size_t v = index_of(axes[1]);
  if (block.has_centre())
    return std::array{place_mm_[u] + block.centre_mm[u].value_or(0.0), place_mm_[v] + block.centre_mm[v].value_or(0.0)};
  const double along = target_mm[u] - place_mm_[u];
  const double across = target_mm[v] - place_mm_[v];
  const double chord_mm = std::hypot(along, across);
  const double radius_mm = std::abs(*block.radius_mm);
  if (chord_mm < 1e-6) {
    complain_(block.line, "R: a radius alone does not define a full circle; give its centre with I J K");
    return std::nullopt;
  }
  if (radius_mm < 0.5 * chord_mm - kArcMismatch_mm) {
    complain_(block.line, fmt::format("R: a radius of {} mm cannot span {:.4f} mm; expected at least {:.4f} mm",
                                      shortest(radius_mm), chord_mm, 0.5 * chord_mm));
    return std::nullopt;
  }
  const double height_mm = std::sqrt(std::max(0.0, radius_mm * radius_mm - 0.25 * chord_mm * chord_mm));
  const double left = (motion_ == ProgramMotion::counterclockwise) == (*block.radius_mm > 0.0) ? 1.0 : -1.0;
  return std::array{place_mm_[u] + 0.5 * along - left * height_mm * across / chord_mm,
                    place_mm_[v] + 0.5 * across + left * height_mm * along / chord_mm};
}

std::optional<ArcWay> ProgramInterpreter::arc_of(const ProgramBlock& block, const Vector3& target_mm) const {
  const auto axes = axes_of(plane_);
  const std::size_t u = index_of(axes[0]);
  const std::size_t v = index_of(axes[1]);
  const std::size_t third = index_of(axes[2]);
  const auto refused = [&](std::string message) {
    complain_(block.line, std::move(message));
    return std::nullopt;
  };
  if (target_mm[third] != place_mm_[third] || block.centre_mm[third])
    return refused(fmt::format("arc: expected {} and {} only, in the plane of G{}; a helix along {} is not supported",
                               letter_of(axes[0]), letter_of(axes[1]), 17 + static_cast<int>(plane_),
                               letter_of(axes[2])));
  if (block.has_centre() == block.radius_mm.has_value())
    return refused(block.radius_mm ? "arc: expected I J K or R, got both"
                                   : "arc: expected its centre I J K or its radius R");
  const auto centre = centre_of(block, target_mm);
  if (!centre) return std::nullopt;
  const double start_mm = std::hypot(place_mm_[u] - (*centre)[0], place_mm_[v] - (*centre)[1]);
  const double end_mm = std::hypot(target_mm[u] - (*centre)[0], target_mm[v] - (*centre)[1]);
  if (start_mm < kSmallestRadius_mm)
    return refused(
        fmt::format("arc: expected a radius of at least {} mm, got {:.6f} mm", kSmallestRadius_mm, start_mm));
  if (std::abs(start_mm - end_mm) > kArcMismatch_mm || end_mm < kSmallestRadius_mm)
    return refused(
        fmt::format("arc: its start lies {:.4f} mm from the centre, its end {:.4f} mm; expected them equal to {} mm",
                    start_mm, end_mm, kArcMismatch_mm));
  return ArcWay{plane_, *centre, motion_ == ProgramMotion::clockwise};
}

void ProgramInterpreter::check_range(int line, std::size_t axis, double low_mm, double high_mm) const {
  const auto [lowest_mm, highest_mm] = *range_[axis];
  const bool below = low_mm < lowest_mm;
  if (!below && high_mm <= highest_mm) return;
  complain_(line, fmt::format("{}: goes to {} mm; the axis can go from {} to {} mm, overtravel included",
                              letter_of(kAllAxes[axis]), shortest(below ? low_mm : high_mm), shortest(lowest_mm),
                              shortest(highest_mm)));
}

void ProgramInterpreter::check_axes(const ProgramBlock& block, const PathPiece& piece) const {
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (range_[a]) {
      if (block.target_mm[a]) check_range(block.line, a, piece.to_mm[a], piece.to_mm[a]);
    } else if (block.target_mm[a]) {
      complain_(block.line, fmt::format("{}: this machine has no such axis", letter_of(kAllAxes[a])));
    }
  }
  if (!piece.arc) return;
  const Arc arc = arc_between(place_mm_, piece.to_mm, *piece.arc);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t a = index_of(axes_of(plane_)[i]);
    const auto [low_mm, high_mm] = arc.range_mm(i);
    if (!range_[a])
      complain_(block.line, fmt::format("arc: this machine has no {}", letter_of(kAllAxes[a])));
    else
      check_range(block.line, a, low_mm, high_mm);
  }
}

namespace {

constexpr std::size_t kMissedLines = 100;  ///< that are reported

double length_mm(const Vector3& from_mm, const PathPiece& piece) {
  if (piece.arc) return arc_between(from_mm, piece.to_mm, *piece.arc).length_mm();
  return std::hypot(piece.to_mm[0] - from_mm[0], piece.to_mm[1] - from_mm[1], piece.to_mm[2] - from_mm[2]);
}

void count(ProgramSummary& summary, const ProgramStep& step, const Vector3& from_mm, const Vector3& to_mm) {
  if (step.motion) summary.path_mm += length_mm(from_mm, *step.motion);
  if (step.tool) summary.tools.try_emplace(*step.tool, step.line);
  if (step.trigger == ProgramTrigger::reading) {
    if (summary.readings++ == 0) summary.first_reading_mm = to_mm;
  } else if (step.trigger == ProgramTrigger::missed) {
    auto& lines = summary.missed_lines;
    if (lines.size() < kMissedLines && std::find(lines.begin(), lines.end(), step.line) == lines.end())
      lines.push_back(step.line);
  }
}

}  // namespace

Result<ProgramSummary> checked_program(const Program& program, const Vector3& start_mm, const ProgramRange& range) {
  std::map<int, std::string> wrong;  // the first that is wrong with each line
  ProgramInterpreter interpreter(program, start_mm, range,
                                 [&](int line, const std::string& message) { wrong.try_emplace(line, message); });
  ProgramSummary summary;
  Vector3 from_mm = start_mm;
  while (const auto step = interpreter.next()) {
    count(summary, *step, from_mm, interpreter.place_mm());
    from_mm = interpreter.place_mm();
    if (wrong.size() >= kProgramProblems) break;
  }
  summary.blocks = interpreter.executed();
  if (wrong.empty()) return summary;
  std::vector<Problem> problems;
  for (auto& [line, message] : wrong)
    problems.push_back({ProblemKind::bad_input, std::move(message), program.file, line, 0, {}});
  return tl::unexpected(folded(std::move(problems)));
}

}  // namespace ecs::emulator
