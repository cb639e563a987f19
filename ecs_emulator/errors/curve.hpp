// A curve over an axis as the errors file gives it: a formula, or points with a value for each approach.
// Does not live here: which component it belongs to (parts.hpp), its notation in the file (reader.hpp).
#pragma once

#include <optional>
#include <vector>

#include "ecs_emulator/errors/formula.hpp"

namespace ecs::emulator {

struct CurvePoint {
  double p_mm = 0.0;
  double forward = 0.0;
  double reverse = 0.0;
};

/// Either a formula or at least one point, ascending.
struct ErrorCurve {
  std::optional<Formula> formula;
  std::vector<CurvePoint> points;
  /// At the formula's variables as they stand, or at their p and d: linear between points, the end points hold.
  [[nodiscard]] double value(const Variables& variables) const;
};

}  // namespace ecs::emulator
