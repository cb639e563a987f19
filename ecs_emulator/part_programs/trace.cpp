#include "ecs_emulator/part_programs/trace.hpp"

#include <cctype>

#include <fmt/format.h>

namespace ecs::emulator {
namespace {

std::string header_of(const MachineTool& machine) {
  std::string text = "time_s,line";
  for (const Axis a : kAllAxes) {
    if (!machine.has(a)) continue;
    const char name = static_cast<char>(std::tolower(letter_of(a)));
    text += fmt::format(",command_{0}_mm,position_{0}_mm,compensation_{0}_um", name);
  }
  return text + ",ex_um,ey_um,ez_um\n";
}

}  // namespace

ProgramTrace::ProgramTrace(std::filesystem::path path, double period_s)
    : path_(std::move(path)), part_(path_.string() + ".part"), file_(part_), period_s_(period_s) {}

ProgramTrace::ProgramTrace(ProgramTrace&& other) noexcept
    : path_(std::exchange(other.path_, {})),
      part_(std::move(other.part_)),
      file_(std::move(other.file_)),
      period_s_(other.period_s_),
      next_s_(other.next_s_) {}

ProgramTrace::~ProgramTrace() {
  if (path_.empty()) return;
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

Result<ProgramTrace> ProgramTrace::open(const std::filesystem::path& path, double period_s,
                                        const Simulation& simulation) {
  ProgramTrace trace(path, period_s);
  if (!(trace.file_ << header_of(simulation.machine())))
    return problem(ProblemKind::output, fmt::format("{}: cannot write", trace.part_.string()));
  trace.next_s_ = simulation.machine().time_s();
  return trace;
}

void ProgramTrace::sample(Simulation& simulation) {
  const MachineTool& machine = simulation.machine();
  if (machine.time_s() < next_s_ - 1e-9) return;
  next_s_ = std::max(next_s_ + period_s_, machine.time_s() - period_s_);
  const ToolPose pose = simulation.tool_at(machine.state(), machine.command_mm(), false);
  std::string row = fmt::format("{:.6f},{}", machine.time_s(), machine.path().line());
  for (const Axis a : kAllAxes)
    if (machine.has(a))
      row += fmt::format(",{:.10f},{:.10f},{:.4f}", machine.command_mm()[index_of(a)], machine.axis(a).position_mm(),
                         machine.axis(a).compensation_um());
  row += fmt::format(",{:.4f},{:.4f},{:.4f}\n", pose.error_um[0], pose.error_um[1], pose.error_um[2]);
  file_ << row;
}

Result<void> ProgramTrace::finish() {
  file_.close();
  std::error_code error;
  if (file_) std::filesystem::rename(part_, path_, error);
  if (!file_ || error) return problem(ProblemKind::output, fmt::format("{}: cannot write", path_.string()));
  path_.clear();
  return {};
}

}  // namespace ecs::emulator
