// Which effect is missing from a model: every effect of the library is tried on what the model leaves, ranked by
// evidence, proved on readings it was not fitted to and weighed against noise made for this very data set.
// Does not live here: fitting a given model (model/fit/fit.hpp), what to measure next
// (model/planning/next_measurement.hpp).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::model {

enum class Verdict : std::uint8_t {
  adequate,               ///< what is left is noise
  missing_effect,         ///< the first candidates bring the residual down to noise
  partly_explained,       ///< proved candidates explain at least half of what is above noise, but more is left
  unexplained_structure,  ///< the residual depends on something that no proved effect explains
  likely_effect,          ///< nothing is proved, and the first candidate is likely
  cannot_tell,            ///< too few readings, an undetermined base, or a lack of fit beside residuals like noise
};
[[nodiscard]] std::string_view name_of(Verdict verdict);
/// "an effect is missing": of plots and tables.
[[nodiscard]] std::string_view title_of(Verdict verdict);

/// How sure a candidate is.
enum class Standing : std::uint8_t {
  possible,  ///< listed
  likely,    ///< explains what is above noise, or half of it, but something else is not excluded
  proved,    ///< by readings that it was not fitted to
};
[[nodiscard]] std::string_view name_of(Standing standing);

/// Defaults: of 400 replicates two are beyond a chance of 0.5 %, and the fitted tail counts further; 0.5 % are five
/// false names in a thousand adequate machines; three effects and 4000 readings bound the time to seconds. All are
/// choices.
struct DiagnoseOptions {
  std::size_t noise_replicates = 200;            ///< simulated data sets of noise alone that a name must beat
  double false_naming_limit = 0.005;             ///< a cause is named only below this family-wise probability
  std::size_t most_effects = 3;                  ///< that may be missing at once
  std::size_t largest_search = 4000;             ///< readings searched; of larger sets an even choice, confirmed on all
  bool plain = false;                            ///< no outliers
  const std::atomic<bool>* cancelled = nullptr;  ///< set by another thread: `refused`, soon; null: nobody stops it
  bool p_values = false;                         ///< also the p-value of each effect found (e_value.hpp)
};

/// A member of a credible set.
struct SetMember {
  std::string name;  ///< "effect:axis:sense-or-code"
  double probability = 0.0;
  std::string place{};  ///< the same with approach and sensors, as people read it
};

/// Where an effect was tried alone beside the model: enough to try it there again.
struct TriedAt {
  double value = 0.0;                     ///< of its searched parameter; 0 where it has none
  std::vector<std::size_t> coefficients;  ///< those used, by their number
};

/// A free searched parameter of one of the model's own effects, at its best beside the effects found.
struct OwnTerm {
  std::size_t effect = 0;  ///< number in the model, from 0
  double value = 0.0;
};

/// How well one effect alone beside the model explains the readings.
struct TrialNumbers {
  double rms_after_um = 0.0;        ///< with this effect added, all readings
  double explained = 0.0;           ///< 1 − (rms_after/rms)², outliers left out
  double kept_rms_before_um = 0.0;  ///< as rms, outliers left out
  double kept_rms_after_um = 0.0;   ///< as rms_after, outliers left out
  double explainable_share = 0.0;  ///< of what is above noise, outliers left out: (before² − after²)/(before² − noise²)
  /// `explained` for a reader: a fit by weights can raise the rms a little.
  [[nodiscard]] double shown_explained() const { return std::max(0.0, explained); }
};

/// Of an effect along several directions: another one that explains as much as some of them do.
struct RivalOfPart {
  EffectInstance kept, part, other;  ///< the effect along the others; along those; what may take their place
};

struct Candidate : TrialNumbers {
  EffectInstance effect;                      ///< with `fitted` values and its curve
  std::vector<ParameterEstimate> parameters;  ///< with sigma where they are determined
  double size_alone = 0.0;                    ///< the first parameter without the other effects of the answer
  bool named = false;                         ///< proved
  Standing standing = Standing::possible;
  std::string but;     ///< of what is likely: what is not excluded, in words; else ""
  std::string decide;  ///< of what is likely: the measurement that would decide it; else ""
  /// Part of the answer: proved, or likely.
  [[nodiscard]] bool in_answer() const { return named || standing == Standing::likely; }
  double p_value = 1.0;                          ///< nominal
  double false_naming = 1.0;                     ///< chance that noise alone makes any candidate look as good
  std::optional<double> held_out_rms_um;         ///< fitted on some runs or blocks, tested on the others
  std::optional<double> held_out_rms_before_um;  ///< the same without the effect
  double probability = 0.0;                      ///< among the alternatives for the same part of the residual, 0 … 1
  std::vector<SetMember> set;     ///< the fewest alternatives that hold the cause with 0.99, likeliest first
  std::optional<double> e_value;  ///< e_value.hpp, divided by the number of candidates tried; absent: no split shows it
  /// By name: all values that fit within Δχ² 9 (a period); the interval (a place).
  std::map<std::string, std::vector<double>> parameters_set;
  bool found = false;  ///< of the best set found: e-values of its other members are weighed beside this one
  TriedAt tried_at;
  std::string apart{};      ///< the line of Diagnosis::apart on which alone it was judged; else ""
  std::size_t skipped = 0;  ///< readings without a cell that it needs
  std::vector<std::string> indistinguishable_from;  ///< "effect:axis:sense-or-code"
  std::vector<EffectInstance> rivals;               ///< the same, with approach and sensors
  std::vector<RivalOfPart> in_part;                 ///< none of them rivals of the whole
  /// Whether a rival is in the credible set. The others fit as well, but are improbable (more parameters, a rare
  /// cause).
  [[nodiscard]] bool is_open(const EffectInstance& rival) const;
  [[nodiscard]] std::vector<EffectInstance> open_rivals() const;
  std::string because;           ///< the evidence, in words
  std::string next_measurement;  ///< one sentence
};

struct Dependence {
  std::string variable;         ///< "x_mm", "approach", "run", "time_s", …
  double strength = 0.0;        ///< share of the residual variance, 0 … 1
  double p_value = 1.0;         ///< against noise alone
  std::vector<double> at;       ///< shape: centres of bins of the variable
  std::vector<double> mean_um;  ///< shape: mean residual there
  std::string looks_like{};     ///< shape in words, where the data prove one and it is no effect; else ""
};

/// What is worth trying although not proved: all that is likely beside what is proved, else a group that predicts.
struct ProposedAddition {
  std::vector<std::string> effects;                            ///< places, as `ecs model add` takes them
  double held_out_rms_before_um = 0.0, held_out_rms_um = 0.0;  ///< on readings left out, without and with them
};

/// One question about what is left beside the answer; docs/model.md says when each answer is true.
struct LeftProperty {
  std::string property;  ///< "direction", "position", "frame", "growth", "session", "clock", "sign", …
  std::string is;        ///< "odd", "load_kg", …; "": withheld
  std::string because;   ///< the evidence in numbers, or why nothing is told
  std::string measure;   ///< what would tell; "" where it is told or nothing is known to
};

/// An effect of the user's kind that takes most of what is left.
struct ProposedFormula {
  EffectInstance effect;  ///< one formula, its parameters with the start that fits
  std::string why;
  double rms_after_um = 0.0;  ///< of all readings, with it and the answer
  double held_out_rms_before_um = 0.0, held_out_rms_um = 0.0;
};

/// A run, or all readings from one on, that differ from the others.
struct DifferentRun {
  int run = 0;
  bool from_there_on = false;
  bool is_shifted = true;  ///< false: it scatters more, about the same mean
  std::string text;        ///< the sentences of the headline about it
};
struct Diagnosis {
  std::size_t observations = 0;
  double rms_um = 0.0;                                                           ///< of its residual
  double rms_after_um = 0.0;                                                     ///< with every effect of the answer
  double kept_rms_um = 0.0, kept_rms_after_um = 0.0;                             ///< the same without the outliers
  SizesByUnit rms_by_unit, rms_after_by_unit, kept_by_unit, kept_after_by_unit;  ///< these four
  PureError noise;
  std::optional<LackOfFit> lack_of_fit;        ///< of the model as it is
  std::optional<LackOfFit> lack_of_fit_after;  ///< with every effect of the answer
  Verdict verdict = Verdict::adequate;
  std::string headline;  ///< the answer in words: a bad run, then what is wrong, how much and where
  std::optional<DifferentRun> different_run;
  std::string reservation;       ///< what these data cannot show at all, so that nothing found means little; else ""
  std::string cannot_tell;       ///< why that is the verdict; else ""
  bool best_sum_leaves = false;  ///< structure: the best sum of effects was fitted, and what it leaves is no noise
  std::vector<Candidate> candidates;  ///< proved ones first, then likely ones
  std::vector<Dependence> where;      ///< strongest first
  std::vector<int> outliers;          ///< row numbers
  std::vector<std::string> notes;     ///< skipped rows, what could not be tried and why, what was assumed
  std::size_t candidates_tried = 0;
  std::vector<OwnTerm> own_terms;
  /// Lines that no effects explain, "Z:EZ": each is judged alone, and the others together without them.
  std::vector<std::string> apart{};
  std::size_t noise_replicates = 0;   ///< that were searched
  bool noise_wanders = false;         ///< false_naming is that of noise which wanders as the readings do
  std::size_t replicates_wanted = 0;  ///< searched unless the first ones already show that noise explains the readings
  std::optional<ProposedAddition> add;  ///< where something is likely, or a group predicts
  std::vector<LeftProperty> left;       ///< where structure is left
  std::optional<ProposedFormula> formula;
};

/// Refuses data without readings, a model that cannot act on them, and a flag that was set.
[[nodiscard]] Result<Diagnosis> diagnose(const Model& model, const Observations& data,
                                         const DiagnoseOptions& options = {});

/// A cause of the answer, proved or likely, as one machine of many needs it.
struct NamedCause {
  std::string name;  ///< "effect:axis:sense-or-code"
  double probability = 0.0;
  std::optional<double> e_value;  ///< as of Candidate
  double false_naming = 1.0;
  double p_value = 1.0;  ///< beside the other causes
  Standing standing = Standing::proved;
  std::vector<std::string> rivals;  ///< that these data cannot distinguish from it
};
struct NamedCauses {
  Verdict verdict = Verdict::adequate;
  std::vector<NamedCause> causes;
  double p_value = 1.0;  ///< that nothing is missing: the least of the causes, each alone beside the model
};
/// What diagnose() names, without the fits, proofs and words for those who read it: they are most of its time.
[[nodiscard]] Result<NamedCauses> named_causes(const Model& model, const Observations& data,
                                               const DiagnoseOptions& options = {});

}  // namespace ecs::model
