// Another program run to its end: what it says on stdout.
// Does not live here: programs that stay (commissioning/link/emulator_process.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs {

struct ChildWords {
  std::string_view name;          ///< in problems
  std::string_view when_missing;  ///< what to do then
  double limit_s = 60.0;          ///< then it is killed, as when a signal comes
};

/// What the program says on stdout. An `output` problem where it is not found, does not end in time, says nothing or
/// fails: then with what it said on stderr.
/// @param words  the program, by its path or from PATH, and its arguments  @param input  its stdin
[[nodiscard]] Result<std::string> output_of(std::vector<std::string> words, std::string_view input,
                                            const ChildWords& child);

}  // namespace ecs
