// The position transducer of one axis: from the place where it is to the counts that control and unit read.
// Does not live here: what it sits on (axis_servo.hpp), the wires to the unit (axis_of_machine.hpp).
#pragma once

#include <cstdint>

#include "core/parameters.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

/// How a resolver is fed (thesis 5.2).
enum class Excitation : std::uint8_t {
  rotor,   ///< the amplitudes of the two stator signals are compared: follows at once
  stator,  ///< the phase of the rotor signal is taken once a period of the carrier
};

/// `[emulator.axis.X.transducer]`. Offset, imbalance and quadrature are those of the two signals in quadrature, as a
/// part of their amplitude: they make the subdivision of one period uneven.
struct TransducerSettings {
  double period_mm = 0.0;        ///< of the electrical signal: grating or turn of the resolver; 0: divided perfectly
  double offset = 0.0;           ///< of the sine: an error once a period
  double imbalance = 0.0;        ///< sine less cosine: twice a period
  double quadrature_mrad = 0.0;  ///< off the right angle: twice a period
  Excitation excitation = Excitation::rotor;
  double carrier_Hz = 2500.0;    ///< of a stator-excited resolver
  double noise_um = 0.0;         ///< standard deviation
  double fastest_mm_min = 0.0;   ///< above it counts are lost; 0: never
  double dirt_mm = 0.0;          ///< a dirty place of the scale …
  std::int64_t dirt_counts = 0;  ///< … loses up to so many counts whenever it is passed
};

class PositionTransducer {
 public:
  /// @param resolution_um  of one count; counts change halfway between two of them
  PositionTransducer(const TransducerSettings& settings, Transducer kind, double resolution_um, double start_mm,
                     std::uint64_t seed);

  /// Follows what it sits on for a while.
  void follow(double position_mm, double seconds);

  /// What it shows: counts since it stood at 0, losses included.
  [[nodiscard]] std::int64_t counts() const { return counts_; }
  /// What it showed, or will show, where it stands at `position_mm`, but for its noise.
  [[nodiscard]] std::int64_t counts_at(double position_mm) const;
  /// Counts lost since the machine was last referenced.
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  /// The control counts anew from its reference position.
  void referenced() { lost_ = 0; }
  /// Where it says it is, before it is cut into counts: place and error of the subdivision [mm].
  [[nodiscard]] double shown_mm(double position_mm) const;

 private:
  void lose(double moved_mm, double seconds);

  TransducerSettings settings_;
  bool carrier_ = false;
  double counts_per_mm_ = 1000.0;
  double position_mm_ = 0.0;
  double since_carrier_s_ = 0.0;
  std::int64_t counts_ = 0;
  std::int64_t lost_ = 0;
  double losing_ = 0.0;  ///< part of a count not yet lost
  Random random_;
};

}  // namespace ecs::emulator
