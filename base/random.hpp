// Draws from a stream of random numbers. The standard fixes what its engines give but not what its distributions make
// of it; these give the same numbers with every standard library, so a seed stands for the same figures everywhere.
// Does not live here: the emulator's own streams (ecs_emulator/random), which share nothing with the model.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace ecs {

/// An engine of the standard of 32 or 64 random bits a word: mt19937, mt19937_64, random_device.
template <class T>
concept RandomEngine = requires(T& engine) {
  { engine() } -> std::unsigned_integral;
}
&&T::min() == 0 &&
    (T::max() == std::numeric_limits<std::uint32_t>::max() || T::max() == std::numeric_limits<std::uint64_t>::max());

/// Uniform in [0, 1); of an engine of 32 bits from two words, the lower first.
template <RandomEngine Engine>
[[nodiscard]] double uniform(Engine& random) {
  double value = static_cast<double>(random());
  if constexpr (Engine::max() == std::numeric_limits<std::uint32_t>::max())
    value += static_cast<double>(random()) * 0x1p32;
  return std::min(value * 0x1p-64, std::nextafter(1.0, 0.0));
}
template <RandomEngine Engine>
[[nodiscard]] bool chance(Engine& random, double probability) {
  return uniform(random) < probability;
}

/// Any of 0 … count − 1, each as likely. D. Lemire, "Fast random integer generation in an interval", 2019.
/// @pre count > 0
template <RandomEngine Engine>
[[nodiscard]] std::uint32_t one_of(Engine& random, std::uint32_t count) {
  std::uint64_t product = std::uint64_t{static_cast<std::uint32_t>(random())} * count;
  while (static_cast<std::uint32_t>(product) < (std::uint32_t{0} - count) % count)
    product = std::uint64_t{static_cast<std::uint32_t>(random())} * count;
  return static_cast<std::uint32_t>(product >> 32);
}
template <RandomEngine Engine, class T>
void shuffle(std::vector<T>& list, Engine& random) {
  for (std::size_t i = list.size(); i > 1; --i)
    std::swap(list[i - 1], list[one_of(random, static_cast<std::uint32_t>(i))]);
}

/// Uniform in [low, high).
class UniformDraws {
 public:
  UniformDraws(double low, double high) : low_(low), high_(high) {}
  template <RandomEngine Engine>
  [[nodiscard]] double operator()(Engine& random) const {
    return uniform(random) * (high_ - low_) + low_;
  }

 private:
  double low_;
  double high_;
};

/// Gaussian: the polar method of G. Marsaglia, two at a time.
class NormalDraws {
 public:
  explicit NormalDraws(double mean = 0.0, double deviation = 1.0) : mean_(mean), deviation_(deviation) {}
  template <RandomEngine Engine>
  [[nodiscard]] double operator()(Engine& random) {
    return standard(random) * deviation_ + mean_;
  }

 private:
  template <RandomEngine Engine>
  [[nodiscard]] double standard(Engine& random) {
    if (std::exchange(has_second_, false)) return second_;
    double x = 0.0;
    double y = 0.0;
    double square = 0.0;
    do {
      x = 2.0 * uniform(random) - 1.0;
      y = 2.0 * uniform(random) - 1.0;
      square = x * x + y * y;
    } while (square > 1.0 || square == 0.0);
    const double scale = std::sqrt(-2.0 * std::log(square) / square);
    second_ = x * scale;
    has_second_ = true;
    return y * scale;
  }

  double mean_;
  double deviation_;
  double second_ = 0.0;
  bool has_second_ = false;
};

/// The sum of the squares of that many Gaussians, not necessarily a whole number: G. Marsaglia and W. W. Tsang, "A
/// simple method for generating gamma variables", 2000. @pre freedom >= 2
class ChiSquaredDraws {
 public:
  explicit ChiSquaredDraws(double freedom) : freedom_(freedom) {}
  [[nodiscard]] double freedom() const { return freedom_; }
  template <RandomEngine Engine>
  [[nodiscard]] double operator()(Engine& random) {
    const double d = freedom_ / 2.0 - 1.0 / 3.0;
    const double c = 1.0 / std::sqrt(9.0 * d);
    while (true) {
      const double x = normal_(random);
      const double root = 1.0 + c * x;
      if (root <= 0.0) continue;
      const double v = root * root * root;
      const double u = uniform(random);
      if (u <= 1.0 - 0.0331 * x * x * x * x || std::log(u) <= 0.5 * x * x + d * (1.0 - v + std::log(v)))
        return 2.0 * d * v;
    }
  }

 private:
  double freedom_;
  NormalDraws normal_;
};

/// The number of a weight, as often as the weight says.
class WeightedDraws {
 public:
  WeightedDraws() = default;
  /// @pre none negative, not all zero
  explicit WeightedDraws(const std::vector<double>& weights) {
    double sum = 0.0;
    for (const double weight : weights) up_to_.push_back(sum += weight);
    for (double& part : up_to_) part /= sum;
  }
  template <RandomEngine Engine>
  [[nodiscard]] std::size_t operator()(Engine& random) const {
    if (up_to_.size() < 2) return 0;
    const auto found = std::lower_bound(up_to_.begin(), up_to_.end() - 1, uniform(random));
    return static_cast<std::size_t>(found - up_to_.begin());
  }

 private:
  std::vector<double> up_to_;
};

}  // namespace ecs
