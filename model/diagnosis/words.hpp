// Sentences about a diagnosis: what is wrong, how much and where; why it is named; what would confirm it or separate it
// from its rivals. Does not live here: the numbers in them (diagnose.hpp), what the targets cannot show (targets.hpp),
// the run that separates best (model/planning/).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/data/observations.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::model {

/// A share times this is in per cent.
inline constexpr double kPercent = 100.0;

/// Rounded to significant digits, without an exponent from 1e-4 to 1e16: "3280", "0.0123".
[[nodiscard]] std::string in_digits(double value, int digits = 3);

/// The same effect at the same place in the same approach, by another sensor.
[[nodiscard]] bool follows_other_sensor(const EffectInstance& a, const EffectInstance& b);

/// "ball 2 on the table (nominally at X 100, Y 0, Z 50 mm)", "ball 2 in the spindle (tool offset X 0, Y 0, Z 120 mm)":
/// which of several balls an effect is of; empty where there is one, or the effect is of none.
[[nodiscard]] std::string ball_text(const EffectInstance& effect, const Observations& data);

/// "a periodic error of +-6.8 um in X positioning, period 10.00 mm, the pitch of the X screw, only when moving
/// forward": an effect with values from a fit, as an engineer names it inside a sentence.
[[nodiscard]] std::string finding_text(const EffectInstance& effect, const std::vector<ParameterEstimate>& parameters,
                                       const Observations& data);

/// Whether `parameters` hold one of many possible values: another term of the model does the same on these readings, or
/// they do not show so much as the sign of any size.
[[nodiscard]] bool is_undetermined(const EffectInstance& effect, const std::vector<ParameterEstimate>& parameters);

/// "X positions", "Y deviations along X", "Angles EA along X", "C positions", "Deviations EX over C": what readings of
/// a sense say where an axis moves. @param rotary  the axis is A, B or C
[[nodiscard]] std::string readings_word(Sense sense, std::optional<Axis> axis, bool rotary = false);

/// Whether an effect of the answer is periodic.
[[nodiscard]] bool names_a_wave(const Diagnosis& diagnosis);

/// The first sentence of an answer: the bad run first, then the causes with their ids in brackets.
/// @param diagnosis  with verdict, candidates, where and reservation  @param bad_run  a sentence; "" where there is
/// none  @param within_pass  passes have zeros of their own
[[nodiscard]] std::string headline_for(const Diagnosis& diagnosis, const Observations& data, const std::string& bad_run,
                                       bool within_pass);

/// What all named effects do together, outliers left out; of one alone its own numbers say it.
struct JointProof {
  double rms_after_um = 0.0;
  double held_out_rms_before_um = 0.0, held_out_rms_um = 0.0;
};

/// Whether a proof in words would be true: the candidate alone explains 1 % of the residual, and more than as many
/// columns fitted to noise would.
[[nodiscard]] bool explains_alone(const Candidate& candidate, const Diagnosis& diagnosis);

/// What the replicates of noise are called, in the plural.
[[nodiscard]] inline std::string_view name_of_replicates(const Diagnosis& diagnosis) {
  return diagnosis.noise_wanders ? "simulated data sets of noise that wanders" : "simulated noise-only data sets";
}

/// @param diagnosis  with rms, noise, all candidates and the number of noise replicates
/// @param joint  absent where fewer than two effects are named
[[nodiscard]] std::string reason_for(const Candidate& candidate, const Diagnosis& diagnosis, const Observations& data,
                                     const std::optional<JointProof>& joint);

/// @param rivals  effects that these data cannot tell from it; empty: how to confirm it
[[nodiscard]] std::string separating_measurement(const EffectInstance& effect,
                                                 const std::vector<EffectInstance>& rivals);

/// What the noise or the steps of temperature sensors hide; nothing where no effect of the answer, and nothing that is
/// left unexplained, may follow such a sensor.
/// @param unexplained  structure is left
[[nodiscard]] std::optional<std::string> sensor_noise_note(const Diagnosis& diagnosis, const Observations& data,
                                                           bool unexplained);

}  // namespace ecs::model
