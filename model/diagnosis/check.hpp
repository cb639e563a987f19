// Whether a diagnosis holds: its numbers recomputed on the same readings from the effects that it names, without the
// search. Does not live here: the diagnosis (diagnose.hpp), how it is kept as a file (commissioning/models/).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/diagnosis/diagnose.hpp"

namespace ecs::model {

/// What a diagnosis says of the model, of the named effects together, and of each.
struct Claim {
  std::size_t observations = 0;
  double rms_um = 0.0;
  double rms_after_um = 0.0;
  std::size_t candidates_tried = 0;
  bool plain = false;  ///< no outliers (DiagnoseOptions)
  std::vector<OwnTerm> own_terms;
  std::vector<std::string> apart;  ///< as Diagnosis
  /// Named ones, and the others of the best set found. Of `effect` the place, approach and sensors are read.
  std::vector<Candidate> candidates;
};

/// A number of the answer, and what it is. Absent: null in the answer; cannot be computed.
struct CheckedNumber {
  std::string name;  ///< "rms_um", "cyclic:X:EX e_value"
  std::optional<double> claimed;
  std::optional<double> recomputed;
  bool holds = false;
};

struct Check {
  std::vector<CheckedNumber> numbers;
  std::vector<std::string> objections;  ///< what could not be recomputed at all, and why
  [[nodiscard]] bool holds() const;
};

/// Numbers may differ by these shares: rounding of another processor or library. ln of an e-value may differ by its
/// share and its part more, for the noise is settled here beside the effects of the answer alone. A parameter may
/// differ by its part of its standard deviation too, where a fit ends.
inline constexpr double kNumberTolerance = 1e-6, kLnTolerance = 0.02, kLeastLnTolerance = 0.1, kSigmaTolerance = 0.01;

/// Refits the model alone and with the effects named. Refuses what diagnose() refuses.
[[nodiscard]] Result<Check> checked(const Model& model, const Observations& all, const Claim& claim);

}  // namespace ecs::model
