// Measuring the machine as the person in the workshop does: optics set up, axes parked, targets approached from both
// sides, a reading at each stop (thesis 6.3 and appendix B); or the display at a constant rate while the machine stands
// or moves. Does not live here: what an instrument shows (laser.hpp), the files (files.hpp), what readings mean (the
// host).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ecs_emulator/instruments/laser.hpp"
#include "ecs_emulator/instruments/measuring_post.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

struct MeasurementPlan {
  Axis axis = Axis::X;  ///< moving
  Sense sense = Sense::EX;
  std::optional<InstrumentKind> instrument;    ///< absent: instrument_for()
  std::vector<double> targets_mm;              ///< in the order of the first pass; at least 2, one way only
  int runs = 3;                                ///< each there and back
  bool bidirectional = true;                   ///< false: every run in the order of the targets
  PerAxis<std::optional<double>> parked_mm{};  ///< of the other axes; absent: their measurement line, else their datum
  double feed_mm_min = 2000.0;
  double dwell_s = 2.0;     ///< before each reading
  double overrun_mm = 5.0;  ///< beyond the end, before each pass
  bool on_the_fly = false;  ///< readings while passing, without a stop
  InstrumentSetting setting;
  std::optional<std::size_t> beam_broken_at;  ///< somebody steps into the beam before this reading, from 1
  // kept as metadata
  std::string date;
  std::string engineer;
  std::string name;  ///< of the plan
};

/// Targets from `from_mm` to `to_mm` in steps (the sign of the step does not count); the end is always a target.
[[nodiscard]] std::vector<double> targets_between(double from_mm, double to_mm, double step_mm);

/// Where the other axes stand meanwhile; the moving axis has no meaning here.
[[nodiscard]] Vector3 parking_place(const WorkshopMachine& description, const MeasurementPlan& plan);

struct MeasurementProgress {
  std::size_t readings_done = 0;
  std::size_t readings_total = 0;
};

/// Measures. Refuses a plan that the machine or the instrument cannot follow. `usage` problems say why.
/// The readings carry targets and errors (actual − target) in machine coordinates and the frame of docs/physics.md.
[[nodiscard]] Result<laser::MeasurementSet> measure(Simulation& simulation, const MeasurementPlan& plan,
                                                    const std::function<void(const MeasurementProgress&)>& report = {});

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
