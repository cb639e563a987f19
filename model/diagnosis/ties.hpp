// Whether readings decide what former ones left open: an effect of a model and the alternatives kept with it, each in
// its place in turn. Does not live here: which effects form a tie (stepwise.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::model {

struct DecidedTies {
  Model model;                     ///< without the alternatives that these readings rule out
  std::vector<std::string> notes;  ///< one for each tie of which they say anything
};

/// An alternative is ruled out where χ² with it is larger by five standard deviations' worth than with the effect of
/// the model; where one of them is as much better than the effect, nothing is changed and the note says so. An
/// alternative that these readings cannot show stays.
/// @param data  all readings that are to decide, the former ones too
[[nodiscard]] Result<DecidedTies> decided_ties(const Model& model, const Observations& data);

}  // namespace ecs::model
