// What to measure next: the run that tells rivals apart best per minute, and whether a planned set can determine a
// model at all. Does not live here: the diagnosis that leaves the rivals (diagnose.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/diagnose.hpp"

namespace ecs::model {

/// One run as a person sets it up.
struct MeasurementProposal {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  std::vector<double> targets_mm;
  Vector3 parked_mm{};  ///< of the other axes
  bool bidirectional = true;
  int runs = 1;
  double feed_mm_min = 2000.0;
  std::optional<double> load_kg;
  std::string condition;  ///< "as now", "warm", "cold", "compensation off", …
  double minutes = 0.0;
  double separation_sigma = 0.0;  ///< of the worst pair of rivals, from the best mimicking
  std::string sentence;
};

/// Proposals, best separation per minute first; empty where nothing separates (said in `notes`).
struct NextMeasurement {
  std::vector<std::string> rivals;
  std::vector<MeasurementProposal> proposals;
  std::vector<std::string> notes;
};
[[nodiscard]] NextMeasurement next_measurement(const Model& model, const Observations& data,
                                               const Diagnosis& diagnosis);

/// Whether readings at the rows of `plan` (their values do not count) determine the model.
struct PlanCheck {
  std::vector<EffectFit> effects;  ///< parameters with the sigma to expect
  double condition = 1.0;
  std::vector<std::string> undetermined;
  bool determines = false;
};
/// @param noise_um  standard deviation of one reading to expect
[[nodiscard]] Result<PlanCheck> check_plan(const Model& model, const Observations& plan, double noise_um);

}  // namespace ecs::model
