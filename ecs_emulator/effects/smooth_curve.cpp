#include "ecs_emulator/effects/smooth_curve.hpp"

#include <algorithm>
#include <cmath>

#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

/// Legendre polynomial of `degree` at `place` in −1 … 1, by Bonnet's recursion.
double legendre(std::size_t degree, double place) {
  double before = 1.0;
  double now = place;
  if (degree == 0) return before;
  for (std::size_t n = 1; n < degree; ++n) {
    const double k = static_cast<double>(n);
    const double next = ((2.0 * k + 1.0) * place * now - k * before) / (k + 1.0);
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

double value_at(const SmoothCurve& curve, double p_mm) {
  const double place = std::clamp(2.0 * (p_mm - curve.from_mm) / (curve.to_mm - curve.from_mm) - 1.0, -1.0, 1.0);
  double value = curve.mean + curve.slope * place;
  for (std::size_t k = 0; k < curve.waves.size(); ++k) value += curve.waves[k] * legendre(k + 2, place);
  return value;
}

/// Up to degree 5: nearer the ends a polynomial of higher degree turns faster than a curve of ten degrees of freedom.
SmoothCurve draw_curve(Random& random, const std::vector<double>& places_mm) {
  SmoothCurve curve;
  curve.from_mm = places_mm.front();
  curve.to_mm = places_mm.back();
  const int most = std::clamp(static_cast<int>(places_mm.size()) / 2 - 1, 1, 4);
  const int count = whole(random, std::min(2, most), most);
  const double roughness = between(random, 0.4, 1.2);
  for (int k = 0; k < count; ++k) curve.waves.push_back(random.normal() * std::pow(k + 1.0, -roughness));
  return curve;
}

}  // namespace ecs::emulator
