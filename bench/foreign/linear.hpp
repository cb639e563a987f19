// Least squares on a few columns, and the probabilities that go with it.
#pragma once

#include <utility>
#include <vector>

namespace foreign {

using Column = std::vector<double>;  ///< one value a reading

[[nodiscard]] double dot(const Column& a, const Column& b);
[[nodiscard]] double rms(const Column& values);
void add_scaled(Column& to, const Column& what, double factor);

/// Orthonormal columns by Gram and Schmidt, each pass done twice (Daniel, Gragg, Kaufman, Stewart 1976).
class Basis {
 public:
  /// Adds what the columns before it do not hold. A column of which less than 1e-7 is new adds nothing.
  /// @return whether it added a dimension
  bool add(const Column& column);
  void add(const std::vector<Column>& columns);
  /// What the columns cannot reproduce.
  [[nodiscard]] Column residual(Column values) const;
  [[nodiscard]] int rank() const { return static_cast<int>(columns_.size()); }

 private:
  std::vector<Column> columns_;
};

/// Inverse of the normal matrix AᵀA by Gauss and Jordan with pivots; shape (columns × columns). A singular direction
/// gets a huge variance.
[[nodiscard]] std::vector<Column> inverse_normal(const std::vector<Column>& columns);

/// Regularised incomplete beta function I_x(a, b), continued fraction by Lentz (Numerical Recipes, 6.4).
[[nodiscard]] double incomplete_beta(double a, double b, double x);
/// Clopper and Pearson 1934, 95 %: {low, high} of `right` in `total`.
[[nodiscard]] std::pair<double, double> clopper_pearson(int right, int total);
/// Chance that χ² with `freedom` degrees exceeds `value` (Wilson and Hilferty 1931).
[[nodiscard]] double chi2_exceeds(double value, double freedom);

}  // namespace foreign
