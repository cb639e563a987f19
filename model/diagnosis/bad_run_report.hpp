// How a bad run is reported in an answer: before every cause.
#pragma once

#include <string>
#include <vector>

#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/investigation.hpp"

namespace ecs::model {

/// What the headline begins with where a run is bad or nearly explains what an effect does; "" where none does.
/// @param residual  of the model as given, um, a row a reading of `data`
[[nodiscard]] std::string bad_run_text(const Found& found, const Diagnosis& diagnosis, const Observations& data,
                                       const Eigen::VectorXd& residual);

/// The run comes first in `where`, whatever else the residual depends on; one that is not there yet is added.
/// @pre the search has found a bad run  @param chance  that is stated for one that is added
void put_run_first(std::vector<Dependence>& where, const Observations& data, const Found& found,
                   const Eigen::VectorXd& residual, double chance);

}  // namespace ecs::model
