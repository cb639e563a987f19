// Waves and curves that stand for something else, and a wave whose phase is another in every pass: no effect of the
// library, and no noise. Internal to model/ (Eigen).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/data/observations.hpp"
#include "model/fit/search.hpp"

namespace ecs::model {

/// Why the waves among these effects are no cause although their sum may reach the noise, as the end of a sentence; ""
/// where nothing speaks against them. Anything can be written as enough waves: several unrelated periods none of which
/// is a pitch of the machine, neighbouring periods that beat, a wave that needs a step to help.
/// @param proved  for each effect: by readings it was not fitted to; one wave and one step so, with no other shape of
/// position on their line, are two causes
/// @param periods  for each effect: how many values of its period fit as well; of many one is near a pitch by chance,
/// so that beside two other shapes on its line it counts as none. As for one period where it is empty
[[nodiscard]] std::string objection_to_waves(const Observations& data, const std::vector<Family>& families,
                                             const std::vector<Choice>& chosen, const std::vector<bool>& proved,
                                             const std::vector<std::size_t>& periods = {});

/// How a wave found changes its size or its phase along the travel or in time.
struct ChangeOfWave {
  std::string reason;  ///< as the end of a sentence
  double gain = 0.0;   ///< what it explains beside the wave
};
/// Nothing where a wave changes by no more than noise does.
/// @param space  with all effects absorbed
[[nodiscard]] std::optional<ChangeOfWave> change_of_wave(const Regressors& regressors, const Whitener& whitener,
                                                         const Space& space, const Family& family, const Choice& choice,
                                                         double noise_freedom);

/// A curve explains nineteen twentieths of the shape that it is: a choice.
inline constexpr double kLeastBesideCurve = 0.05;

/// Why a curve found is no smooth one, as the end of a sentence: a value of its own at every target explains clearly
/// more; else "".
/// @param space  with all effects absorbed
[[nodiscard]] std::string objection_to_smoothness(const Regressors& regressors, const Whitener& whitener,
                                                  const Space& space, const Family& family, const Choice& choice,
                                                  double noise_freedom);

/// Whether each wave among these effects is a pitch of the machine, as below, or all are whole fractions of one period
/// and no step stands on the line of one.
[[nodiscard]] bool are_pitches_or_fractions(const std::vector<Family>& families, const std::vector<Choice>& chosen);

/// Whether two waves of one line, of unlike periods or in unlike approaches, among these effects are no pitch of the
/// machine: a shape that repeats, of which they are the first terms, or lost motion that does, rather than two causes.
[[nodiscard]] bool are_shape_that_repeats(const std::vector<Family>& families, const std::vector<Choice>& chosen);

/// Turns a mm of a wave as its targets show it: at even ones it looks like a slower wave (Nyquist).
[[nodiscard]] double frequency_seen(const Observations& data, const Family& family, double period);

/// Whether an effect is no wave, or its period is a pitch of the machine or one of its parts and multiples.
[[nodiscard]] bool is_pitch_or_no_wave(const Family& family, const Choice& choice);

/// A period that is, to a percent, a pitch of the machine, a tenth to ten times it.
struct PitchMatch {
  double expected_mm = 0.0;  ///< by the machine file
  int times = 1, parts = 1;  ///< of the pitch: times/parts
  bool is_of_scale = false;  ///< of its scale, else of its screw
  bool is_excluded = false;  ///< the period is another one beyond four standard deviations
};
/// Nothing for other effects, for rotary axes, and where the machine file gives no such pitch; the screw comes first.
/// @param sigma_mm  of the period; absent: nothing is excluded
[[nodiscard]] std::optional<PitchMatch> pitch_matching(const EffectInstance& wave,
                                                       const std::optional<double>& sigma_mm, const Observations& data);

/// Whether two waves act at one place with one period in unlike approaches: one cause that differs between the
/// directions, for both, forward and reverse are each made up of the two others.
[[nodiscard]] bool are_one_wave(const EffectInstance& one, const EffectInstance& other);

/// Of a rotary axis the whole number of waves a turn; 0 of other effects.
[[nodiscard]] double waves_a_turn(const EffectInstance& wave);

/// A wave of an answer with its parameters.
struct NamedWave {
  EffectInstance effect;
  std::vector<ParameterEstimate> parameters;
  /// @pre it has both
  [[nodiscard]] const ParameterEstimate& size() const;
  [[nodiscard]] const ParameterEstimate& period() const;
};
/// The larger of a wave and its second harmonic, which has half the period; any other effect as it is.
[[nodiscard]] NamedWave larger_wave(const NamedWave& wave);
/// The other of the two; nothing where there is no second harmonic.
[[nodiscard]] std::optional<NamedWave> smaller_wave(const NamedWave& wave);

/// Steps [deg] in a turn, where it is a whole number of them: so many waves a turn have one value at all targets, and n
/// waves look like so many less n.
[[nodiscard]] std::optional<int> steps_a_turn(double step_deg);

/// The two longest periods that targets at equal steps cannot distinguish from that of a wave, because it turns once
/// more or once less from target to target; none where it is a pitch of the machine.
[[nodiscard]] std::vector<double> aliases_of(const EffectInstance& wave, const Observations& data);

/// A curve that was found on so few targets that no wave was looked for there.
[[nodiscard]] bool may_be_wave(const EffectInstance& curve, const Observations& data);

struct FreeWave {
  double period = 0.0;
  std::string_view unit;     ///< of the period: "mm" or "deg" (Observations::unit_along())
  double minus_log_p = 0.0;  ///< base 10, for having been sought among all frequencies
};
/// The strongest wave along the moving axis whose phase and size differ from pass to pass; nothing where noise shows
/// one as strong in one of a million sets.
/// @param residual  whitened, with everything found absorbed  @param left_out  outliers, not counted
[[nodiscard]] std::optional<FreeWave> free_wave(const Observations& data, const Eigen::VectorXd& residual,
                                                const std::vector<bool>& left_out);

/// Period of a wave in time of more than a minute that is likelier than all effects found together, by a hundredfold
/// [s]. Each channel has its own sine and cosine, or none.
/// @param alone  with the model absorbed and nothing found  @param score  of the effects together beyond it
[[nodiscard]] std::optional<double> period_in_time_s(const Observations& data, const Whitener& whitener,
                                                     const Space& alone, double score);
/// Why no effect is a cause then, as the end of a sentence.
[[nodiscard]] std::string objection_by_wave_in_time(double period_s);
/// Whether such a wave explains more than half of the mean square of the residual in a channel of at least 30 readings:
/// turbulence has no period. @param residual  of the model, um or um/m  @param left_out  outliers, not counted
[[nodiscard]] bool is_mostly_wave_in_time(const Observations& data, double period_s, const Eigen::VectorXd& residual,
                                          const std::vector<bool>& left_out);

}  // namespace ecs::model
