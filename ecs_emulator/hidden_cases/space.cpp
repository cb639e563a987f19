#include "ecs_emulator/hidden_cases/space.hpp"

#include <cmath>

namespace ecs::emulator {
namespace {

constexpr double kNothing = 1e-7;  ///< of its size: what is left of a column that is absorbed already

bool is_flexible(EffectKind kind) {
  return kind == EffectKind::progressive || kind == EffectKind::reversal_curve || kind == EffectKind::angular ||
         kind == EffectKind::cyclic || kind == EffectKind::step || kind == EffectKind::warm_up ||
         kind == EffectKind::reversal_spike || kind == EffectKind::map_shift;
}

/// Values at which to try a nonlinear parameter.
std::vector<PlacedEffect> trials_of(const Scene& scene, const Ground& ground, PlacedEffect effect) {
  const auto with = [&](const char* name, const std::vector<double>& values) {
    std::vector<PlacedEffect> trials;
    for (const double value : values) {
      effect.parameters[name] = value;
      trials.push_back(effect);
    }
    return trials;
  };
  std::vector<double> values;
  switch (effect.kind) {
    case EffectKind::step: {
      const auto& places = ground.cover(*effect.sense, *effect.axis).places_mm;
      for (std::size_t k = 1; k < places.size(); ++k) values.push_back(0.5 * (places[k - 1] + places[k]));
      return with("position_mm", values);
    }
    case EffectKind::cyclic: {
      const auto& places = ground.cover(*effect.sense, *effect.axis).places_mm;
      const double length_mm = places.back() - places.front();
      const double most = std::min(60.0, static_cast<double>(places.size()) / 2.0);
      for (double waves = 1.0; waves < most; waves *= 1.0 + 0.2 / (waves + 1.0)) values.push_back(length_mm / waves);
      return with("period_mm", values);
    }
    case EffectKind::warm_up:
      for (const double part : {0.03, 0.08, 0.2, 0.4, 0.8, 2.0}) values.push_back(part * scene.stops.back().time_s);
      return with("tau_s", values);
    case EffectKind::reversal_spike:
      return with("u0_mm", {3.0, 8.0, 20.0, 50.0, 150.0, 500.0, 2000.0});
    case EffectKind::map_shift:
      return with("shift_mm", {-50.0, -20.0, -5.0, 5.0, 20.0, 50.0});
    case EffectKind::map_gain:
      return with("gain", {2.0});
    case EffectKind::map_polarity:
      return with("fraction", {1.0});
    default:
      return {effect};
  }
}

/// Of fixed size: it fits as it is or not at all.
bool has_fixed_size(EffectKind kind) { return is_map_fault(kind) && kind != EffectKind::map_gain; }

double distance(const Eigen::MatrixXd& left_columns, const Eigen::VectorXd& left, EffectKind kind) {
  if (has_fixed_size(kind)) return (left - left_columns.col(0)).norm();
  if (left_columns.cols() == 1) {
    const double length2 = left_columns.col(0).squaredNorm();
    const double coefficient = left_columns.col(0).dot(left) / length2;
    if (kind == EffectKind::cosine && coefficient < 0.0) return left.norm();
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

Eigen::MatrixXd columns_of(const Scene& scene, const Ground& ground, const PlacedEffect& effect) {
  const auto units = unit_effects(ground, effect);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), static_cast<Eigen::Index>(units.size()));
  for (std::size_t k = 0; k < units.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = vector_of(contribution(scene, units[k]));
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
  for (std::size_t kind = 0; kind < kEffectKinds; ++kind) {
    const auto effect_kind = static_cast<EffectKind>(kind);
    if (is_flexible(effect_kind) && !flexible) continue;
    for (const PlacedEffect& place : possible_places(scene, ground, effect_kind)) {
      Rival rival{place, left.norm() / sigma_um, 0.0, is_flexible(effect_kind)};
      for (const PlacedEffect& trial : trials_of(scene, ground, place)) {
        const Eigen::MatrixXd columns = columns_of(scene, ground, trial);
        if (columns.cols() == 0) continue;
        const Eigen::MatrixXd left_columns = absorbed.left_of(columns);
        if (left_columns.norm() == 0.0) continue;
        const double separation = distance(left_columns, left, effect_kind) / sigma_um;
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
