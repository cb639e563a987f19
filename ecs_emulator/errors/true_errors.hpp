// The machine's own true errors: what no host ever sees but through measurements. Read from a TOML file
// (docs/emulator.md), evaluated at a state of the machine and its heat.
// Does not live here: the notation (reader.hpp), how errors add up at the tool (kinematics.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "core/terms.hpp"
#include "ecs_emulator/errors/gravity.hpp"
#include "ecs_emulator/errors/kinematics.hpp"
#include "ecs_emulator/thermal/heat.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

/// All that an error may depend on.
struct MachineState {
  Vector3 position_mm{};
  PerAxis<Approach> approach{Approach::forward, Approach::forward, Approach::forward};
  PerAxis<double> travel_since_reversal_mm{};
  PerAxis<std::uint64_t> pass{};  ///< traverse in one direction, counted from the start of the simulation
  double feed_mm_min = 0.0;       ///< 0: standing
  double load_kg = 0.0;
  double time_s = 0.0;  ///< simulated, since the machine was switched on
};

class TrueErrors {
 public:
  TrueErrors();  ///< a perfect machine
  ~TrueErrors();
  TrueErrors(TrueErrors&&) noexcept;
  TrueErrors& operator=(TrueErrors&&) noexcept;

  [[nodiscard]] static Result<TrueErrors> load(const std::filesystem::path& path);
  /// @param file    name used in problems
  /// @param folder  where `csv = "…"` contributions are looked for
  [[nodiscard]] static Result<TrueErrors> parse(std::string_view text, const std::string& file,
                                                const std::filesystem::path& folder);

  /// Refuses what that machine cannot have, each with its line in the errors file: an axis that is not there, a ram
  /// that carries the workpiece, …
  [[nodiscard]] Result<void> checked_for(const params::Machine& machine) const;
  /// Effects count from the machine's datum, gravity works on its chain. Without it: datum 0, every axis on the tool's
  /// side, levers from 0.
  void put_on(const MachinePlace& place);

  /// The systematic part of the 21 components [um, um/m].
  [[nodiscard]] ComponentValues at(const MachineState& state) const { return at(state, Heat()); }
  /// @param heat  made from heat()
  [[nodiscard]] ComponentValues at(const MachineState& state, const Heat& heat) const;

  /// What the square or straight edge, as it was first, adds to readings of that line [um]; turned over: minus that.
  [[nodiscard]] double artefact_um(Axis axis, Sense sense, double position_mm) const;
  /// The systematic errors of the rotary axes.
  [[nodiscard]] RotaryValues rotary_at(const RotaryState& state) const;

  /// What does not repeat: the shape of this state's passes (the same whenever the pass is the same).
  /// @param travel_mm  range over which each axis's shape is drawn
  [[nodiscard]] ComponentValues pass_scatter(const MachineState& state, const PerAxis<std::array<double, 2>>& travel_mm,
                                             std::uint64_t seed) const;
  /// Standard deviation of the independent scatter of single readings [um, um/m].
  [[nodiscard]] const ComponentValues& reading_scatter() const;

  /// What this file says of heat and sensors.
  [[nodiscard]] const HeatSettings& heat() const;
  /// The sensors of `[temperature]` at a time [°C], in the order of their names.
  [[nodiscard]] std::vector<NamedTemperature> temperatures(double time_s) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace ecs::emulator
