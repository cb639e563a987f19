// An instrument that stands at the machine, set up for one component, and the readings that it has given.
// Does not live here: where the machine goes meanwhile (measurement.hpp, program_run.hpp), what it shows (laser.hpp).
#pragma once

#include <optional>

#include "ecs_emulator/laser.hpp"
#include "ecs_emulator/simulation.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

/// Where and how a reading is taken.
struct ReadingPlace {
  Vector3 target_mm{};
  Approach approach = Approach::forward;
  int run = 1;
  std::optional<double> passing_mm_min;  ///< feed of a reading on the fly; absent: at standstill
};

class MeasuringPost {
 public:
  /// Why `sense` along `axis` cannot be measured here with that instrument: a `usage` problem.
  [[nodiscard]] static Result<void> fits(const Simulation& simulation, Axis axis, Sense sense, InstrumentKind kind);

  /// @pre fits()
  MeasuringPost(Simulation& simulation, Axis axis, Sense sense, InstrumentKind kind);

  /// The person turns the square until the indicator shows the same at both ends of the first leg (least squares).
  /// Needed before the first reading against a square. @return false: given up
  [[nodiscard]] bool null_square(const Vector3& place_mm);

  void take(const MachineState& state, const ReadingPlace& place, const ToolPose& pose);

  [[nodiscard]] InstrumentKind kind() const { return kind_; }
  [[nodiscard]] const laser::MeasurementSet& set() const { return set_; }
  /// Machine and instrument; the caller adds what else it knows (an empty value is left out).
  void describe(std::string key, std::string value);
  [[nodiscard]] laser::MeasurementSet finished() { return std::move(set_); }

 private:
  [[nodiscard]] bool compensated() const;

  Simulation& simulation_;
  Axis axis_;
  Sense sense_;
  InstrumentKind kind_;
  Instrument instrument_;
  laser::MeasurementSet set_;
};

}  // namespace ecs::emulator
