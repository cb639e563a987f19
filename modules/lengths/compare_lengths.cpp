#include "modules/lengths/compare_lengths.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "modules/lengths/curves.hpp"
#include "modules/lengths/identify.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Error vector of the tool at every reading, as the map has it [um].
std::vector<Vector3d> errors_by(const LengthTest& test, const laser::ErrorMap& map, const UnitParameters& parameters) {
  const TermTable terms = *ecs::terms_of(*chain_of(parameters), parameters.convention, CurveKind::measured);
  std::vector<Vector3d> errors;
  for (const LengthReading& r : test.readings) {
    ComponentValues values{};
    for (std::size_t c = 0; c < kComponents; ++c) {
      const auto component = static_cast<Component>(c);
      if (is_squareness(component)) {
        values[c] = squareness_um_per_m(parameters, component);
        continue;
      }
      const std::size_t axis = index_of(moving_axis(component));
      const Approach approach = r.approach[axis] > 0 ? Approach::forward : Approach::reverse;
      const laser::MapTable* table = laser::table_of(map, component, approach);
      if (table == nullptr || table->position_mm.empty()) continue;
      values[c] = -laser::compensation_at(*table, r.position_mm[axis]);
      if (is_angular(component)) values[c] *= parameters.angular_scale;
    }
    errors.push_back(eigen(
        tool_error_um(terms, values, r.position_mm, parameters.measurement_lines_mm, test.tools[r.tool].offset_mm)));
  }
  return errors;
}

struct FittedZeros {
  Eigen::VectorXd residual_um, unknowns;
  Index rank = 0;
};

/// Lengths less those of a machine with these errors; what the instrument does not state is fitted (Gauss and Newton).
FittedZeros fitted_zeros(const LengthTest& test, const std::vector<Vector3d>& errors_um,
                         const NuisanceColumns& nuisance) {
  std::map<std::size_t, Vector3d> first_mm;  // of a placement of points
  constexpr int kSteps = 5;  // stations are millimetres off at distances of hundreds: quadratic convergence
  const auto n = static_cast<Index>(test.readings.size());
  FittedZeros fit{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(nuisance.end), 0};
  for (int step = 0; step <= kSteps; ++step) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(n, nuisance.end);
    for (Index i = 0; i < n; ++i) {
      const LengthReading& r = test.readings[static_cast<std::size_t>(i)];
      const LengthSetUp& set_up = test.set_ups[r.set_up];
      const Vector3d& error_um = errors_um[static_cast<std::size_t>(i)];
      double length_um = 0.0;
      if (set_up.instrument == LengthInstrument::points) {
        const Vector3d point_mm = eigen(point_of(test, r));
        const PlacementRows rigid =
            placement_rows(r.along, point_mm, first_mm.emplace(r.set_up, point_mm).first->second);
        const Index station = nuisance.station.at({r.set_up, r.tool}), turn = nuisance.rotation.at(r.set_up);
        columns.row(i).segment<3>(station) = rigid.translation;
        columns.row(i).segment<3>(turn) = rigid.rotation;
        fit.residual_um(i) = r.deviation_um - eigen(r.along).dot(error_um) - columns.row(i).dot(fit.unknowns);
        continue;
      }
      if (set_up.instrument == LengthInstrument::interferometer) {
        length_um = eigen(set_up.place).dot(error_um);
      } else {
        const Index station = nuisance.station.at({r.set_up, r.tool});
        const Vector3d nominal_mm = eigen(point_of(test, r)) - eigen(set_up.place);
        const Vector3d actual_mm = nominal_mm + (error_um - fit.unknowns.segment<3>(station)) / kUmPerMm;
        length_um = (actual_mm.norm() - nominal_mm.norm()) * kUmPerMm;
        columns.row(i).segment<3>(station) = -actual_mm.normalized().transpose();
      }
      const Index zero = nuisance.zero.at({r.set_up, r.run, r.tool});
      columns(i, zero) = 1.0;
      fit.residual_um(i) = r.deviation_um - length_um - fit.unknowns(zero);
    }
    const PivotedQr qr(columns);
    fit.rank = qr.rank();
    if (step < kSteps) fit.unknowns += qr.solve(fit.residual_um);
  }
  return fit;
}

double rms(const Eigen::VectorXd& residual, const std::vector<Index>& rows) {
  double squares = 0.0;
  for (const Index i : rows) squares += residual(i) * residual(i);
  return std::sqrt(squares / static_cast<double>(rows.size()));
}

}  // namespace

Result<LengthComparison> compared_lengths(const LengthTest& test, const laser::ErrorMap& map,
                                          const UnitParameters& parameters, std::size_t worst) {
  const NuisanceColumns nuisance = nuisance_of(test, 0);
  const auto n = static_cast<Index>(test.readings.size());
  const FittedZeros without =
      fitted_zeros(test, std::vector<Vector3d>(test.readings.size(), Vector3d::Zero()), nuisance);
  const FittedZeros with = fitted_zeros(test, errors_by(test, map, parameters), nuisance);
  if (n <= without.rank)
    return problem_at(test.source, 0, 0,
                      "expected more lengths than unknown zeros and stations, found {} lengths and {} "
                      "unknowns: measure more lengths in each run",
                      n, without.rank);
  LengthComparison found;
  found.readings = test.readings.size();
  found.unknowns = static_cast<int>(without.rank);
  found.error_um = without.residual_um.norm() / std::sqrt(static_cast<double>(n - without.rank));
  found.left_um = with.residual_um.norm() / std::sqrt(static_cast<double>(n - with.rank));
  found.repeat_um = repeats_of(test);
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Index>> rows_of;
  for (Index i = 0; i < n; ++i) {
    const LengthReading& r = test.readings[static_cast<std::size_t>(i)];
    rows_of[{r.set_up, r.tool}].push_back(i);
  }
  for (const auto& [where, rows] : rows_of) {
    ComparedSetUp set_up{test.set_ups[where.first].name, test.tools[where.second].name, rows.size(),
                         rms(without.residual_um, rows), rms(with.residual_um, rows),   {}};
    if (const auto station = nuisance.station.find(where); station != nuisance.station.end())
      for (std::size_t a = 0; a < kAxes; ++a)
        set_up.station_correction_mm[a] = with.unknowns(station->second + static_cast<Index>(a)) / kUmPerMm;
    found.set_ups.push_back(std::move(set_up));
  }
  std::vector<Index> order(test.readings.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](Index i) { return std::abs(with.residual_um(i)); });
  order.resize(std::min(order.size(), worst));
  for (const Index i : order)
    found.worst.push_back(
        {test.readings[static_cast<std::size_t>(i)].line, without.residual_um(i), with.residual_um(i)});
  return found;
}

}  // namespace ecs::model
