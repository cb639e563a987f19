// A proposed run in one sentence. Does not live here: the same as a part program (part_program.hpp).
#pragma once

#include <string>

#include "model/planning/next_measurement.hpp"

namespace ecs::model {

/// Separation that counts as one [sigma]: three, one case of 370 by chance; the convention of control charts (Shewhart
/// 1931).
inline constexpr double kSeparates = 3.0;

/// What is asked of a run.
enum class Question {
  separate,  ///< rivals from each other
  confirm,   ///< a lone cause
  see,       ///< causes that may be there unseen
  repeat,    ///< whether what is left comes back
};

/// What to measure, how, how long it takes and what it tells.
[[nodiscard]] std::string sentence_of(const MeasurementProposal& proposal, Question question);

}  // namespace ecs::model
