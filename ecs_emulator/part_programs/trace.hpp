// The track of a running program, sample by sample, into a CSV file. Does not live here: who moves (run.hpp).
#pragma once

#include <filesystem>
#include <fstream>

#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {

/// Columns: time_s, line, then for each axis of the machine command_<axis>_mm, position_<axis>_mm (the carriage) and
/// compensation_<axis>_um, then ex_um, ey_um, ez_um: the tool against the workpiece, actual − commanded, without
/// scatter. The file appears whole under its name at the end; until then it is `<name>.part`.
class ProgramTrace {
 public:
  /// @param period_s  between samples; 0: every tick
  [[nodiscard]] static Result<ProgramTrace> open(const std::filesystem::path& path, double period_s,
                                                 const Simulation& simulation);
  ProgramTrace(ProgramTrace&& other) noexcept;
  ProgramTrace& operator=(ProgramTrace&&) = delete;
  /// An unfinished file is taken away.
  ~ProgramTrace();

  /// After every tick.
  void sample(Simulation& simulation);
  [[nodiscard]] Result<void> finish();

 private:
  ProgramTrace(std::filesystem::path path, double period_s);

  std::filesystem::path path_;  ///< empty: finished, or moved from
  std::filesystem::path part_;
  std::ofstream file_;
  double period_s_ = 0.0;
  double next_s_ = 0.0;
};

}  // namespace ecs::emulator
