// Where an investigation measures: it asks for one run after the other. Two workshops are there: one behind a socket
// that works by itself (socket_workshop.hpp), and a folder into which a person puts the files (watched_folder.hpp).
// Does not live here: which run is asked for (investigation.hpp).
#pragma once

#include <string>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"
#include "model/fit/model_file.hpp"
#include "model/planning/next_measurement.hpp"
#include "modules/investigation/ledger.hpp"

namespace ecs::commissioning {

struct RequestedRun {
  int number = 1;  ///< of the run in the investigation, from 1
  model::MeasurementProposal proposal;
  bool with_new_map = false;  ///< with the map active that activate() sent
};

struct RunReadings {
  laser::MeasurementSet set;
  double minutes = 0.0;  ///< waiting, setting up, measuring
};

class Workshop {
 public:
  Workshop() = default;
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  virtual ~Workshop() = default;

  /// Readings of the line that was asked for. `usage` and `refused`: this run cannot be made here, another may be;
  /// every other problem ends the investigation.
  [[nodiscard]] virtual Result<RunReadings> measure(const RequestedRun& run) = 0;
  /// Makes a map of the model, sends it and has the unit compensate with it.
  [[nodiscard]] virtual Result<void> activate(const model::Model& model) = 0;
  /// After each step.
  virtual void keep(const InvestigationStep& step) = 0;
};

}  // namespace ecs::commissioning
