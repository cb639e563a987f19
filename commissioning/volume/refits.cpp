// B. Efron, R. Tibshirani, An Introduction to the Bootstrap (1993), 6.5. Correlated noise is a first-order process in
// time.
#include "commissioning/volume/refits.hpp"

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>

namespace ecs::commissioning {
namespace {

/// Noise of one sense along one axis, in the order of the rows.
class DrawnNoise {
 public:
  DrawnNoise(const model::NoiseReport& noise, std::mt19937_64& random) : noise_(noise), random_(random) {}

  /// @param time  of the reading [s], or its number
  double next(double time) {
    if (noise_.correlated_um > 0.0 && noise_.correlation_time_s > 0.0) {
      const double kept = last_time_ ? std::exp(-std::abs(time - *last_time_) / noise_.correlation_time_s) : 0.0;
      slow_um_ = kept * slow_um_ + noise_.correlated_um * std::sqrt(1.0 - kept * kept) * normal_(random_);
      last_time_ = time;
    }
    return slow_um_ + noise_.white_um * normal_(random_);
  }
  [[nodiscard]] bool is_of(Axis axis, Sense sense) const { return noise_.axis == axis && noise_.sense == sense; }

 private:
  const model::NoiseReport& noise_;
  std::mt19937_64& random_;
  std::normal_distribution<double> normal_{};
  std::optional<double> last_time_;
  double slow_um_ = 0.0;
};

}  // namespace

std::optional<std::array<double, 2>> targets_about(const model::EffectInstance& effect,
                                                   const model::Observations& data) {
  const std::string name(effect.definition().searched_parameter());
  if (effect.definition().search.has_slope || !effect.axis || effect.parameters.contains(name)) return std::nullopt;
  const auto place = effect.fitted.find(name);
  if (place == effect.fitted.end()) return std::nullopt;
  std::optional<double> below, above;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double p_mm = data.p_mm(k, *effect.axis);
    if (p_mm <= place->second && (!below || p_mm > *below)) below = p_mm;
    if (p_mm > place->second && (!above || p_mm < *above)) above = p_mm;
  }
  if (!below || !above) return std::nullopt;
  return std::array{*below, *above};
}

std::vector<model::Fit> refits(const model::Model& model, const model::Observations& data, const model::Fit& fit,
                               std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<model::Fit> again;
  for (std::size_t draw = 0; draw < count; ++draw) {
    std::vector<DrawnNoise> noises;
    for (const model::NoiseReport& noise : fit.noise_by_sense) noises.emplace_back(noise, random);
    model::Observations drawn = data;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      drawn.reading[k] = fit.predicted[k];
      for (DrawnNoise& noise : noises)
        if (noise.is_of(data.axis[k], data.sense[k]))
          drawn.reading[k] += noise.next(data.time_s.empty() ? static_cast<double>(k) : data.time_s[k]);
    }
    auto one = model::fit(model, drawn);
    if (!one) continue;
    for (model::EffectFit& each : one->effects)
      if (const auto targets = targets_about(each.effect, data))
        each.effect.fitted[std::string(each.effect.definition().searched_parameter())] =
            std::uniform_real_distribution<double>((*targets)[0], (*targets)[1])(random);
    again.push_back(std::move(*one));
  }
  return again;
}

}  // namespace ecs::commissioning
