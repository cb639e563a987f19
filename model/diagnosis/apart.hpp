// Lines that no effects explain, judged apart from the others: a shape of one line that is in no library hides no cause
// on another one. Internal to model/ (Eigen). Does not live here: how readings are searched (investigation.hpp), how an
// answer is reported (diagnose.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/diagnosis/standing.hpp"

namespace ecs::model {

/// Number of axes along which readings were taken: of each as many effects may be missing.
[[nodiscard]] std::size_t axes_moved(const Observations& data);

/// The search on all these readings, of large sets on an even choice.
[[nodiscard]] Result<Found> found_in(const Model& model, const Regressors& regressors, const Base& base,
                                     const DiagnoseOptions& options);
/// The model's free searched parameters at their best beside what was found.
[[nodiscard]] std::vector<OwnTerm> own_terms_of(const Found& found, const Base& base);

/// Rows of the readings that are judged together: first those of all other lines, then those of each line apart.
/// @param apart  as Answer; lines that these readings do not have are ignored
[[nodiscard]] std::vector<std::vector<std::size_t>> parts_of_lines(const Observations& data,
                                                                   const std::vector<std::string>& apart);

struct JudgedApart {
  Answer answer;             ///< with `apart`
  std::vector<OwnTerm> own;  ///< each from the part on which it acts
};
/// Where effects do not explain all readings, but all those of some lines: the answer about these lines together, and
/// about each other line alone. A line is an axis and a sense, wherever it lies. Nothing where these lines show no
/// cause, where all lines or none are explained alone, where a line is in another unit, and for paths, balls and points
/// in space.
[[nodiscard]] Result<std::optional<JudgedApart>> judged_apart(const ReportInput& whole, const Answer& answer);

}  // namespace ecs::model
