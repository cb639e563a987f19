// Linear propagation: the covariance of the error vector from the covariance along each curve (GUM 5.2.2, eq. 13).
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "volume/shapes.hpp"
#include "volume/uncertainty.hpp"

namespace ecs::volume {
namespace {

double product_of(const Shapes& a, const Shapes& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Covariance of two values read from one table.
double within_table(const CurveUncertainty& u, const laser::MapTable& table, const std::array<double, 2>& travel_mm,
                    double a_mm, double b_mm) {
  const TablePlace a = place_in(table, a_mm), b = place_in(table, b_mm);
  double shared = 0.0;  // Σ of the products of the weights that both give to one value
  for (const std::size_t i : {a.below, a.below + 1})
    for (const std::size_t j : {b.below, b.below + 1})
      if (i == j) shared += (i == a.below ? 1.0 - a.part : a.part) * (j == b.below ? 1.0 - b.part : b.part);
  double sum = u.value * u.value * shared;
  if (a.below == b.below) sum += u.between * u.between * a.bow() * b.bow();
  if (u.pass > 0.0) {
    const double heavy_tails = u.degrees_of_freedom / (u.degrees_of_freedom - 2.0);  // variance of Student's t
    sum += heavy_tails * u.pass * u.pass * product_of(shapes_at(travel_mm, a_mm), shapes_at(travel_mm, b_mm));
  }
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
Gains gains_at(const Kinematics& kinematics, const Vector3& position_mm) {
  Gains gains{};
  for (const Term& term : kinematics.terms) {
    ComponentValues one{};
    one[index_of(term.component)] = 1.0;
    TermTable alone;
    alone.rows[alone.count++] = term;
    const Vector3 error = tool_error_um(alone, one, position_mm, kinematics.lines_mm, kinematics.tool_offset_mm);
    for (std::size_t d = 0; d < kAxes; ++d) gains[index_of(term.component)][d] += error[d];
  }
  return gains;
}

void add_product(Covariance& sum, const Vector3& a, const Vector3& b, double weight) {
  for (std::size_t i = 0; i < kAxes; ++i)
    for (std::size_t j = 0; j < kAxes; ++j) sum[i][j] += weight * a[i] * b[j];
}

}  // namespace

Covariance covariance_at(const CompensatedMachine& machine, const UncertaintyBudget& budget, const Vector3& position_mm,
                         std::size_t side) {
  const Kinematics kinematics = errors_of_map(machine.map, machine.parameters, machine.tool_offset_mm).kinematics;
  const Vector3 reference_mm = reference_of(machine.parameters);
  const Gains here = gains_at(kinematics, position_mm), there = gains_at(kinematics, reference_mm);
  Covariance sum{};
  for (const CurveUncertainty& u : budget.curves) {
    if (u.value == 0.0 && u.pass == 0.0 && u.between == 0.0 && u.per_m == 0.0 && u.unmeasured == 0.0) continue;
    const std::size_t c = index_of(u.component);
    const CurveCovariance curve(machine, u);
    const Stop stop{position_mm[index_of(moving_axis(u.component))], side};
    const double with_reference = curve.with_reference(stop);
    add_product(sum, here[c], here[c], curve.of(stop, stop));
    add_product(sum, here[c], there[c], -with_reference);
    add_product(sum, there[c], here[c], -with_reference);
    add_product(sum, there[c], there[c], curve.of_reference());
  }
  for (std::size_t c = kCurves; c < kComponents; ++c) {
    Vector3 gain = here[c];
    for (std::size_t d = 0; d < kAxes; ++d) gain[d] -= there[c][d];
    add_product(sum, gain, gain, budget.squareness_um_per_m[c] * budget.squareness_um_per_m[c]);
  }
  return sum;
}

double linear_rms_um(const CompensatedMachine& machine, const UncertaintyBudget& budget, const Grid& grid) {
  double sum = 0.0;
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for (const double x : grid.mm[0])
      for (const double y : grid.mm[1])
        for (const double z : grid.mm[2]) {
          const Covariance c = covariance_at(machine, budget, {x, y, z}, side);
          sum += c[0][0] + c[1][1] + c[2][2];
        }
  return std::sqrt(sum / static_cast<double>(kSides.size() * grid.places()));
}

std::vector<double> uncertainties_of(const laser::MapTable& table, const CompensatedMachine& machine,
                                     const UncertaintyBudget& budget) {
  const CurveUncertainty& u = budget.curves[index_of(table.component)];
  std::vector<double> out;
  const auto& travel_mm = machine.travel_mm[index_of(moving_axis(table.component))];
  if (!travel_mm) return out;
  const CurveCovariance curve(machine, u);
  const std::size_t side = side_of(table.approach);
  for (const double p : table.position_mm) out.push_back(std::sqrt(curve.of({p, side}, {p, side})));
  return out;
}

}  // namespace ecs::volume
