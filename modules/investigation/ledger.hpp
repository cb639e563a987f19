// What an investigation has done and found: a step for each run, the causes that a diagnosis leaves possible, minutes
// and errors; as text and JSON. Does not live here: the work itself (investigation.hpp), how a diagnosis finds causes
// (model/diagnosis/diagnose.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/fit.hpp"
#include "modules/investigation/first_look.hpp"

namespace ecs::commissioning {

using model::SetMember;

/// The credible set that holds one candidate, likeliest first; without the zeros of runs.
[[nodiscard]] std::vector<SetMember> credible_set_of(const model::Candidate& candidate);

/// The sets of all candidates of the answer, proved or likely; empty where it has none.
[[nodiscard]] std::vector<SetMember> members_left(const model::Diagnosis& diagnosis);

/// The answer has causes, and none has a rival.
[[nodiscard]] bool causes_are_single(const model::Diagnosis& diagnosis);

/// One run, and what all readings so far say.
struct InvestigationStep {
  double minutes = 0.0;  ///< of this run: waiting, setting up, measuring
  std::string measured;  ///< what was measured, in words
  std::size_t readings = 0;
  model::Verdict verdict = model::Verdict::adequate;
  std::vector<SetMember> set;  ///< causes that are still possible; empty where nothing is named
  double rms_um = 0.0;         ///< that the model leaves of all readings so far
};

struct InvestigatedCause {
  std::string name;  ///< "cyclic:X:EX"
  std::vector<model::ParameterEstimate> parameters;
  double probability = 0.0;  ///< its share of the set that holds it
  double rms_um = 0.0;       ///< of its contribution to the readings on which it acts
};

struct Investigation {
  std::vector<InvestigationStep> steps;
  std::optional<model::Verdict> verdict;  ///< absent: nothing was measured
  std::vector<InvestigatedCause> causes;  ///< largest first
  double minutes = 0.0;                   ///< of all steps
  IsoProgramme programme;                 ///< the full programme of the same lines
  std::optional<double> rms_before_um;    ///< of the readings of the first look, each run about its mean
  /// Of the same targets measured again with the new map active; absent: no map could be made or sent.
  std::optional<double> rms_compensated_um;
  double compensated_minutes = 0.0;  ///< of measuring again; not part of `minutes`
  model::Model model;                ///< with the causes, fitted
  std::vector<std::string> notes;    ///< what was left out, and why
};

/// The head of the table and the lines of each step, without the last line end.
[[nodiscard]] std::string ledger_head();
/// @param number  of the step, from 1 @param total_minutes  up to and with this step
[[nodiscard]] std::string ledger_line(std::size_t number, const InvestigationStep& step, double total_minutes);
/// {"minutes", "measured", "readings", "verdict", "set", "rms_um"}; no text.
[[nodiscard]] Cell step_cell(const InvestigationStep& step);
/// In JSON the keys of `investigate` in docs/verbs.md; in the text verdict, causes, minutes against the programme,
/// errors before and after.
[[nodiscard]] Cell investigation_cell(const Investigation& investigation);
[[nodiscard]] std::string summary_text(const Investigation& investigation);  ///< the text of it

}  // namespace ecs::commissioning
