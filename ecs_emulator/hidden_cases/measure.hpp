// Measuring a scene: the exact machine goes to every stop, the unit compensates, the laser reads, noise comes on top.
// Does not live here: what a component's error is (contribution.hpp).
#pragma once

#include <vector>

#include "ecs_emulator/hidden_cases/contribution.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

/// What does not repeat.
struct Noise {
  double sigma_um = 0.5;          ///< of one reading, all of it but the outliers [um, um/m]
  double correlated_share = 0.0;  ///< of the variance: turbulence
  double correlation_s = 10.0;    ///< of the turbulence
  double outlier_probability = 0.0;
  double per_unit = 1000.0;  ///< the display shows multiples of 1/per_unit
};

/// Without noise: what the exact matrices of the chain, the unit's map and the instrument's own errors make of each
/// stop [um, um/m]. @param extra  added to the component that is measured, one per stop; empty: nothing
[[nodiscard]] std::vector<double> exact_errors(const Scene& scene, const std::vector<PlacedEffect>& effects,
                                               const std::vector<double>& extra);

/// Noise of each reading, in the order of time: white, turbulence as a first-order Gauss-Markov process, outliers.
[[nodiscard]] std::vector<double> draw_noise(Random& random, const Scene& scene, const Noise& noise);

/// What the sensors show of the weather: noise and resolution of a good thermometer, barometer and hygrometer.
[[nodiscard]] Scene as_recorded(Random& random, Scene scene);

}  // namespace ecs::emulator
