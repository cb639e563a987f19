// The errors of rotary axes that a fit found, as `ecs volume --rotary` takes them: location errors and error motions
// with their standard uncertainties. Does not live here: the file (volume/rotary_errors.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "model/fit/fit.hpp"
#include "params/machine.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::commissioning {

struct FittedRotary {
  volume::RotaryErrors errors;
  std::vector<std::string> left_out;  ///< effects that are no error of a rotary axis, or that the fit did not determine
  std::vector<std::string> not_told;  ///< location errors that the readings do not tell from what was fitted, in words
};

/// Error motions every 5 deg over the travel of the machine file, else over a turn; of a wave the standard uncertainty
/// is that of its amplitude. A location error that the readings do not tell from what was fitted (another location
/// error, the place of ball or tool) is 0; its standard uncertainty and that of the other location error cover every
/// share that each may have of the sum, and a tie keeps the sum as certain as it is. Refused: nothing of the model is
/// an error of a rotary axis.
[[nodiscard]] Result<FittedRotary> fitted_rotary(const model::Model& model, const model::Fit& fit,
                                                 const std::optional<params::Machine>& machine,
                                                 const model::Observations& data);

}  // namespace ecs::commissioning
