// Which simple shape the means of a residual over one variable have, and whether the data prove it. Internal to model/
// (Eigen). Does not live here: the means, and the words for a shape (shape.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Dense>

namespace ecs::model {

/// Points below which no shape is looked for: four free parameters and as many to refute them.
inline constexpr std::size_t kFewestPoints = 8;

/// Means of a residual over places from 0 to 1.
struct Points {
  std::vector<double> place, mean, sigma;  ///< sigma of the mean
  double from = 0.0, to = 1.0;             ///< of the variable
  [[nodiscard]] std::size_t size() const { return mean.size(); }
  [[nodiscard]] double at(double place_of) const { return from + (to - from) * place_of; }
};

enum class ShapeKind { line, curve, jump, bump, wave, chirp, fading_wave };

struct ShapeFit {
  ShapeKind kind = ShapeKind::line;
  double left = 0.0;  ///< weighted squares
  double parameters = 1.0;
  double first = 0.0, second = 0.0;  ///< place; waves at both ends; sizes at both ends
  double waves = 0.0;
  double size = 0.0;
  Eigen::Vector3d sizes = Eigen::Vector3d::Zero();  ///< of a wave: mean, sine, cosine
  [[nodiscard]] double criterion(const Points& points) const {
    const double n = static_cast<double>(points.size());
    return n * std::log(std::max(left, n) / n) + parameters * std::log(n);
  }
};

/// The shape that explains most of what is above noise, where no other does nearly as well; none if the data prove none
/// or it is the limit of another shape.
[[nodiscard]] std::optional<ShapeFit> proved_shape(const Points& points);

/// The best wave of one period and size.
[[nodiscard]] ShapeFit wave_in(const Points& points);
/// The means with that wave taken off.
[[nodiscard]] std::vector<double> means_without(const Points& points, const ShapeFit& wave);
/// Weighted squares about their common mean.
[[nodiscard]] double squares_about_mean(const Points& points);

}  // namespace ecs::model
