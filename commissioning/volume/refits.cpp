// B. Efron, R. Tibshirani, An Introduction to the Bootstrap (1993), 6.5. Correlated noise is a first-order process in
// time.
#include "commissioning/volume/refits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "base/random.hpp"

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
  NormalDraws normal_{};
  std::optional<double> last_time_;
  double slow_um_ = 0.0;
};

/// Where an effect falls between two targets: each draw another of `count` equal parts, in an order of its own for
/// every effect.
class PlacesBetween {
 public:
  PlacesBetween(std::size_t effects, std::size_t count, std::mt19937_64& random) : part_(effects) {
    for (std::vector<std::size_t>& part : part_) {
      part.resize(count);
      std::iota(part.begin(), part.end(), std::size_t{0});
      shuffle(part, random);
    }
  }
  /// The middle of the part.
  [[nodiscard]] double share(std::size_t effect, std::size_t draw) const {
    return (static_cast<double>(part_[effect][draw]) + 0.5) / static_cast<double>(part_[effect].size());
  }

 private:
  std::vector<std::vector<std::size_t>> part_;
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
  PlacesBetween between(fit.effects.size(), count, random);
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
    for (std::size_t i = 0; i < one->effects.size(); ++i)
      if (model::EffectInstance& effect = one->effects[i].effect; const auto targets = targets_about(effect, data))
        effect.fitted[std::string(effect.definition().searched_parameter())] =
            std::lerp((*targets)[0], (*targets)[1], between.share(i, draw));
    again.push_back(std::move(*one));
  }
  return again;
}

}  // namespace ecs::commissioning
