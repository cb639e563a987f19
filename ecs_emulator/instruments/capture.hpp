// Dynamic capture: the instrument's display at a constant rate while the machine stands or moves.
// Does not live here: measurements at targets (measurement.hpp), the files (measurement_files.hpp).
#pragma once

#include <optional>
#include <string>

#include "ecs_emulator/instruments/measuring_post.hpp"

namespace ecs::emulator {

inline constexpr std::size_t kMostSamples = 200'000;

struct CapturePlan {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  std::optional<InstrumentKind> instrument;  ///< absent: instrument_for()
  double rate_Hz = 1000.0;                   ///< at most one sample in a period of the machine's control
  double seconds = 10.0;
  std::optional<double> to_mm;  ///< the axis starts to move there as the capture begins; absent: the machine stands
  double feed_mm_min = 2000.0;
  InstrumentSetting setting;
  std::string date;
  std::string engineer;
};

/// Captures from where the machine stands. Readings are displacements since the first sample, um or um/m, with `time_s`
/// from there; their position is where the capture began. `usage` problems say why a plan cannot be followed.
[[nodiscard]] Result<laser::MeasurementSet> capture(Simulation& simulation, const CapturePlan& plan);

}  // namespace ecs::emulator
