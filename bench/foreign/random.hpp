// Random numbers that are the same with every standard library: mt19937_64 is fixed by the standard, its
// distributions are not, so these are our own.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace foreign {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// 0 <= u < 1
  [[nodiscard]] double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in the logarithm. @pre 0 < low < high
  [[nodiscard]] double between_log(double low, double high) { return low * std::pow(high / low, uniform()); }
  [[nodiscard]] int whole(int low, int high) { return low + static_cast<int>(uniform() * (high - low + 1)); }
  [[nodiscard]] bool chance(double probability) { return uniform() < probability; }
  /// Either sign. Products of two draws are avoided: the order of their evaluation is the compiler's.
  [[nodiscard]] double signed_between(double low, double high) {
    const double side = sign();
    return side * between(low, high);
  }
  [[nodiscard]] double sign() { return chance(0.5) ? 1.0 : -1.0; }
  /// Box and Muller 1958.
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Student's t with `freedom` degrees, scaled to a standard deviation of one. @pre freedom > 2
  [[nodiscard]] double heavy(int freedom) {
    double sum = 0.0;
    for (int k = 0; k < freedom; ++k) sum += std::pow(normal(), 2);
    return normal() / std::sqrt(sum / freedom) * std::sqrt((freedom - 2.0) / freedom);
  }
  template <class T>
  [[nodiscard]] const T& pick(const std::vector<T>& from) {
    return from[static_cast<std::size_t>(whole(0, static_cast<int>(from.size()) - 1))];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace foreign
