// Least squares by Gram and Schmidt; exact binomial intervals by bisection of the incomplete beta function.
#include "bench/foreign/linear.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace foreign {
namespace {

constexpr double kNewShare = 1e-7;  // of a column, below which it counts as already there

double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  double c = 1.0;
  double d = 1.0 - (a + b) * x / (a + 1.0);
  d = 1.0 / (std::abs(d) < kTiny ? kTiny : d);
  double h = d;
  const auto step = [&](double term) {
    d = 1.0 + term * d;
    d = 1.0 / (std::abs(d) < kTiny ? kTiny : d);
    c = 1.0 + term / c;
    if (std::abs(c) < kTiny) c = kTiny;
    h *= d * c;
    return d * c;
  };
  for (int m = 1; m < 1000; ++m) {
    step(m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)));
    const double change = step(-(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)));
    if (std::abs(change - 1.0) < 1e-14) break;
  }
  return h;
}

// The x where I_x(a, b) = probability.
double beta_quantile(double a, double b, double probability) {
  double low = 0.0;
  double high = 1.0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (incomplete_beta(a, b, middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double dot(const Column& a, const Column& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double rms(const Column& values) {
  return values.empty() ? 0.0 : std::sqrt(dot(values, values) / static_cast<double>(values.size()));
}

void add_scaled(Column& to, const Column& what, double factor) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * what[i];
}

bool Basis::add(const Column& column) {
  const double before = std::sqrt(dot(column, column));
  Column rest = residual(residual(column));
  const double after = std::sqrt(dot(rest, rest));
  if (!(after > kNewShare * before)) return false;
  for (double& value : rest) value /= after;
  columns_.push_back(std::move(rest));
  return true;
}

void Basis::add(const std::vector<Column>& columns) {
  for (const Column& column : columns) add(column);
}

Column Basis::residual(Column values) const {
  for (const Column& column : columns_) add_scaled(values, column, -dot(values, column));
  return values;
}

std::vector<Column> inverse_normal(const std::vector<Column>& columns) {
  const std::size_t n = columns.size();
  std::vector<double> norm(n);
  for (std::size_t i = 0; i < n; ++i) norm[i] = std::max(std::sqrt(dot(columns[i], columns[i])), 1e-300);
  std::vector<Column> left(n, Column(n, 0.0));
  std::vector<Column> right(n, Column(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) {
    right[i][i] = 1.0;
    for (std::size_t j = 0; j < n; ++j) left[i][j] = dot(columns[i], columns[j]) / (norm[i] * norm[j]);
  }
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::abs(left[i][k]) > std::abs(left[best][k])) best = i;
    std::swap(left[k], left[best]);
    std::swap(right[k], right[best]);
    const double pivot = std::abs(left[k][k]) > 1e-13 ? left[k][k] : 1e-13;
    for (std::size_t j = 0; j < n; ++j) {
      left[k][j] /= pivot;
      right[k][j] /= pivot;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = left[i][k];
      add_scaled(left[i], left[k], -factor);
      add_scaled(right[i], right[k], -factor);
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) right[i][j] /= norm[i] * norm[j];
  return right;
}

double incomplete_beta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(a, b, x) / a;
  return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

std::pair<double, double> clopper_pearson(int right, int total) {
  const double low = right == 0 ? 0.0 : beta_quantile(right, total - right + 1.0, 0.025);
  const double high = right == total ? 1.0 : beta_quantile(right + 1.0, total - right, 0.975);
  return {low, high};
}

double chi2_exceeds(double value, double freedom) {
  if (value <= 0.0) return 1.0;
  const double spread = 2.0 / (9.0 * freedom);
  const double z = (std::cbrt(value / freedom) - (1.0 - spread)) / std::sqrt(spread);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

}  // namespace foreign
