// Each quantity of ISO 230-2 as a function of instrument, alignment, temperature and environment: a budget by the GUM.
#include "laser/standards/iso230_uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace ecs::laser {
namespace {

/// Contributions in um at the whole length; the environment at a single reading.
std::vector<BudgetInput> inputs_of(const Iso230Conditions& c, double length_mm) {
  const double length_m = length_mm / kMmPerM;
  const double cosine_um = c.misalignment_mm * c.misalignment_mm / (2.0 * length_mm) * kUmPerMm;
  return {
      {"instrument", 0.0, c.instrument_um_per_m / kCoverage * length_m},
      {"instrument, constant part", 0.0, c.instrument_um / kCoverage},
      {"misalignment", 0.0, u_of_range(cosine_um)},
      {"temperature of the machine", 0.0, u_of_range(c.temperature_range_degC) * c.expansion_um_per_m_degC * length_m},
      {"expansion coefficient", 0.0, u_of_range(c.expansion_range_um_per_m_degC) * std::abs(c.off_20_degC) * length_m},
      {"environment", 0.0, u_of_range(c.environment_um)}};
}

/// @param of_length  share of what grows with the length  @param readings  factor of a single reading's uncertainty
double expanded(const std::vector<BudgetInput>& inputs, double of_length, double readings) {
  const auto f = [&](std::span<const double> x) {
    double sum = readings * x.back();
    for (std::size_t i = 0; i + 1 < x.size(); ++i) sum += of_length * x[i];
    return sum;
  };
  return budget_of(f, inputs).expanded();
}

/// Fewest readings of a target from that side, of those that repeat there; 1 where none does.
double fewest(const Iso230& iso, int Iso230Target::*count) {
  int n = 0;
  for (const Iso230Target& target : iso.targets)
    if (target.*count > 1) n = n == 0 ? target.*count : std::min(n, target.*count);
  return static_cast<double>(std::max(n, 1));
}

}  // namespace

std::optional<Iso230Uncertainty> iso230_uncertainty_of(const Iso230& iso, const Iso230Conditions& conditions) {
  if (iso.rotary || is_rotation(iso.sense) || iso.targets.size() < 2) return std::nullopt;
  Iso230Uncertainty result;
  result.length_mm = iso.targets.back().position_mm - iso.targets.front().position_mm;
  const auto inputs = inputs_of(conditions, result.length_mm);
  for (const BudgetInput& input : inputs)
    if (input.u > 0.0) result.parts.push_back({input.name, kCoverage * input.u});
  const double n_forward = fewest(iso, &Iso230Target::n_forward), n_reverse = fewest(iso, &Iso230Target::n_reverse);
  const auto give = [&](std::optional<double>& U, const std::optional<double>& value, double of_length,
                        double variance) {
    if (value && std::isfinite(variance)) U = expanded(inputs, of_length, std::sqrt(variance));
  };
  // Variances in those of a single reading: of a mean, and of the standard deviation of n readings.
  const double mean_f = 1.0 / n_forward, mean_r = 1.0 / n_reverse;
  const double s_f = 1.0 / (n_forward - 1.0), s_r = 1.0 / (n_reverse - 1.0);
  const double worst_mean = std::max(mean_f, mean_r), worst_end = std::max(mean_f + 4.0 * s_f, mean_r + 4.0 * s_r);
  give(result.B, iso.B, 0.0, mean_f + mean_r);
  give(result.B_mean, iso.B_mean, 0.0, (mean_f + mean_r) / static_cast<double>(iso.targets.size()));
  give(result.M, iso.M, 1.0, (mean_f + mean_r) / 2.0);
  give(result.E_forward, iso.E_forward, 1.0, 2.0 * mean_f);
  give(result.E_reverse, iso.E_reverse, 1.0, 2.0 * mean_r);
  give(result.E, iso.E, 1.0, 2.0 * worst_mean);
  give(result.R_forward, iso.R_forward, 0.0, 16.0 * s_f);
  give(result.R_reverse, iso.R_reverse, 0.0, 16.0 * s_r);
  give(result.R, iso.R, 0.0, std::max({4.0 * s_f + 4.0 * s_r + mean_f + mean_r, 16.0 * s_f, 16.0 * s_r}));
  give(result.A_forward, iso.A_forward, 1.0, 2.0 * (mean_f + 4.0 * s_f));
  give(result.A_reverse, iso.A_reverse, 1.0, 2.0 * (mean_r + 4.0 * s_r));
  give(result.A, iso.A, 1.0, 2.0 * worst_end);
  return result;
}

}  // namespace ecs::laser
