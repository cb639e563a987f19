#include "app/cli/axis_argument.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::app {

Result<Axis> axis_named(std::string_view text) {
  for (const Axis axis : kAllAxes)
    if (lower(text) == lower(std::string(1, letter_of(axis)))) return axis;
  return problem(ProblemKind::usage, fmt::format("expected an axis X, Y or Z, got \"{}\"", text));
}

}  // namespace ecs::app
