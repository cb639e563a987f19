// Covariances along one curve of a map (GUM 5.2.2, eq. 13), for .cpp files of this folder: where a coordinate lies on
// the curve (between which values, and on the smooth shapes along the travel), and the noise of a table from its own
// roughness. Does not live here: how large they are (uncertainty.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/units.hpp"
#include "laser/map/error_map.hpp"
#include "volume/field.hpp"
#include "volume/uncertainty.hpp"

namespace ecs::volume {

/// Standard deviation of independent noise from third differences (J. von Neumann et al., Ann. Math. Stat. 12 (1941)
/// 153, for first differences); their median, so that a bend of the curve does not count as noise.
[[nodiscard]] double roughness_of(const std::vector<double>& values);

/// Smooth shapes of mean square 1 together: an offset (half), a straight line (a quarter), one and two waves along the
/// travel (a quarter).
using Shapes = std::array<double, 6>;
[[nodiscard]] inline Shapes shapes_at(const std::array<double, 2>& travel_mm, double position_mm) {
  const double t = (position_mm - travel_mm[0]) / (travel_mm[1] - travel_mm[0]);
  const double turn = 2.0 * std::numbers::pi * t, wave = std::sqrt(0.125);
  return {std::sqrt(0.5),        std::sqrt(0.75) * (2.0 * t - 1.0), wave * std::cos(turn),
          wave * std::sin(turn), wave * std::cos(2.0 * turn),       wave * std::sin(2.0 * turn)};
}

/// Place between two values of a table.
struct TablePlace {
  std::size_t below = 0;
  double part = 0.0;  ///< of the way to the next value
  /// Of the bow between the two: 1 midway.
  [[nodiscard]] double bow() const { return 4.0 * part * (1.0 - part); }
};
[[nodiscard]] inline TablePlace place_in(const laser::MapTable& table, double position_mm) {
  const auto& p = table.position_mm;
  if (p.size() < 2 || position_mm <= p.front()) return {};
  const auto next = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), position_mm) - p.begin());
  if (next == p.size()) return {p.size() - 2, 1.0};
  return {next - 1, (position_mm - p[next - 1]) / (p[next] - p[next - 1])};
}

inline double product_of(const Shapes& a, const Shapes& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Covariance of two values read from one table.
inline double within_table(const CurveUncertainty& u, const laser::MapTable& table,
                           const std::array<double, 2>& travel_mm, double a_mm, double b_mm) {
  const TablePlace a = place_in(table, a_mm), b = place_in(table, b_mm);
  double shared = 0.0;  // Σ of the products of the weights that both give to one value
  for (const std::size_t i : {a.below, a.below + 1})
    for (const std::size_t j : {b.below, b.below + 1})
      if (i == j) shared += (i == a.below ? 1.0 - a.part : a.part) * (j == b.below ? 1.0 - b.part : b.part);
  double sum = u.value * u.value * shared;
  if (a.below == b.below) sum += u.between * u.between * a.bow() * b.bow();
  if (u.pass > 0.0) sum += u.pass * u.pass * product_of(shapes_at(travel_mm, a_mm), shapes_at(travel_mm, b_mm));
  return sum;
}

/// A coordinate of an axis, and the side from which it was reached.
struct Stop {
  double mm = 0.0;
  std::size_t side = 1;
};

class CurveCovariance {
 public:
  CurveCovariance(const CompensatedMachine& machine, const CurveUncertainty& u)
      : u_(u),
        travel_mm_(*machine.travel_mm[index_of(moving_axis(u.component))]),
        reference_mm_(reference_of(machine.parameters)[index_of(moving_axis(u.component))]) {
    for (std::size_t side = 0; side < kSides.size(); ++side)
      table_[side] = table_of(machine.map, u.component, kSides[side]);
  }

  [[nodiscard]] double of(const Stop& a, const Stop& b) const {
    double sum = u_.per_m * u_.per_m * (a.mm - reference_mm_) * (b.mm - reference_mm_) / (kMmPerM * kMmPerM);
    if (u_.unmeasured > 0.0)
      sum += u_.unmeasured * u_.unmeasured * product_of(shapes_at(travel_mm_, a.mm), shapes_at(travel_mm_, b.mm));
    const laser::MapTable* table = table_[a.side];
    if (table == nullptr || table != table_[b.side] || table->position_mm.empty()) return sum;
    return sum + within_table(u_, *table, travel_mm_, a.mm, b.mm);
  }
  /// With the mean of both sides at the reference.
  [[nodiscard]] double with_reference(const Stop& a) const {
    return 0.5 * (of(a, {reference_mm_, 0}) + of(a, {reference_mm_, 1}));
  }
  [[nodiscard]] double of_reference() const {
    return 0.5 * (with_reference({reference_mm_, 0}) + with_reference({reference_mm_, 1}));
  }

 private:
  const CurveUncertainty& u_;
  std::array<double, 2> travel_mm_;
  double reference_mm_;
  std::array<const laser::MapTable*, 2> table_{};
};

/// How each component acts at the tool at a place: E_d = Σ gain[component][d] · value.
using Gains = std::array<Vector3, kComponents>;
[[nodiscard]] Gains gains_at(const Kinematics& kinematics, const Vector3& position_mm);

void add_product(Covariance& sum, const Vector3& a, const Vector3& b, double weight);

/// Of a value at a place less that at the reference, which act by `here` and `there`.
struct DifferenceCovariance {
  double at_place = 0.0, with_reference = 0.0, of_reference = 0.0;
};
void add_difference(Covariance& sum, const Vector3& here, const Vector3& there, const DifferenceCovariance& of);
[[nodiscard]] inline DifferenceCovariance difference_of(const CurveCovariance& curve, const Stop& stop) {
  return {curve.of(stop, stop), curve.with_reference(stop), curve.of_reference()};
}
[[nodiscard]] bool is_certain(const CurveUncertainty& u);

/// The square of the length.
[[nodiscard]] inline double square_of(const Vector3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// What 95 % and 50 % of the draws do not exceed; nothing changes without draws.
void set_bounds(VolumeUncertainty& out, const std::vector<double>& largest, const std::vector<double>& rms);

}  // namespace ecs::volume
