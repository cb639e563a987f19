// Sentences from numbers; no method of its own.
#include "model/diagnosis/words.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/effects/definition.hpp"

namespace ecs::model {
namespace {

/// A period is a pitch, a tenth to ten times it, where it agrees to a percent: a fit knows it no better than that on a
/// short travel, and ratios of small whole numbers are further apart.
constexpr double kSamePitch = 0.01;
constexpr int kMostOfPitch = 10;
/// Targets a period that show its shape, and a period to suggest where none was fitted.
constexpr double kTargetsAPeriod = 10.0, kUsualPeriod_mm = 10.0;

std::string percent(double share) { return fmt::format("{:.3g} %", kPercent * share); }

std::optional<double> searched_value(const EffectInstance& effect) {
  const auto found = effect.fitted.find(std::string(effect.definition().searched_parameter()));
  return found == effect.fitted.end() ? std::nullopt : std::optional(found->second);
}

/// "half the screw pitch" for a period that matches a fact of the machine within a percent; "" if none does.
std::string pitch_match(const EffectInstance& effect, const Observations& data) {
  const auto period = searched_value(effect);
  if (!effect.traits().periodic || !period || !effect.axis) return "";
  const auto& axis = data.machine.axes[index_of(*effect.axis)];
  if (!axis) return "";
  const auto named = [&](const std::optional<double>& pitch, const char* name) -> std::string {
    if (!pitch) return "";
    for (int n = 1; n <= kMostOfPitch; ++n) {
      if (std::abs(*period * n / *pitch - 1.0) < kSamePitch)
        return n == 1 ? fmt::format("the {}", name) : fmt::format("1/{} of the {}", n, name);
      if (std::abs(*period / (n * *pitch) - 1.0) < kSamePitch) return fmt::format("{} times the {}", n, name);
    }
    return "";
  };
  const std::string screw = named(axis->screw_pitch_mm, "screw pitch");
  return screw.empty() ? named(axis->scale_pitch_mm, "scale pitch") : screw;
}

std::string axis_word(const EffectInstance& effect) {
  return effect.axis ? std::string(1, letter_of(*effect.axis)) : std::string("the axis");
}

}  // namespace

std::string reason_for(const Candidate& candidate, const Diagnosis& diagnosis, const Observations& data) {
  const EffectDefinition& definition = candidate.effect.definition();
  const double before = candidate.kept_rms_before_um, after = candidate.kept_rms_after_um;
  std::string text =
      fmt::format("{}: with it the residual{} falls from {:.3g} to {:.3g} um rms ({} explained; noise {:.3g} um)",
                  definition.title, diagnosis.outliers.empty() ? "" : " without the outliers", before, after,
                  percent(before > 0.0 ? 1.0 - std::pow(after / before, 2) : 0.0), diagnosis.noise.noise_um);
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
    text += fmt::format("; the period {:.5g} mm is {}", *searched_value(candidate.effect), pitch);
  return text + fmt::format(". What tells it apart: {}.", definition.tells_apart);
}

std::string separating_measurement(const EffectInstance& effect, const std::vector<EffectInstance>& rivals) {
  const SeparatingMeasurement* chosen = &effect.definition().separated_by;
  for (const EffectInstance& rival : rivals) {
    const SeparatingMeasurement& other = rival.definition().separated_by;
    if (other.also_for_rivals && other.precedence < chosen->precedence) chosen = &other;
  }
  const double period_mm = effect.traits().periodic ? searched_value(effect).value_or(kUsualPeriod_mm) : 0.0;
  return fmt::format(fmt::runtime(chosen->sentence), fmt::arg("axis", axis_word(effect)),
                     fmt::arg("tenth", period_mm / kTargetsAPeriod));
}

}  // namespace ecs::model
