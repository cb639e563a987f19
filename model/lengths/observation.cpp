#include "model/lengths/observation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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
    if (out.zero.emplace(std::tuple(r.set_up, r.run, r.tool), out.end).second) ++out.end;
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

SharedNoise::SharedNoise(const LengthTest& test, const LengthMachine& machine) {
  std::map<std::tuple<std::size_t, int, std::size_t>, std::size_t> group;
  std::map<std::tuple<std::size_t, int, std::size_t>, std::size_t> last;
  int next = 0;
  for (std::size_t i = 0; i < test.readings.size(); ++i) {
    const LengthReading& r = test.readings[i];
    const auto name = std::tuple(r.set_up, r.run, r.tool);
    const bool begins = group.emplace(name, groups_.size()).second;
    if (begins) groups_.emplace_back();
    Key key;
    for (std::size_t a = 0; a < kAxes; ++a) {
      const auto& [low, high] = machine.travel_mm[a];
      key.part[a] = (r.position_mm[a] - low) / (high - low);
      key.stop[a] = key.pass[a] = ++next;
      if (begins) continue;
      const LengthReading& before = test.readings[last.at(name)];
      const double moved = r.position_mm[a] - before.position_mm[a];
      const bool turned = r.approach[a] != before.approach[a];
      if (moved == 0.0 && !turned) key.stop[a] = keys_[last.at(name)].stop[a];
      if (moved * r.approach[a] >= 0.0 && !turned) key.pass[a] = keys_[last.at(name)].pass[a];
      any_parked_ = any_parked_ || (moved == 0.0 && !turned);
    }
    groups_[group.at(name)].push_back(i);
    last[name] = i;
    keys_.push_back(key);
  }
}

/// The shape of a pass: mean square 1 over the travel, correlated over about a third of it.
double SharedNoise::covariance(std::size_t i, std::size_t k, double cosine, const NoiseRatios& ratios) const {
  double sum = 0.0;
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (keys_[i].stop[a] == keys_[k].stop[a]) sum += ratios.stop;
    if (ratios.pass > 0.0 && keys_[i].pass[a] == keys_[k].pass[a]) {
      constexpr double kCorrelated = 0.3;
      const double apart = (keys_[i].part[a] - keys_[k].part[a]) / kCorrelated;
      sum += ratios.pass * std::exp(-0.5 * apart * apart);
    }
  }
  return sum * cosine;
}

Eigen::MatrixXd SharedNoise::whitened(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& direction,
                                      const NoiseRatios& ratios, double* half_log_determinant) const {
  if (ratios.stop == 0.0 && ratios.pass == 0.0) return rows;
  Eigen::MatrixXd out(rows.rows(), rows.cols());
  for (const auto& group : groups_) {
    const auto m = static_cast<Eigen::Index>(group.size());
    Eigen::MatrixXd own(m, rows.cols()), covariance_matrix(m, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const auto r = static_cast<Eigen::Index>(group[static_cast<std::size_t>(i)]);
      own.row(i) = rows.row(r);
      for (Eigen::Index k = 0; k <= i; ++k) {
        const auto s = static_cast<Eigen::Index>(group[static_cast<std::size_t>(k)]);
        covariance_matrix(i, k) = covariance_matrix(k, i) =
            covariance(static_cast<std::size_t>(r), static_cast<std::size_t>(s), direction.row(r).dot(direction.row(s)),
                       ratios) +
            (i == k ? 1.0 : 0.0);
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance_matrix);
    factor.matrixL().solveInPlace(own);
    if (half_log_determinant != nullptr) *half_log_determinant += factor.matrixLLT().diagonal().array().log().sum();
    for (Eigen::Index i = 0; i < m; ++i)
      out.row(static_cast<Eigen::Index>(group[static_cast<std::size_t>(i)])) = own.row(i);
  }
  return out;
}

}  // namespace ecs::model
