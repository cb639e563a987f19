#include "model/held_out.hpp"

#include <cmath>
#include <set>

namespace ecs::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Parts parts_of(const Observations& data) {
  constexpr std::size_t kMostParts = 5;
  constexpr std::size_t kBlock = 4;
  Parts parts;
  const std::set<int> runs(data.run.begin(), data.run.end());
  parts.by_run = runs.size() >= 3;
  parts.count = parts.by_run ? std::min(runs.size(), kMostParts) : kMostParts;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const std::size_t number =
        parts.by_run ? static_cast<std::size_t>(std::distance(runs.begin(), runs.find(data.run[k]))) : k / kBlock;
    parts.of.push_back(number % parts.count);
  }
  return parts;
}

VectorXd least_squares(const MatrixXd& white, const VectorXd& target) {
  if (white.cols() == 0) return VectorXd(0);
  VectorXd norm = white.colwise().norm();
  for (Index j = 0; j < norm.size(); ++j) norm(j) = norm(j) > 0.0 ? 1.0 / norm(j) : 0.0;
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  qr.setThreshold(1e-7);
  qr.compute(white * norm.asDiagonal());
  return norm.asDiagonal() * VectorXd(qr.solve(target));
}

double held_out_rms(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                    const Parts& parts, const MatrixXd& columns, const VectorXd& target) {
  double sum = 0.0, count = 0.0;
  for (std::size_t part = 0; part < parts.count; ++part) {
    std::vector<bool> hidden = left_out;
    for (std::size_t k = 0; k < hidden.size(); ++k)
      if (parts.of[k] == part) hidden[k] = true;
    const Whitener whitener(data, noise, hidden);
    const VectorXd sizes = least_squares(whitener(columns), whitener(target));
    for (std::size_t k = 0; k < hidden.size(); ++k) {
      if (parts.of[k] != part || left_out[k]) continue;
      const auto at = static_cast<Index>(k);
      const double r = target(at) - (sizes.size() > 0 ? columns.row(at).dot(sizes) : 0.0);
      sum += r * r;
      count += 1.0;
    }
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

}  // namespace ecs::model
