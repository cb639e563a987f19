// How a displacement at one place follows the temperatures of several warm-ups: a sum of sensors (static), and the same
// with first-order lags of them, each sensor with time constants and signs of its own. Sensors and lags are chosen by
// leaving out whole runs, never by readings of the run that is predicted (nested cross-validation, M. Stone, J. R.
// Statist. Soc. B 36 (1974) 111). Does not live here: one sensor at a time (laser/analysis/growth.hpp), effects of a
// model (model/effects/thermal_drift.cpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// What tests over time say of a reading without a time.
inline constexpr const char* kTimeIsNeeded =
    "time_s: expected the time of each reading, found none. Add a column time_s [s] to the measurement CSV, or "
    "read the log of the instrument with --columns \"time_s=...\"";

/// Where the displacement of a run counts from.
enum class RunZero {
  first_reading,  ///< and the temperatures too
  of_run          ///< a constant of its own for each run, the predicted one too: only the shape over time counts
};

/// One column of a law.
struct ThermalTerm {
  std::string sensor;  ///< column
  double lag_s = 0.0;  ///< time constant of a first-order delay; 0: none
  double um_per_degC = 0.0;
};

/// A law and how well it predicts.
struct ThermalLaw {
  std::vector<ThermalTerm> terms;  ///< fitted to all runs
  double rms_um = 0.0;             ///< of all readings, fitted to all runs
  double left_out_rms_um = 0.0;    ///< each run predicted by what the others chose and fitted
  std::vector<double> run_rms_um;  ///< the same of each run
};

struct ThermalRun {
  int run = 1;
  std::size_t readings = 0;
  std::vector<std::string> beyond;  ///< sensors that leave the temperatures of the other runs, with how far [degC]
};

struct ThermalTest {
  std::string file;
  std::vector<ThermalRun> runs{};
  std::vector<std::string> sensors{};
  double raw_rms_um = 0.0;    ///< from the first reading of each run
  ThermalLaw plain{};         ///< every sensor without lags, from the first reading
  ThermalLaw lagged{};        ///< chosen, from the first reading
  ThermalLaw plain_shape{};   ///< every sensor without lags, zero of each run
  ThermalLaw lagged_shape{};  ///< chosen, zero of each run
};

/// @param set  one sense at one place, `run`, `time_s`, temperatures in every reading. Refused: fewer than four runs,
///   fewer than ten readings in a run, no temperature
[[nodiscard]] Result<ThermalTest> thermal_test_of(const MeasurementSet& set);

}  // namespace ecs::laser
