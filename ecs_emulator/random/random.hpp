// Random numbers of the virtual workshop: the same seed gives the same bits on every platform.
// Does not live here: what is random (ecs_emulator/errors/true_errors.hpp, ecs_emulator/instruments/laser.hpp).
#pragma once

#include <cstdint>
#include <random>

namespace ecs::emulator {

/// One stream of random numbers.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1): 53 bits.
  [[nodiscard]] double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  /// Mean 0, standard deviation 1: the sum of twelve uniform numbers. Only additions, so no mathematical library can
  /// change a bit; never beyond ±6.
  [[nodiscard]] double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::mt19937_64 engine_;
};

/// A seed of its own for each (seed, part, number): streams that do not depend on the order in which they are used.
[[nodiscard]] constexpr std::uint64_t seed_of(std::uint64_t seed, std::uint64_t part, std::uint64_t number) {
  std::uint64_t value = seed;
  for (const std::uint64_t word : {part, number}) {  // the mixing of splitmix64
    value += 0x9e3779b97f4a7c15u + word;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    value ^= value >> 31;
  }
  return value;
}

}  // namespace ecs::emulator
