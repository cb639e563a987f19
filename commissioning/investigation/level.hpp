// The slope of a line against a straight edge, which is that of its set-up: taken out of a model before a map is made.
// Does not live here: the slope that each run has in the fit (readings.hpp).
#pragma once

#include "base/result.hpp"
#include "commissioning/investigation/first_look.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {

/// The usual slope of the line is set so that all that a map carries of it is level over the travel (least squares):
/// then compensating the line does not turn the axis, from which squareness counts. A slope that a person gave stays.
[[nodiscard]] Result<void> make_level(model::Model& model, const InvestigatedLine& line,
                                      const params::Machine& machine);

}  // namespace ecs::commissioning
