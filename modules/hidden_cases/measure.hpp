// Measuring a scene: what an effect adds to a reading by the place where it acts, the exact machine at every stop, the
// unit that compensates, noise on top. Does not live here: an effect's formula (ecs_emulator/effects), the machine
// itself (ecs_emulator/errors/kinematics.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

/// Value of the effect's component, or what the instrument adds, at this stop [um, um/m]; 0 where it does not act.
/// @pre its seat is not the unit
[[nodiscard]] double amount(const Scene& scene, const PlacedEffect& effect, const Stop& stop);
/// How much of a component's value reaches the sense of this reading: levers and signs of the chain.
[[nodiscard]] double share_in(const Scene& scene, Component component, const Stop& stop);

/// Compensation that a unit adds to this reading, with the faults among `effects` [um, um/m].
[[nodiscard]] double unit_compensation(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop);
/// Value of one of the map's curves; 0 where the map lacks it.
[[nodiscard]] double table_value(const UnitMap& map, Axis axis, Sense sense, double position_mm, int approach);

/// What the effect adds to each reading, to first order [um, um/m] (readings).
[[nodiscard]] std::vector<double> contribution(const Scene& scene, const PlacedEffect& effect);

/// How what does not repeat is distributed.
enum class NoiseLaw : std::uint8_t {
  usual,        ///< white, now and then with turbulence over seconds and isolated outliers
  white,        ///< Gaussian, independent
  rounded,      ///< white, and a display whose step is larger than it
  doubled,      ///< white, and every row is in the file twice
  heavy_tails,  ///< Student's t of three degrees of freedom
  slow,         ///< turbulence over minutes, no target measured again
  by_run,       ///< white, and a zero of each run that depends on the one before (first-order autoregression)
  random_walk,  ///< white, and a zero that walks from row to row
};
inline constexpr std::array<std::string_view, 8> kNoiseLawNames{"usual",       "white", "rounded", "doubled",
                                                                "heavy-tails", "slow",  "by-run",  "random-walk"};
[[nodiscard]] constexpr std::string_view name_of(NoiseLaw law) { return kNoiseLawNames[static_cast<std::size_t>(law)]; }

/// What does not repeat.
struct Noise {
  NoiseLaw law = NoiseLaw::usual;
  double sigma_um = 0.5;          ///< of one reading, all of it but the outliers [um, um/m]
  double correlated_share = 0.0;  ///< of the variance: turbulence, or the zero that moves from run to run, row to row
  double correlation_s = 10.0;    ///< of the turbulence
  double outlier_probability = 0.0;
  double per_unit = 1000.0;  ///< the display shows multiples of 1/per_unit
};

/// Without noise: what the exact matrices of the chain, the unit's map and the instrument's own errors make of each
/// stop [um, um/m]. @param extra  added to the component that is measured, one per stop; empty: nothing
[[nodiscard]] std::vector<double> exact_errors(const Scene& scene, const std::vector<PlacedEffect>& effects,
                                               const std::vector<double>& extra);

/// Noise of each reading, in the order of time, by its law; turbulence is a first-order Gauss-Markov process.
[[nodiscard]] std::vector<double> draw_noise(Random& random, const Scene& scene, const Noise& noise);

/// What the sensors show of the weather: noise and resolution of a good thermometer, barometer and hygrometer.
[[nodiscard]] Scene as_recorded(Random& random, Scene scene);

}  // namespace ecs::emulator
