// What a verb answers with, and the exit codes of the program.
// Does not live here: how it is shown (app/cli/console.hpp), how JSON is made (json.hpp).
#pragma once

#include <string>

#include "base/result.hpp"

namespace ecs {

/// The answer of a verb that ran to its end. `text` goes to stdout without --json, `json` (one object) with it.
/// A verb that printed as it went leaves both empty.
struct Outcome {
  std::string text;
  std::string json;
  int exit_code = 0;      ///< 1: the thing asked for does not hold; the answer is still a result
  bool finished = false;  ///< a signal that came meanwhile has left nothing undone: it does not make the exit code
};

inline constexpr int kDone = 0;
inline constexpr int kDoesNotHold = 1;

/// refused 1, usage 2, bad_input 3, link 4, output 5.
[[nodiscard]] constexpr int exit_code_of(ProblemKind kind) {
  switch (kind) {
    case ProblemKind::refused:
      return kDoesNotHold;
    case ProblemKind::usage:
      return 2;
    case ProblemKind::bad_input:
      return 3;
    case ProblemKind::link:
      return 4;
    case ProblemKind::output:
      break;
  }
  return 5;
}

}  // namespace ecs
