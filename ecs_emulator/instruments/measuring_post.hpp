// An instrument that stands at the machine, set up for one component, and the readings that it has given.
// Does not live here: where the machine goes meanwhile (measurement.hpp, ecs_emulator/part_programs/run.hpp), what it
// shows (laser.hpp).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/result.hpp"
#include "ecs_emulator/instruments/laser.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

/// Where and how a reading is taken.
struct ReadingPlace {
  Vector3 target_mm{};
  Approach approach = Approach::forward;
  int run = 1;
  std::optional<double> passing_mm_min;  ///< feed of a reading on the fly; absent: at standstill
  double stood_s = 1e9;                  ///< since the machine last moved
};

/// A measurement that the machine or its instruments cannot make.
[[nodiscard]] inline tl::unexpected<Problem> refused(std::string message) {
  return problem(ProblemKind::usage, std::move(message));
}

class MeasuringPost {
 public:
  /// Why `sense` along `axis` cannot be measured here with that instrument, set up so: a `usage` problem.
  [[nodiscard]] static Result<void> fits(const Simulation& simulation, Axis axis, Sense sense, InstrumentKind kind,
                                         const InstrumentSetting& setting = {});

  /// @pre fits()
  MeasuringPost(Simulation& simulation, Axis axis, Sense sense, InstrumentKind kind,
                const InstrumentSetting& setting = {});

  /// The person turns the square until the indicator shows the same at both ends of the first leg (least squares).
  /// Needed before the first reading against a square. @return false: given up
  [[nodiscard]] bool null_square(const Vector3& place_mm);

  /// Nothing is taken once the beam was lost.
  void take(const MachineState& state, const ReadingPlace& place, const ToolPose& pose);

  /// Somebody steps into the beam before reading number `reading` (from 1). No beam, no effect: level, square.
  void interrupt_beam_at(std::size_t reading) { interrupted_at_ = reading; }
  /// Where the beam was lost, in words: the counter has lost its place, the readings are worth nothing.
  [[nodiscard]] const std::optional<std::string>& lost() const { return lost_; }

  [[nodiscard]] InstrumentKind kind() const { return kind_; }
  [[nodiscard]] const LaserSettings& settings() const { return settings_; }
  [[nodiscard]] const laser::MeasurementSet& set() const { return set_; }
  /// Machine and instrument; the caller adds what else it knows (an empty value is left out).
  void describe(std::string key, std::string value);
  [[nodiscard]] laser::MeasurementSet finished() { return std::move(set_); }

 private:
  [[nodiscard]] bool compensated() const;
  void lose_beam(const ReadingPlace& place);
  /// What the instrument's own weather station shows goes into its files, if the workshop has weather at all.
  void add_weather(laser::Reading& reading, const Sight& sight) const;
  /// With what the square or straight edge adds, as it lies.
  [[nodiscard]] ToolPose against_artefact(ToolPose pose, double target_mm) const;

  Simulation& simulation_;
  Axis axis_;
  Sense sense_;
  InstrumentKind kind_;
  LaserSettings settings_;
  std::optional<bool> reversed_;
  std::unique_ptr<Instrument> instrument_;
  laser::MeasurementSet set_;
  std::optional<std::size_t> interrupted_at_;
  std::optional<std::string> lost_;
};

}  // namespace ecs::emulator
