// A hidden case: what was hidden, what a diagnosis answered, and whether that is right.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {

/// One hidden effect. Text parts are empty, approach and sensor absent, where the truth does not give them.
struct HiddenEffect {
  std::string name;  ///< "cyclic:X:EX"
  std::optional<model::ApproachMode> approach;
  std::string sensor;
  std::string sensor2;
  std::map<std::string, double> parameters;
  double rms_um = 0.0;
  double snr = 0.0;
};

enum class HiddenKind { blank, single, pair, out_of_library, confounded };
[[nodiscard]] std::string_view name_of(HiddenKind kind);

struct HiddenTruth {
  HiddenKind kind = HiddenKind::blank;
  double noise_um = 0.0;
  std::vector<HiddenEffect> effects;
  std::vector<std::string> group;      ///< of a confounded case
  std::vector<std::string> variables;  ///< of structure outside the library
  double true_model_rms_um = 0.0;      ///< 0: not known
  std::string text;                    ///< one plain sentence
  std::string json;                    ///< as the file has it
};

/// From `truth.sealed` or `truth.json` of the folder; refuses a folder without either and a truth of another form.
[[nodiscard]] Result<HiddenTruth> truth_of(const std::string& folder);

/// A candidate as a diagnosis tells it.
struct FoundEffect {
  model::EffectInstance effect;
  bool named = true;               ///< or likely
  std::vector<std::string> group;  ///< indistinguishable_from
  std::map<std::string, double> parameters;
  std::map<std::string, double> sigma;
};
struct FoundAnswer {
  std::string verdict;
  std::vector<FoundEffect> candidates;
  std::vector<std::string> where;
  std::optional<double> rms_after_um;
};
/// @param text  the JSON of `ecs model diagnose --json` (docs/verbs.md) @param file  as problems name it
[[nodiscard]] Result<FoundAnswer> answer_in(std::string_view text, const std::string& file);

/// A hidden number beside the one found.
struct ParameterScore {
  std::string effect;
  std::string name;
  double hidden = 0.0;
  double found = 0.0;
  std::optional<double> sigma;
  [[nodiscard]] std::optional<double> sigmas_off() const;  ///< (found − hidden)/sigma
};

struct Score {
  bool right = false;
  std::string why;  ///< in words
  std::vector<ParameterScore> parameters;
  std::optional<double> rms_ratio;  ///< rms after ÷ rms of the true model
};

/// blank: verdict adequate. single: missing_effect or likely_effect, and the first candidate is the effect or lists it.
/// pair: both among the named candidates or in their groups. out_of_library: unexplained_structure. confounded: the
/// first candidate with its group is exactly the group. Approach and sensor must agree where the truth gives one.
[[nodiscard]] Score score_of(const HiddenTruth& truth, const FoundAnswer& answer);

}  // namespace ecs::commissioning
