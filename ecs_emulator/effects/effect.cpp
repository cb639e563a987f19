#include "ecs_emulator/effects/effect.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {
namespace {

/// Parameters that the contribution is proportional to.
constexpr std::array<std::string_view, 23> kSizes{
    "um",       "um_per_m",  "amplitude_um", "amplitude2_um", "height_um",     "k2",
    "k3",       "lever_mm",  "c_um",         "c_um_per_m",    "um_per_h",      "factor",
    "length_m", "um_per_kg", "um_per_kg_m",  "um_per_degC",   "um_per_m_degC", "um_per_m_min"};

}  // namespace

std::optional<EffectKind> effect_kind_named(std::string_view name) {
  for (std::size_t i = 0; i < kEffectKinds; ++i)
    if (kEffectNames[i] == name) return static_cast<EffectKind>(i);
  return std::nullopt;
}

double legendre(std::size_t degree, double place) {
  double before = 1.0;
  double now = place;
  if (degree == 0) return before;
  for (std::size_t n = 1; n < degree; ++n) {
    const double k = static_cast<double>(n);
    const double next = ((2.0 * k + 1.0) * place * now - k * before) / (k + 1.0);
    before = now;
    now = next;
  }
  return now;
}

double value_at(const SmoothCurve& curve, double p_mm) {
  const double place = std::clamp(2.0 * (p_mm - curve.from_mm) / (curve.to_mm - curve.from_mm) - 1.0, -1.0, 1.0);
  double value = curve.mean + curve.slope * place;
  for (std::size_t k = 0; k < curve.waves.size(); ++k) value += curve.waves[k] * legendre(k + 2, place);
  return value;
}

double PlacedEffect::parameter(std::string_view name) const {
  const auto found = parameters.find(name);
  return found == parameters.end() ? 0.0 : found->second;
}

std::string place_of(const PlacedEffect& effect) {
  std::string text(name_of(effect.kind));
  if (effect.axis) text += std::string(":") + letter_of(*effect.axis);
  if (effect.kind == EffectKind::angular || effect.kind == EffectKind::squareness)
    return text + ":" + std::string(name_of(*effect.code));
  if (effect.sense) text += ":" + std::string(name_of(*effect.sense));
  return text;
}

PlacedEffect scaled(PlacedEffect effect, double factor) {
  for (auto& [name, value] : effect.parameters)
    if (std::find(kSizes.begin(), kSizes.end(), name) != kSizes.end()) value *= factor;
  if (effect.kind == EffectKind::cosine) effect.parameters["angle_mrad"] *= std::sqrt(std::abs(factor));
  effect.curve.mean *= factor;
  effect.curve.slope *= factor;
  for (double& wave : effect.curve.waves) wave *= factor;
  return effect;
}

}  // namespace ecs::emulator
