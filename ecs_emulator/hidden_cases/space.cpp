#include "ecs_emulator/hidden_cases/space.hpp"

#include <cmath>

#include "ecs_emulator/effects/places.hpp"
#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/effects/shape.hpp"

namespace ecs::emulator {
namespace {

constexpr double kSmallStep = 1e-4;  ///< of a parameter, for a slope
constexpr double kNothing = 1e-7;    ///< of its size: what is left of a column that is absorbed already

double distance(const Eigen::MatrixXd& left_columns, const Eigen::VectorXd& left, const EffectDefinition& kind) {
  if (kind.fixed_size) return (left - left_columns.col(0)).norm();
  if (left_columns.cols() == 1) {
    const double length2 = left_columns.col(0).squaredNorm();
    const double coefficient = left_columns.col(0).dot(left) / length2;
    if (has_one_sign(kind) && coefficient < 0.0) return left.norm();
    return (left - coefficient * left_columns.col(0)).norm();
  }
  Absorbed own(static_cast<std::size_t>(left.size()));
  own.add(left_columns);
  return own.left_of(left).norm();
}

}  // namespace

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double rms_of(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

Eigen::MatrixXd contribution_columns(const Scene& scene, const Ground& ground, const PlacedEffect& effect) {
  const auto units = unit_effects(ground, effect);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), static_cast<Eigen::Index>(units.size()));
  for (std::size_t k = 0; k < units.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = vector_of(contribution(scene, units[k]));
  return columns;
}

Eigen::MatrixXd slope_columns(const Scene& scene, const PlacedEffect& effect) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), 0);
  for (const ParameterDefinition& parameter : effect.kind->parameters) {
    if (parameter.search == nullptr) continue;
    const auto at = [&](double factor) {
      PlacedEffect moved = effect;
      moved.parameters[std::string(parameter.name)] *= factor;
      return vector_of(contribution(scene, moved));
    };
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols(1) = at(1.0 + kSmallStep) - at(1.0 - kSmallStep);
  }
  return columns;
}

void Absorbed::add(const Eigen::MatrixXd& columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double size = columns.col(k).norm();
    if (!(size > 0.0)) continue;
    Eigen::VectorXd left = columns.col(k) / size;
    for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
    if (left.norm() < kNothing) continue;
    basis_.conservativeResize(Eigen::NoChange, basis_.cols() + 1);
    basis_.col(basis_.cols() - 1) = left.normalized();
  }
}

Eigen::MatrixXd Absorbed::left_of(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = columns;
  for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
  for (Eigen::Index k = 0; k < left.cols(); ++k)
    if (left.col(k).norm() < kNothing * columns.col(k).norm()) left.col(k).setZero();
  return left;
}

Eigen::VectorXd Absorbed::left_of(const Eigen::VectorXd& values) const {
  Eigen::VectorXd left = values;
  for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
  return left;
}

std::vector<Rival> rivals_of(const Scene& scene, const Ground& ground, const Absorbed& absorbed,
                             const Eigen::VectorXd& hidden, double sigma_um, bool flexible,
                             const std::function<bool(const Rival&)>& enough) {
  const Eigen::VectorXd left = absorbed.left_of(hidden);
  std::vector<Rival> rivals;
  for (const EffectDefinition* kind : effects()) {
    if (is_flexible(*kind) && !flexible) continue;
    for (const PlacedEffect& place : possible_places(scene, ground, *kind)) {
      Rival rival{place, left.norm() / sigma_um, 0.0, is_flexible(*kind)};
      for (const PlacedEffect& trial : trials_of(scene, ground, place)) {
        const Eigen::MatrixXd columns = contribution_columns(scene, ground, trial);
        if (columns.cols() == 0) continue;
        const Eigen::MatrixXd left_columns = absorbed.left_of(columns);
        if (left_columns.norm() == 0.0) continue;
        const double separation = distance(left_columns, left, *kind) / sigma_um;
        if (separation < rival.separation) {
          rival.separation = separation;
          rival.effect = trial;
          rival.size =
              left_columns.cols() == 1 ? left_columns.col(0).dot(left) / left_columns.col(0).squaredNorm() : 1.0;
        }
      }
      rivals.push_back(rival);
      if (enough && enough(rival)) return rivals;
    }
  }
  return rivals;
}

}  // namespace ecs::emulator
