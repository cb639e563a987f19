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

/// "tells backlash:X:EX from servo_lag:X:EX: 12.0 sigma, 9 min"; the surest pairs first.
[[nodiscard]] std::string what_it_tells(const MeasurementProposal& proposal, Question question);

/// What to measure and how, in one sentence.
[[nodiscard]] std::string sentence_of(const MeasurementProposal& proposal);

}  // namespace ecs::model
