#include "ecs_emulator/errors/curve.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {

double ErrorCurve::value(const Variables& variables) const {
  if (formula) return formula->value();
  const double p_mm = variables.p;
  const auto side = [&](const CurvePoint& at) { return variables.d < 0.0 ? at.reverse : at.forward; };
  if (p_mm <= points.front().p_mm) return side(points.front());
  if (p_mm >= points.back().p_mm) return side(points.back());
  const auto above = std::upper_bound(points.begin(), points.end(), p_mm,
                                      [](double position, const CurvePoint& point) { return position < point.p_mm; });
  const auto below = above - 1;
  return std::lerp(side(*below), side(*above), (p_mm - below->p_mm) / (above->p_mm - below->p_mm));
}

}  // namespace ecs::emulator
