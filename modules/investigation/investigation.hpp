// An investigation to its end: measure, diagnose, take the run that separates the rivals best per minute, again, until
// one cause is left; then the cause is added to the model, the machine compensated by its map and measured again.
// Does not live here: how a run is made (workshop.hpp), the diagnosis (model/diagnosis/diagnose.hpp), the choice of the
// run (model/planning/next_measurement.hpp).
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "model/planning/next_measurement.hpp"
#include "modules/investigation/ledger.hpp"
#include "modules/investigation/workshop.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

struct InvestigationOptions {
  double minutes = 0.0;  ///< that the runs may take; measuring again with the map is not counted
  model::MeasuringTimes times;
  const std::atomic<bool>* cancelled = nullptr;  ///< set by another thread: ends it with a `refused` problem
};

/// Ends where one cause is left, where nothing is missing, where no run separates what is left, or where the next run
/// would take more than the minutes that remain; the verdict and the notes say which. Problems are those of the
/// workshop and of the diagnosis.
[[nodiscard]] Result<Investigation> investigate(const model::Model& model, const params::Machine& machine,
                                                Workshop& workshop, const InvestigationOptions& options);

}  // namespace ecs::commissioning
