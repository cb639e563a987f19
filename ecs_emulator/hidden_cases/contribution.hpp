// What an effect adds to a reading: the formulas of docs/physics.md, "The effect library", by the place where they act
// in a machine. Does not live here: the machine itself (ecs_emulator/errors/kinematics.hpp), which effects are drawn
// (choice.hpp).
#pragma once

#include <vector>

#include "ecs_emulator/effects/effect.hpp"
#include "ecs_emulator/hidden_cases/scene.hpp"

namespace ecs::emulator {

/// Refractive index of air less 1, at 633 nm (Edlén, as revised by Birch and Downs 1993/1994).
[[nodiscard]] double refractivity(double air_degC, double pressure_hPa, double humidity_pct);
/// n − n at 20 °C, 1013.25 hPa, 50 %RH. Air temperature of the stop's sensor t_air_degC.
[[nodiscard]] double missing_refraction(const Scene& scene, const Stop& stop);

/// Where in the workshop an effect has its seat.
enum class Seat : std::uint8_t {
  machine,     ///< an error component of the machine
  instrument,  ///< the laser
  unit,        ///< the compensation
};
[[nodiscard]] Seat seat_of(EffectKind kind);

/// The component of the machine that carries it. @pre seat_of() is machine
[[nodiscard]] Component component_of(const PlacedEffect& effect);
/// Value of that component, or what the instrument adds, at this stop [um, um/m]; 0 where it does not act.
[[nodiscard]] double amount(const Scene& scene, const PlacedEffect& effect, const Stop& stop);
/// It acts on this reading at all.
[[nodiscard]] bool acts_on(const PlacedEffect& effect, const Stop& stop);
/// How much of a component's value reaches the sense of this reading: levers and signs of the chain.
[[nodiscard]] double share_in(const Scene& scene, Component component, const Stop& stop);

/// Compensation that a unit adds to this reading, with the faults among `effects` [um, um/m].
[[nodiscard]] double unit_compensation(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop);
/// Value of one of the map's curves; 0 where the map lacks it.
[[nodiscard]] double table_value(const UnitMap& map, Axis axis, Sense sense, double position_mm, int approach);

/// What the effect adds to each reading, to first order [um, um/m] (readings).
[[nodiscard]] std::vector<double> contribution(const Scene& scene, const PlacedEffect& effect);

}  // namespace ecs::emulator
