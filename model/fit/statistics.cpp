#include "model/fit/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::model {
namespace {

/// ln of the upper incomplete gamma ratio Q(a, x) (series below, Lentz's continued fraction above; Abramowitz and
/// Stegun 6.5.29, 6.5.31).
double ln_gamma_q(double a, double x) {
  if (x <= 0.0) return 0.0;
  const double front = a * std::log(x) - x - std::lgamma(a);
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < 10'000 && std::abs(term) > 1e-16 * std::abs(sum); ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return std::log1p(-std::min(std::exp(front) * sum, 1.0 - 1e-16));
  }
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a, c = 1.0 / kTiny, d = 1.0 / b, h = d;
  for (int i = 1; i < 10'000; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    const double change = d * c;
    h *= change;
    if (std::abs(change - 1.0) < 1e-15) break;
  }
  return front + std::log(h);
}

/// Continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8).
double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
  if (std::abs(d) < kTiny) d = kTiny;
  d = 1.0 / d;
  double h = d;
  for (int m = 1; m < 10'000; ++m) {
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    for (const double step : {even, odd}) {
      d = 1.0 + step * d;
      if (std::abs(d) < kTiny) d = kTiny;
      c = 1.0 + step / c;
      if (std::abs(c) < kTiny) c = kTiny;
      d = 1.0 / d;
      h *= d * c;
    }
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return h;
}

/// ln of the regularised incomplete beta function I_x(a, b).
double ln_beta_ratio(double a, double b, double x) {
  if (x <= 0.0) return -1e300;
  if (x >= 1.0) return 0.0;
  const double front = std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
  if (x < (a + 1.0) / (a + b + 2.0)) return front + std::log(beta_fraction(a, b, x)) - std::log(a);
  return std::log1p(-std::min(std::exp(front) * beta_fraction(b, a, 1.0 - x) / b, 1.0 - 1e-16));
}

/// p with I_p(a, b) = target, by bisection.
double beta_quantile(double a, double b, double target) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (std::exp(ln_beta_ratio(a, b, middle)) < target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double ln_chi2_tail(double x, double k) { return k <= 0.0 ? 0.0 : ln_gamma_q(0.5 * k, 0.5 * x); }

double ln_f_tail(double f, double k, double v) {
  if (f <= 0.0 || k <= 0.0 || v <= 0.0) return 0.0;
  return ln_beta_ratio(0.5 * v, 0.5 * k, v / (v + k * f));
}

double normal_two_sided(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

double tail_probability(std::vector<double> blanks, double value) {
  if (blanks.empty()) return 1.0;
  std::sort(blanks.begin(), blanks.end());
  const auto n = static_cast<double>(blanks.size());
  const auto reached = static_cast<double>(blanks.end() - std::lower_bound(blanks.begin(), blanks.end(), value));
  const std::size_t from = blanks.size() - std::max<std::size_t>(blanks.size() / 5, 1);
  if (value <= blanks[from]) return reached / n;
  double excess = 0.0;
  for (std::size_t i = from; i < blanks.size(); ++i) excess += blanks[i] - blanks[from];
  excess /= static_cast<double>(blanks.size() - from);
  const double share = static_cast<double>(blanks.size() - from) / n;
  const double extrapolated = share * std::exp(-(value - blanks[from]) / std::max(excess, 1e-12));
  return reached > 3.0 ? std::max(reached / n, extrapolated) : extrapolated;
}

Interval clopper_pearson(unsigned hits, unsigned trials, double confidence) {
  if (trials == 0) return {};
  const double half = 0.5 * (1.0 - confidence);
  const double k = hits, n = trials;
  Interval interval;
  interval.low = hits == 0 ? 0.0 : beta_quantile(k, n - k + 1.0, half);
  interval.high = hits == trials ? 1.0 : beta_quantile(k + 1.0, n - k, 1.0 - half);
  return interval;
}

double rms_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace ecs::model
