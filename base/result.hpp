// The one error type of the project: a Problem that says where, what was expected, what was found and what to do.
// Does not live here: how a problem is shown (app/).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <tl/expected.hpp>

namespace ecs {

/// What kind of thing went wrong; `ecs` turns it into its exit code (docs/design.md).
enum class ProblemKind {
  refused,    ///< the thing asked for does not hold: a check with findings, a refused map (exit 1)
  usage,      ///< the caller asked wrongly (exit 2)
  bad_input,  ///< a file or a value in it is wrong (exit 3)
  link,       ///< the line or the unit at its end (exit 4)
  output,     ///< cannot write, or an internal failure (exit 5)
};

/// One thing that went wrong, in words for the person who must correct it.
struct Problem {
  ProblemKind kind = ProblemKind::bad_input;
  std::string message;        ///< what was expected, what was found, what to do
  std::string file;           ///< empty: no file is to blame
  int line = 0;               ///< 1-based; 0: unknown
  int column = 0;             ///< 1-based; 0: unknown
  std::vector<Problem> also;  ///< further problems found in the same pass, in file order

  friend bool operator==(const Problem&, const Problem&) = default;
};

template <class T>
using Result = tl::expected<T, Problem>;

/// `return problem(ProblemKind::link, "…")` from any function that returns a Result.
[[nodiscard]] inline tl::unexpected<Problem> problem(ProblemKind kind, std::string message) {
  return tl::unexpected(Problem{kind, std::move(message), {}, 0, 0, {}});
}

/// The same with a format string and its arguments (fmt).
template <class First, class... Rest>
[[nodiscard]] tl::unexpected<Problem> problem(ProblemKind kind, fmt::format_string<First, Rest...> form, First&& first,
                                              Rest&&... rest) {
  return problem(kind, fmt::format(form, std::forward<First>(first), std::forward<Rest>(rest)...));
}

/// The same with the place in a file.
[[nodiscard]] inline tl::unexpected<Problem> problem_at(std::string file, int line, int column, std::string message) {
  return tl::unexpected(Problem{ProblemKind::bad_input, std::move(message), std::move(file), line, column, {}});
}
template <class First, class... Rest>
[[nodiscard]] tl::unexpected<Problem> problem_at(std::string file, int line, int column,
                                                 fmt::format_string<First, Rest...> form, First&& first,
                                                 Rest&&... rest) {
  return problem_at(std::move(file), line, column,
                    fmt::format(form, std::forward<First>(first), std::forward<Rest>(rest)...));
}

/// The value of a call that answers a Result, or the end of this function with its problem:
///     ECS_TRY(map, loaded_map(file));  // map is what the Result holds; it may be changed and moved from
#define ECS_TRY(value, ...)                                             \
  auto&& ecs_try_##value = (__VA_ARGS__);                               \
  if (!ecs_try_##value) return tl::unexpected(ecs_try_##value.error()); \
  auto& value = *ecs_try_##value
/// The same where the value does not matter.
#define ECS_DO(...)                                         \
  do {                                                      \
    const auto& ecs_done = (__VA_ARGS__);                   \
    if (!ecs_done) return tl::unexpected(ecs_done.error()); \
  } while (false)

/// Folds a list of problems into one: the first, with the others in `also`, each once.
/// @pre !problems.empty()
[[nodiscard]] Problem folded(std::vector<Problem> problems);

/// `file:line:column: message`, the others each on a line of their own.
[[nodiscard]] std::string to_text(const Problem& problem);

}  // namespace ecs
