// What forms and choosers propose: the files that were opened or saved last, kept from one run of the program to the
// next, and where the measurements before and after compensation lie.
#pragma once

#include <string>
#include <vector>

namespace ecs::commissioning {

/// Puts it first. What cannot be written is not remembered. @param path  made absolute
void remember_file(const std::string& path);
/// Absolute paths that still exist, the newest first.
[[nodiscard]] std::vector<std::string> recent_files();

struct MeasuredPhases {
  std::string plan;    ///< file
  std::string before;  ///< folder; empty: not known
  std::string after;   ///< folder
};

/// Kept as long as the program runs.
void remember_measured_phases(const MeasuredPhases& phases);
/// Those remembered last; empty: none.
[[nodiscard]] MeasuredPhases measured_phases();

}  // namespace ecs::commissioning
