// Sentences from numbers; no method of its own.
#include "model/diagnosis/words.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::model {
namespace {

using enum EffectId;

/// A period is a pitch, a tenth to ten times it, where it agrees to a percent: a fit knows it no better than that on a
/// short travel, and ratios of small whole numbers are further apart.
constexpr double kSamePitch = 0.01;
constexpr int kMostOfPitch = 10;
/// Targets a period that show its shape, and a period to suggest where none was fitted.
constexpr double kTargetsAPeriod = 10.0, kUsualPeriod_mm = 10.0;

std::string percent(double share) { return fmt::format("{:.3g} %", kPercent * share); }

/// "half the screw pitch" for a period that matches a fact of the machine within a percent; "" if none does.
std::string pitch_match(const EffectInstance& effect, const Observations& data) {
  const auto period = effect.fitted.find("period_mm");
  if (effect.id != cyclic || period == effect.fitted.end() || !effect.axis) return "";
  const auto& axis = data.machine.axes[index_of(*effect.axis)];
  if (!axis) return "";
  const auto named = [&](const std::optional<double>& pitch, const char* name) -> std::string {
    if (!pitch) return "";
    for (int n = 1; n <= kMostOfPitch; ++n) {
      if (std::abs(period->second * n / *pitch - 1.0) < kSamePitch)
        return n == 1 ? fmt::format("the {}", name) : fmt::format("1/{} of the {}", n, name);
      if (std::abs(period->second / (n * *pitch) - 1.0) < kSamePitch) return fmt::format("{} times the {}", n, name);
    }
    return "";
  };
  const std::string screw = named(axis->screw_pitch_mm, "screw pitch");
  return screw.empty() ? named(axis->scale_pitch_mm, "scale pitch") : screw;
}

bool any(const EffectInstance& effect, const std::vector<EffectInstance>& rivals, std::initializer_list<EffectId> ids) {
  const auto one_of = [&](EffectId id) { return std::find(ids.begin(), ids.end(), id) != ids.end(); };
  return one_of(effect.id) ||
         std::any_of(rivals.begin(), rivals.end(), [&](const EffectInstance& r) { return one_of(r.id); });
}

std::string axis_word(const EffectInstance& effect) {
  return effect.axis ? std::string(1, letter_of(*effect.axis)) : std::string("the axis");
}

}  // namespace

std::string reason_for(const Candidate& candidate, const Diagnosis& diagnosis, const Observations& data) {
  const EffectInfo& info = info_of(candidate.effect.id);
  std::string text = fmt::format(
      "{}: with it the residual falls from {:.3g} to {:.3g} um rms ({} explained; noise {:.3g} um)", info.title,
      diagnosis.rms_um, candidate.rms_after_um, percent(candidate.explained), diagnosis.noise.noise_um);
  if (candidate.held_out_rms_um && candidate.held_out_rms_before_um)
    text += fmt::format(", on readings it was not fitted to from {:.3g} to {:.3g} um",
                        *candidate.held_out_rms_before_um, *candidate.held_out_rms_um);
  if (candidate.false_naming * static_cast<double>(diagnosis.noise_replicates) < 1.0)
    text +=
        fmt::format("; in none of {} data sets of noise alone does anything look as good", diagnosis.noise_replicates);
  else if (candidate.false_naming < 1.0)
    text += fmt::format("; noise alone looks as good in {:.2g} % of data sets like this one",
                        kPercent * candidate.false_naming);
  if (const std::string pitch = pitch_match(candidate.effect, data); !pitch.empty())
    text += fmt::format("; the period {:.5g} mm is {}", candidate.effect.fitted.at("period_mm"), pitch);
  return text + fmt::format(". What tells it apart: {}.", info.tells_apart);
}

std::string separating_measurement(const EffectInstance& effect, const std::vector<EffectInstance>& rivals,
                                   const Observations& data) {
  const std::string a = axis_word(effect);
  if (any(effect, rivals, {map_polarity, map_gain, map_shift, map_direction_swap}))
    return fmt::format(
        "Repeat the same line with compensation switched off (compensated = 0): a fault of the map goes with the map.");
  if (any(effect, rivals, {air_refraction, dead_path}))
    return fmt::format(
        "Repeat the {} line on a day with another air pressure (10 hPa or more apart), air temperature noted.", a);
  if (any(effect, rivals, {thermal_scale, thermal_drift}))
    return fmt::format("Repeat the {} line with the machine at least 3 degC warmer or colder, sensors recorded.", a);
  if (any(effect, rivals, {servo_lag}))
    return fmt::format("Repeat the {} line both ways at a quarter and at twice the feed.", a);
  if (any(effect, rivals, {warm_up, time_drift}))
    return fmt::format("Repeat the {} line from the cold machine and again after two hours, targets in reverse order.",
                       a);
  if (any(effect, rivals, {cosine}))
    return fmt::format("Realign the laser along {} and repeat: a cosine error changes, a scale error stays.", a);
  if (any(effect, rivals, {load})) return fmt::format("Repeat the {} line unloaded and with the full load.", a);
  if (any(effect, rivals, {angular, squareness, measurement_line}))
    return fmt::format(
        "Measure along {} again on a second line, the other axes parked as far as possible from the first.", a);
  if (effect.id == cyclic) {
    const auto period = effect.fitted.find("period_mm");
    const double p = period == effect.fitted.end() ? kUsualPeriod_mm : period->second;
    return fmt::format("Measure three periods of {} in steps of {:.3g} mm in the middle of the travel.", a,
                       p / kTargetsAPeriod);
  }
  if (any(effect, rivals, {backlash, reversal_curve, reversal_spike}))
    return fmt::format(
        "Measure {} both ways at five targets, each approached with short and with long travel after the reversal.", a);
  if (effect.id == step) return fmt::format("Measure {} in fine steps across the jump, both ways.", a);
  (void)data;
  return fmt::format("Measure the {} line again, both ways, on targets between the present ones.", a);
}

}  // namespace ecs::model
