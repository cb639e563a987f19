// Smooth curves over a travel: Legendre polynomials in the order of their roughness at the targets, natural cubic
// splines between them, with mean and slope over the measured positions removed. A polynomial of high degree swings
// between the outer targets (Runge 1901) where nothing was measured: a map made from it would put errors there.
// Does not live here: how many of them a fit may use (model/regression/regressors.hpp).
#pragma once

#include <cstddef>
#include <vector>

namespace ecs::model {

/// On so few targets a curve, of about ten degrees of freedom beside mean and slope (docs/physics.md), is free at every
/// one; what else has a shape there has to be better than values of their own, and so few lengths show no shape.
inline constexpr std::size_t kFreeTargets = 12;

/// Polynomial of degree order + 1 (order 1, 2, …; as many zero crossings) at `place` in 0 … 1. Root mean square 1.
[[nodiscard]] double smooth_shape(std::size_t order, double place);

class CurveBasis {
 public:
  CurveBasis() = default;
  /// @param positions_mm  measured positions, one per reading, in any order
  /// @param most          functions wanted; fewer where the positions are too few to hold them
  /// @param apart         something else than its smoothness tells the curve from the rest: it may be free at every
  /// position
  CurveBasis(const std::vector<double>& positions_mm, std::size_t most, bool apart = false);

  [[nodiscard]] std::size_t size() const { return mean_.size(); }
  /// Function k at a position; beyond the measured travel the end value holds.
  [[nodiscard]] double value(std::size_t k, double position_mm) const;
  [[nodiscard]] double least_mm() const { return least_mm_; }
  [[nodiscard]] double greatest_mm() const { return greatest_mm_; }
  [[nodiscard]] double centre_mm() const { return centre_mm_; }
  [[nodiscard]] double half_width_mm() const;

 private:
  /// Shape k between the targets.
  [[nodiscard]] double spline(std::size_t k, double position_mm) const;

  double least_mm_ = 0.0;
  double greatest_mm_ = 0.0;
  double centre_mm_ = 0.0;
  std::vector<double> targets_mm_;           ///< ascending
  std::vector<std::vector<double>> shape_;   ///< at the targets
  std::vector<std::vector<double>> second_;  ///< derivative at the targets, per mm^2
  std::vector<double> mean_;                 ///< of each shape over the measured positions
  std::vector<double> slope_;                ///< of each shape, per mm
};

/// The different values, ascending, those closer than `tolerance` merged.
[[nodiscard]] std::vector<double> distinct(std::vector<double> values, double tolerance);

}  // namespace ecs::model
