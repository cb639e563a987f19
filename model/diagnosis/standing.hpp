// The part in the answer of what a search has found: candidates in order of evidence, how sure each is, the verdict,
// and what keeps an effect from being proved. Internal to model/ (Eigen). Does not live here: the numbers and words
// told of each candidate (diagnose.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/trial.hpp"

namespace ecs::model {

/// Candidates listed: what a person reads.
inline constexpr std::size_t kMostListed = 12;
/// A dependence that noise alone shows more often is not telling.
inline constexpr double kTellingChance = 1e-3;
/// Probabilities are given down to 1e-300: below, a double ends.
inline constexpr double kMostDigits = 300.0;
[[nodiscard]] inline double probability_from(double minus_log_p) {
  return std::pow(10.0, -std::min(kMostDigits, minus_log_p));
}

struct ReportInput {
  const Model& model;
  const Regressors& regressors;
  const Base& base;
  const std::vector<OwnTerm>& own;  ///< where the solution has them
  const LinearProblem problem;      ///< of the model with them
  const Found& found;
  const DiagnoseOptions& options;
};

/// What is not excluded of an effect that is likely, and the measurement that would decide.
struct Doubt {
  std::string but, decide;
};

/// The candidates in the order in which they are ranked, each with its part in the answer.
struct RankedCandidate {
  EffectInstance effect;
  Choice choice;
  Standing standing = Standing::possible;
  std::vector<EffectInstance> rivals;
  double probability = 0.0;
  std::vector<SetMember> set{};
  std::vector<Choice> values{};  ///< of the searched parameter that fit as well
  std::optional<double> e_value{};
  Alias alias = Alias::none;
  double p_value = 1.0, p_value_alone = 1.0;
  std::vector<RivalOfPart> in_part{};
  double false_naming = 1.0;  ///< as of Candidate, by noise that does not wander
  bool found = false;         ///< as of Candidate
  Doubt doubt{};              ///< of what is likely
  std::string apart{};        ///< as of Candidate
  [[nodiscard]] bool in_answer() const { return standing != Standing::possible; }
};

/// The verdict, and the candidates in their order, each with its standing.
struct Answer {
  Verdict verdict = Verdict::adequate;
  std::vector<RankedCandidate> order;
  std::string cannot_tell;  ///< why the verdict is that; else ""
  std::string other_unit;   ///< a line in another unit than others, which effects do not explain, as sentences; else ""
  bool explained = false;   ///< what was found leaves noise, and nothing objects to it
  std::vector<std::string> apart;  ///< lines judged alone, the others together without them: "Z:EZ" (apart.hpp)
};
[[nodiscard]] Answer answer_of(const ReportInput& in);

/// Why the best effects of the library do not count as an explanation.
[[nodiscard]] std::string why_not_explained(const Found& found);
/// Why no effect is named although something speaks against those found: of the one that explains the most, else the
/// objection.
[[nodiscard]] std::string why_not_named(const ReportInput& in);

/// Share of what is above noise that more columns than those of the model explain, each reading in units of its noise.
[[nodiscard]] double share_explained(const ReportInput& in, const LinearProblem& with);

}  // namespace ecs::model
