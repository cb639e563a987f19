// Sum of the periodograms of the passes (Lomb 1976; Scargle 1982; averaged over segments: Bartlett 1948): on noise χ²
// of two degrees a pass; the price of the frequencies by Bonferroni.
#include "model/diagnosis/free_wave.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Readings of a pass below which its periodogram is left out: a mean, a slope and a wave leave four.
constexpr std::size_t kFewestInPassOfWave = 8;
/// Turns over the travel from which a shape is a wave; frequencies tried per 1/travel; targets a turn at the highest.
constexpr double kFewestTurnsOfWave = 2.0, kStepsATurn = 2.0, kTargetsATurn = 2.5;
constexpr double kOneInAMillion = 6.0;

struct Pass {
  std::vector<double> p_mm, value;
};

}  // namespace

std::optional<FreeWave> free_wave(const Observations& data, const Eigen::VectorXd& residual,
                                  const std::vector<bool>& left_out) {
  const std::vector<std::size_t> number = passes_of(data);
  std::map<std::pair<Channel, Axis>, std::map<std::size_t, Pass>> lines;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k]) continue;
    Pass& pass = lines[{data.channel(k), data.axis[k]}][number[k]];
    pass.p_mm.push_back(data.along_of(k));
    pass.value.push_back(residual(static_cast<Eigen::Index>(k)));
  }
  std::optional<FreeWave> strongest;
  for (auto& [line, passes] : lines) {
    std::erase_if(passes, [](const auto& each) { return each.second.p_mm.size() < kFewestInPassOfWave; });
    if (passes.size() < 2) continue;
    double square = 0.0, count = 0.0, travel = 0.0, densest = 0.0;
    for (auto& [pass_number, pass] : passes) {
      const auto [least, greatest] = std::minmax_element(pass.p_mm.begin(), pass.p_mm.end());
      travel = std::max(travel, *greatest - *least);
      densest = std::max(densest, static_cast<double>(pass.p_mm.size()));
      for (const double v : pass.value) square += v * v;
      count += static_cast<double>(pass.value.size());
    }
    if (travel <= 0.0 || square <= 0.0) continue;
    const double highest = densest / kTargetsATurn, lowest = kFewestTurnsOfWave;
    const double frequencies = std::max(1.0, highest - lowest);
    for (double turns = lowest; turns <= highest; turns += 1.0 / kStepsATurn) {
      double power = 0.0;
      for (const auto& [pass_number, pass] : passes) {
        std::complex<double> sum = 0.0;
        for (std::size_t i = 0; i < pass.p_mm.size(); ++i)
          sum += std::polar(pass.value[i], 2.0 * std::numbers::pi * turns * pass.p_mm[i] / travel);
        power += 2.0 * std::norm(sum) / static_cast<double>(pass.p_mm.size());
      }
      const double freedom = 2.0 * static_cast<double>(passes.size());
      const double ln_p = ln_chi2_tail(power / (square / count), freedom) + std::log(kStepsATurn * frequencies);
      const FreeWave wave{travel / turns, -ln_p / std::numbers::ln10};
      if (wave.minus_log_p > kOneInAMillion && (!strongest || wave.minus_log_p > strongest->minus_log_p))
        strongest = wave;
    }
  }
  return strongest;
}

}  // namespace ecs::model
