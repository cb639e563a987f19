#include "model/curve_basis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecs::model {
namespace {

/// Root of cos b · cosh b = 1 number `order`; its asymptote is exact to 1e-9 from the fourth on.
double beam_root(std::size_t order) {
  constexpr double kFirst[] = {4.730040744862704, 7.853204624095838, 10.995607838001671};
  if (order <= 3) return kFirst[order - 1];
  return (static_cast<double>(order) + 0.5) * std::numbers::pi;
}

/// Share of the positions that smooth functions may take.
constexpr double kMostOfPositions = 0.6;

}  // namespace

double beam_mode(std::size_t order, double place) {
  // cosh bx + cos bx − s (sinh bx + sin bx), rearranged so that no large numbers cancel
  const double b = beam_root(order);
  const double denominator = std::sinh(b) - std::sin(b);
  const double one_minus_s = (std::cos(b) - std::sin(b) - std::exp(-b)) / denominator;
  const double s = 1.0 - one_minus_s;
  const double growing = 0.5 * one_minus_s * std::exp(b * place);
  const double falling = 0.5 * (1.0 + s) * std::exp(-b * place);
  return growing + falling + std::cos(b * place) - s * std::sin(b * place);
}

std::vector<double> distinct(std::vector<double> values, double tolerance) {
  std::sort(values.begin(), values.end());
  std::vector<double> kept;
  for (const double v : values)
    if (kept.empty() || v - kept.back() > tolerance) kept.push_back(v);
  return kept;
}

CurveBasis::CurveBasis(const std::vector<double>& positions_mm, std::size_t most) {
  if (positions_mm.empty()) return;
  const auto [least, greatest] = std::minmax_element(positions_mm.begin(), positions_mm.end());
  least_mm_ = *least;
  greatest_mm_ = *greatest;
  const double n = static_cast<double>(positions_mm.size());
  for (const double p : positions_mm) centre_mm_ += p / n;
  const double width = greatest_mm_ - least_mm_;
  if (width <= 0.0) return;
  const auto places = static_cast<double>(distinct(positions_mm, 1e-6 * width).size());
  if (places < 4.0) return;
  const auto room = static_cast<std::size_t>(std::max(1.0, std::min(places - 3.0, kMostOfPositions * places)));
  for (std::size_t k = 0; k < std::min(most, room); ++k) {
    double sum = 0.0, sum_pf = 0.0, sum_pp = 0.0;
    for (const double p : positions_mm) {
      const double f = beam_mode(k + 1, place_of(p));
      sum += f;
      sum_pf += (p - centre_mm_) * f;
      sum_pp += (p - centre_mm_) * (p - centre_mm_);
    }
    mean_.push_back(sum / n);
    slope_.push_back(sum_pf / sum_pp);
  }
}

double CurveBasis::place_of(double position_mm) const {
  const double width = greatest_mm_ - least_mm_;
  return width <= 0.0 ? 0.0 : std::clamp((position_mm - least_mm_) / width, 0.0, 1.0);
}

double CurveBasis::half_width_mm() const { return std::max(0.5 * (greatest_mm_ - least_mm_), 1e-9); }

double CurveBasis::value(std::size_t k, double position_mm) const {
  const double p = std::clamp(position_mm, least_mm_, greatest_mm_);
  return beam_mode(k + 1, place_of(p)) - mean_[k] - slope_[k] * (p - centre_mm_);
}

}  // namespace ecs::model
