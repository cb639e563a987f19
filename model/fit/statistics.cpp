// Incomplete gamma and beta functions by series and continued fractions (Abramowitz and Stegun 1964, 6.5 and 26.5;
// Lentz 1976 as modified by Thompson and Barnett 1986); exact interval of a share (Clopper and Pearson 1934); tail
// beyond the largest of a sample by exponential excesses over a threshold (Pickands 1975; Davison and Smith 1990).
#include "model/fit/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::model {

double ln_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

namespace {

/// Terms after which a series or fraction ends in any case: arguments met here need less than a hundredth of them.
constexpr int kMostTerms = 10'000;
/// A term below this share of the sum changes no digit of a double (2⁻⁵³ = 1.1e-16).
constexpr double kNoDigit = 1e-16;
/// A factor this close to 1 ends a continued fraction: the last digits of a double are rounding.
constexpr double kSettled = 1e-15;
/// Lentz's replacement for a denominator of 0.
constexpr double kTiny = 1e-300;
/// ln of a probability that is 0.
constexpr double kLnZero = -kBeyondAll;

/// ln of the upper incomplete gamma ratio Q(a, x) (series below, Lentz's continued fraction above; Abramowitz and
/// Stegun 6.5.29, 6.5.31).
double ln_gamma_q(double a, double x) {
  if (x <= 0.0) return 0.0;
  const double front = a * std::log(x) - x - ln_gamma(a);
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < kMostTerms && std::abs(term) > kNoDigit * std::abs(sum); ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return std::log1p(-std::min(std::exp(front) * sum, 1.0 - kNoDigit));
  }
  double b = x + 1.0 - a, c = 1.0 / kTiny, d = 1.0 / b, h = d;
  for (int i = 1; i < kMostTerms; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    const double change = d * c;
    h *= change;
    if (std::abs(change - 1.0) < kSettled) break;
  }
  return front + std::log(h);
}

/// Continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8).
double beta_fraction(double a, double b, double x) {
  double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
  if (std::abs(d) < kTiny) d = kTiny;
  d = 1.0 / d;
  double h = d;
  for (int m = 1; m < kMostTerms; ++m) {
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
    if (std::abs(d * c - 1.0) < kSettled) break;
  }
  return h;
}

/// ln of the regularised incomplete beta function I_x(a, b).
double ln_beta_ratio(double a, double b, double x) {
  if (x <= 0.0) return kLnZero;
  if (x >= 1.0) return 0.0;
  const double front = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * std::log(x) + b * std::log1p(-x);
  if (x < (a + 1.0) / (a + b + 2.0)) return front + std::log(beta_fraction(a, b, x)) - std::log(a);
  return std::log1p(-std::min(std::exp(front) * beta_fraction(b, a, 1.0 - x) / b, 1.0 - kNoDigit));
}

/// p with I_p(a, b) = target, by bisection.
double beta_quantile(double a, double b, double target) {
  double low = 0.0, high = 1.0;
  constexpr int kHalvings = 200;  // 2^-200 of the interval: far finer than a double of order 1
  for (int i = 0; i < kHalvings; ++i) {
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

double tail_probability(std::vector<double> noise_replicates, double value) {
  constexpr std::size_t kTailPart = 5;    // a fifth: a choice; less leaves too few excesses, more is no tail
  constexpr double kFewReached = 3.0;     // counts up to this vary more than the fitted tail does
  constexpr double kLeastExcess = 1e-12;  // replicates that are all alike have no tail
  if (noise_replicates.empty()) return 1.0;
  std::sort(noise_replicates.begin(), noise_replicates.end());
  const auto n = static_cast<double>(noise_replicates.size());
  const auto reached = static_cast<double>(noise_replicates.end() -
                                           std::lower_bound(noise_replicates.begin(), noise_replicates.end(), value));
  const std::size_t from = noise_replicates.size() - std::max<std::size_t>(noise_replicates.size() / kTailPart, 1);
  if (value <= noise_replicates[from]) return reached / n;
  double excess = 0.0;
  for (std::size_t i = from; i < noise_replicates.size(); ++i) excess += noise_replicates[i] - noise_replicates[from];
  excess /= static_cast<double>(noise_replicates.size() - from);
  const double share = static_cast<double>(noise_replicates.size() - from) / n;
  const double extrapolated = share * std::exp(-(value - noise_replicates[from]) / std::max(excess, kLeastExcess));
  return reached > kFewReached ? std::max(reached / n, extrapolated) : extrapolated;
}

double wealth_of_bet(double chance, std::size_t reached, std::size_t drawn) {  // binomial mixture over 0 … chance
  const double l = static_cast<double>(reached), rest = static_cast<double>(drawn - reached);
  return std::exp(ln_beta_ratio(l + 1.0, rest + 1.0, chance)) / chance;
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

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rms_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace ecs::model
