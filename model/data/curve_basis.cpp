// Natural cubic splines through values at given places: de Boor, A Practical Guide to Splines, chapter IV.
#include "model/data/curve_basis.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::model {
namespace {

/// Share of the positions that smooth functions may take beyond the degrees of freedom that every curve has.
constexpr double kMostOfPositions = 0.6;

/// Degrees of freedom of a curve beside mean and slope (docs/physics.md).
constexpr double kFreedomOfCurve = 10.0;

/// Positions closer than this share of the travel are one target.
constexpr double kSameTarget = 1e-3;

/// Second derivatives of the natural cubic spline at its places: a tridiagonal system, solved without pivoting since
/// its diagonal outweighs the rest. @param at  ascending, at least two
std::vector<double> second_derivatives(const std::vector<double>& at, const std::vector<double>& value) {
  const std::size_t n = at.size();
  std::vector<double> second(n, 0.0), above(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = at[i] - at[i - 1], right = at[i + 1] - at[i];
    const double bend = 6.0 * ((value[i + 1] - value[i]) / right - (value[i] - value[i - 1]) / left);
    const double pivot = 2.0 * (left + right) - left * above[i - 1];
    above[i] = right / pivot;
    second[i] = (bend - left * second[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) second[i] -= above[i] * second[i + 1];
  return second;
}

/// Functions that this many different positions can hold; mean and slope take two.
std::size_t most_functions(double positions, bool apart) {
  if (positions < 3.0) return 0;
  if (positions <= static_cast<double>(kFreeTargets) || apart) return static_cast<std::size_t>(positions) - 2;
  return static_cast<std::size_t>(std::min(positions - 3.0, std::max(kFreedomOfCurve, kMostOfPositions * positions)));
}

}  // namespace

double smooth_shape(std::size_t order, double place) {
  const double u = 2.0 * place - 1.0;
  double before = 1.0, now = u;  // Legendre polynomials, by their three-term recurrence
  for (std::size_t n = 1; n <= order; ++n) {
    const double k = static_cast<double>(n);
    const double next = ((2.0 * k + 1.0) * u * now - k * before) / (k + 1.0);
    before = now;
    now = next;
  }
  return std::sqrt(2.0 * static_cast<double>(order) + 3.0) * now;
}

std::vector<double> distinct(std::vector<double> values, double tolerance) {
  std::ranges::sort(values);
  std::vector<double> kept;
  for (const double v : values)
    if (kept.empty() || v - kept.back() > tolerance) kept.push_back(v);
  return kept;
}

CurveBasis::CurveBasis(const std::vector<double>& positions_mm, std::size_t most, bool apart) {
  if (positions_mm.empty()) return;
  const auto [least, greatest] = std::ranges::minmax_element(positions_mm);
  least_mm_ = *least;
  greatest_mm_ = *greatest;
  const double n = static_cast<double>(positions_mm.size());
  for (const double p : positions_mm) centre_mm_ += p / n;
  const double width = greatest_mm_ - least_mm_;
  if (width <= 0.0) return;
  targets_mm_ = distinct(positions_mm, kSameTarget * width);
  const std::size_t room = most_functions(static_cast<double>(targets_mm_.size()), apart);
  for (std::size_t k = 0; k < std::min(most, room); ++k) {
    std::vector<double> shape;
    for (const double target : targets_mm_) shape.push_back(smooth_shape(k + 1, (target - least_mm_) / width));
    second_.push_back(second_derivatives(targets_mm_, shape));
    shape_.push_back(std::move(shape));
    double sum = 0.0, sum_pf = 0.0, sum_pp = 0.0;
    for (const double p : positions_mm) {
      const double f = spline(k, p);
      sum += f;
      sum_pf += (p - centre_mm_) * f;
      sum_pp += (p - centre_mm_) * (p - centre_mm_);
    }
    mean_.push_back(sum / n);
    slope_.push_back(sum_pf / sum_pp);
  }
}

double CurveBasis::spline(std::size_t k, double position_mm) const {
  const auto above = std::upper_bound(targets_mm_.begin() + 1, targets_mm_.end() - 1, position_mm);
  const auto i = static_cast<std::size_t>(above - targets_mm_.begin());
  const double h = targets_mm_[i] - targets_mm_[i - 1];
  const double b = std::clamp((position_mm - targets_mm_[i - 1]) / h, 0.0, 1.0), a = 1.0 - b;
  return a * shape_[k][i - 1] + b * shape_[k][i] +
         ((a * a * a - a) * second_[k][i - 1] + (b * b * b - b) * second_[k][i]) * h * h / 6.0;
}

double CurveBasis::half_width_mm() const { return std::max(0.5 * (greatest_mm_ - least_mm_), 1e-9); }

double CurveBasis::value(std::size_t k, double position_mm) const {
  const double p = std::clamp(position_mm, least_mm_, greatest_mm_);
  return spline(k, p) - mean_[k] - slope_[k] * (p - centre_mm_);
}

}  // namespace ecs::model
