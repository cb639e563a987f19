// Tails by the incomplete gamma and beta functions of Boost.Math, far out, where they would be 0, by their continued
// fractions in logarithms (Abramowitz and Stegun 1964, 6.5.31 and 26.5.8); exact interval of a share (Clopper and
// Pearson 1934); tail beyond the largest of a sample by exponential excesses over a threshold (Pickands 1975; Davison
// and Smith 1990).
#include "model/fit/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// Boost.Math would calculate with long double, which is another type on another processor, and sum in another order
// with SSE2.
#define BOOST_MATH_PROMOTE_DOUBLE_POLICY false
#pragma push_macro("__SSE2__")
#undef __SSE2__
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/fraction.hpp>
#pragma pop_macro("__SSE2__")

namespace ecs::model {

double ln_gamma(double x) { return boost::math::lgamma(x); }

namespace {

/// ln of a continued fraction b0 + a1/(b1 + a2/(b2 + …)). @param next  gives (any, b0), (a1, b1), (a2, b2) …
template <class Next>
double ln_fraction(Next next) {
  struct Terms {
    using result_type = std::pair<double, double>;
    Next& next;
    int n = 0;
    result_type operator()() { return next(n++); }
  } terms{next};
  return std::log(boost::math::tools::continued_fraction_b(terms, std::numeric_limits<double>::epsilon()));
}

/// ln of the upper incomplete gamma ratio Q(a, x).
double ln_gamma_q(double a, double x) {
  if (x <= 0.0) return 0.0;
  if (x < a + 1.0) return std::log1p(-boost::math::gamma_p(a, x));
  return a * std::log(x) - x - ln_gamma(a) -
         ln_fraction([=](int n) { return std::pair(-n * (n - a), x + 1.0 - a + 2.0 * n); });
}

/// ln of the regularised incomplete beta function I_x(a, b).
double ln_beta_ratio(double a, double b, double x) {
  if (x <= 0.0) return -kBeyondAll;
  if (x >= 1.0) return 0.0;
  if (x >= (a + 1.0) / (a + b + 2.0)) return std::log1p(-boost::math::ibetac(a, b, x));
  const auto term = [=](int n) {
    const double m = n / 2;
    if (n % 2 == 0) return std::pair(m * (b - m) * x / ((a + n - 1.0) * (a + n)), 1.0);
    return std::pair(-(a + m) * (a + b + m) * x / ((a + n - 1.0) * (a + n)), 1.0);
  };
  return ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * std::log(x) + b * std::log1p(-x) - std::log(a) -
         ln_fraction(term);
}

}  // namespace

double ln_chi2_tail(double x, double k) { return k <= 0.0 ? 0.0 : ln_gamma_q(0.5 * k, 0.5 * x); }

double ln_f_tail(double f, double k, double v) {
  if (f <= 0.0 || k <= 0.0 || v <= 0.0) return 0.0;
  return ln_beta_ratio(0.5 * v, 0.5 * k, v / (v + k * f));
}

bool is_no_more_than_noise(double chi2, double freedom) {
  constexpr double kDeviations = 3.0;
  return chi2 <= freedom + kDeviations * std::sqrt(2.0 * freedom);
}

double tail_probability(std::vector<double> noise_replicates, double value) {
  constexpr std::size_t kTailPart = 5;    // a fifth: a choice; less leaves too few excesses, more is no tail
  constexpr double kFewReached = 3.0;     // counts up to this vary more than the fitted tail does
  constexpr double kLeastExcess = 1e-12;  // replicates that are all alike have no tail
  if (noise_replicates.empty()) return 1.0;
  std::ranges::sort(noise_replicates);
  const auto n = static_cast<double>(noise_replicates.size());
  const auto reached = static_cast<double>(noise_replicates.end() - std::ranges::lower_bound(noise_replicates, value));
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

double coverage_factor(double degrees_of_freedom) {
  constexpr double kNormal = 2.0, kShare = 0.954499736103642, kMany = 1e6;
  if (!(degrees_of_freedom < kMany)) return kNormal;
  const boost::math::students_t distribution(std::max(1.0, degrees_of_freedom));
  return boost::math::quantile(distribution, 0.5 * (1.0 + kShare));
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
