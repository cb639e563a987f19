#include <algorithm>
#include <cmath>
#include <map>

#include "ecs_emulator/part_programs/interpreter.hpp"

namespace ecs::emulator {
namespace {

constexpr std::size_t kMissedLines = 100;  ///< that are reported

double length_mm(const Vector3& from_mm, const PathPiece& piece) {
  if (piece.arc) return arc_between(from_mm, piece.to_mm, *piece.arc).length_mm();
  return std::hypot(piece.to_mm[0] - from_mm[0], piece.to_mm[1] - from_mm[1], piece.to_mm[2] - from_mm[2]);
}

void count(ProgramSummary& summary, const ProgramStep& step, const Vector3& from_mm, const Vector3& to_mm) {
  if (step.motion) summary.path_mm += length_mm(from_mm, *step.motion);
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
                                 [&](int line, std::string message) { wrong.try_emplace(line, std::move(message)); });
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
