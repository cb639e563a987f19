// What is left beside every effect of an answer, question by question: what it depends on and what it does not, each
// told only where its opposite is excluded; and a formula over the columns of the readings that takes most of it.
// Internal to model/ (Eigen). Does not live here: whether anything is left (structure.hpp), its shape (shape.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/trial.hpp"

namespace ecs::model {

/// Proposed formulas are named so, with a number.
inline constexpr std::string_view kProposedName = "formula";

struct Left {
  std::vector<LeftProperty> properties;    ///< empty: too few readings, or too little above noise, to ask
  std::optional<ProposedFormula> formula;  ///< where it predicts readings that it was not fitted to
};

/// Looks at the readings of one sense along one axis, those that most is left of; paths and chains are not looked at.
/// @param problem  of the model with every effect of the answer  @param with  its fit
[[nodiscard]] Left what_is_left(const Model& model, const Observations& data, const LinearProblem& problem,
                                const FittedWith& with);

/// A sentence where something is found in a sense whose error a proposed formula describes without a cause, for it may
/// be part of the same error; else "".
[[nodiscard]] std::string beside_formulas(const Model& model, const Diagnosis& diagnosis);

}  // namespace ecs::model
