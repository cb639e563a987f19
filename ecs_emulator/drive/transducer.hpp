// What follows the nut of one axis: the slide, behind play and wind-up, and the position transducer, from the place
// where it is to the counts that control and unit read. Does not live here: what the transducer sits on and the wires
// to the unit (ecs_emulator/machine/axis_of_machine.hpp), geometry of the guideway
// (ecs_emulator/errors/true_errors.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/parameters.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

struct SlideSettings {
  double lost_motion_um = 0.0;     ///< play between nut and slide
  double wind_up_um = 0.0;         ///< how far friction holds the slide back, each way
  double wind_up_length_mm = 1.0;  ///< the wind-up reverses over this travel, exponentially; above 0
};

/// The slide stays within the play of the nut, and hangs back by the wind-up: from one full wind-up to the other it is
/// δ = c·(1 − 2·e^(−u/u₀)), u = travel since the reversal (the friction model of Dahl, 1968, exponent 1).
class Slide {
 public:
  Slide(const SlideSettings& settings, double nut_mm)
      : settings_(settings), nut_mm_(nut_mm), driven_mm_(nut_mm), slide_mm_(nut_mm) {}

  void follow(double nut_mm) {
    const double moved_mm = nut_mm - nut_mm_;
    nut_mm_ = nut_mm;
    if (settings_.wind_up_um > 0.0) {
      const double full_mm = std::copysign(settings_.wind_up_um * 1e-3, moved_mm);
      wind_up_mm_ += (full_mm - wind_up_mm_) * std::min(1.0, std::abs(moved_mm) / settings_.wind_up_length_mm);
    }
    const double play_mm = 0.5e-3 * settings_.lost_motion_um;
    driven_mm_ = std::clamp(driven_mm_, nut_mm - play_mm, nut_mm + play_mm);
    slide_mm_ = driven_mm_ - wind_up_mm_;
  }
  [[nodiscard]] double position_mm() const { return slide_mm_; }

 private:
  SlideSettings settings_;
  double nut_mm_ = 0.0;
  double driven_mm_ = 0.0;
  double wind_up_mm_ = 0.0;
  double slide_mm_ = 0.0;
};

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
