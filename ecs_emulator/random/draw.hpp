// Draws of hidden cases from a stream of random numbers.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

[[nodiscard]] inline double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}
/// Even on a logarithmic scale. @pre 0 < low <= high
[[nodiscard]] inline double log_between(Random& random, double low, double high) {
  return low * std::exp(std::log(high / low) * random.uniform());
}
[[nodiscard]] inline bool chance(Random& random, double probability) { return random.uniform() < probability; }
[[nodiscard]] inline double sign_of_chance(Random& random) { return chance(random, 0.5) ? 1.0 : -1.0; }
/// From low to high, both included.
[[nodiscard]] inline int whole(Random& random, int low, int high) {
  return low + static_cast<int>(random.uniform() * (high - low + 1));
}
/// @pre !of.empty()
template <class T>
[[nodiscard]] const T& one(Random& random, const std::vector<T>& of) {
  return of[static_cast<std::size_t>(random.uniform() * static_cast<double>(of.size()))];
}
template <class T>
void shuffle(Random& random, std::vector<T>& list) {
  for (std::size_t i = list.size(); i > 1; --i)
    std::swap(list[i - 1], list[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
}
/// To a multiple of 1/per_unit.
[[nodiscard]] inline double rounded(double value, double per_unit) {
  const double steps = std::round(value * per_unit);
  return steps == 0.0 ? 0.0 : steps / per_unit;
}

}  // namespace ecs::emulator
