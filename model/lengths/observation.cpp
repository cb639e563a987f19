#include "model/lengths/observation.hpp"

#include <cmath>

#include "base/units.hpp"

namespace ecs::model {
namespace {

Eigen::Vector3d eigen(const Vector3& v) { return {v[0], v[1], v[2]}; }

}  // namespace

NuisanceColumns nuisance_of(const LengthTest& test, Eigen::Index first) {
  NuisanceColumns out;
  out.first = out.end = first;
  for (const LengthReading& r : test.readings) {
    if (test.set_ups[r.set_up].instrument != LengthInstrument::interferometer &&
        out.station.emplace(std::pair(r.set_up, r.tool), out.end).second)
      out.end += 3;
    const bool of_bar = test.bar_um && test.set_ups[r.set_up].instrument == LengthInstrument::ball_bar;
    if (of_bar && !out.bar) out.bar = out.end++;
    if (out.zero.emplace(std::tuple(r.set_up, r.run, r.tool), of_bar ? *out.bar : out.end).second && !of_bar) ++out.end;
    if (out.scale.emplace(r.set_up, out.end).second) ++out.end;
  }
  return out;
}

Linearised linearised(const LengthTest& test, const MachineCurves& curves, const NuisanceColumns& nuisance,
                      const Eigen::VectorXd& values) {
  const auto n = static_cast<Eigen::Index>(test.readings.size());
  Linearised out{Eigen::MatrixXd::Zero(n, nuisance.end), Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, 3)};
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Vector3d> first_point;
  for (Eigen::Index i = 0; i < n; ++i) {
    const LengthReading& r = test.readings[static_cast<std::size_t>(i)];
    const LengthSetUp& set_up = test.set_ups[r.set_up];
    const Eigen::MatrixXd error = curves.error_rows(r.position_mm, r.approach, test.tools[r.tool].offset_mm);
    const Eigen::Vector3d point = eigen(point_of(test, r));
    Eigen::Vector3d along;
    double metres = 0.0;
    if (set_up.instrument == LengthInstrument::interferometer) {
      along = eigen(set_up.place);
      const auto first = first_point.emplace(std::pair(r.set_up, r.tool), point).first->second;
      metres = (point - first).dot(along) / kMmPerM;
      out.nominal_um(i) = along.dot(error * values.head(curves.size()));
    } else {
      const Eigen::Index station = nuisance.station.at({r.set_up, r.tool});
      const Eigen::Vector3d nominal = point - eigen(set_up.place);
      const Eigen::Vector3d actual =
          nominal + (error * values.head(curves.size()) - values.segment(station, 3)) / kUmPerMm;
      along = actual.normalized();
      metres = nominal.norm() / kMmPerM;
      out.nominal_um(i) = (actual.norm() - nominal.norm()) * kUmPerMm;
      out.columns.row(i).segment(station, 3) = -along.transpose();
    }
    out.direction.row(i) = along.transpose();
    out.columns.row(i).head(curves.size()) = along.transpose() * error;
    const Eigen::Index zero = nuisance.zero.at({r.set_up, r.run, r.tool}), scale = nuisance.scale.at(r.set_up);
    out.columns(i, zero) = 1.0;
    out.columns(i, scale) = metres;
    out.nominal_um(i) += values(zero) + metres * values(scale);
  }
  return out;
}

}  // namespace ecs::model
