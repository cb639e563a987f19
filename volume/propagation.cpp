// Linear propagation: the covariance of the error vector from the covariance along each curve (GUM 5.2.2, eq. 13).
#include <algorithm>
#include <cmath>

#include "volume/curve_covariance.hpp"

namespace ecs::volume {
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
