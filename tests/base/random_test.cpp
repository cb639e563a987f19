// Draws that are the same with every standard library: fixed figures, and the moments that their names promise.
#include "base/random.hpp"

#include <random>

#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("a seed stands for the same figures everywhere") {
  std::mt19937_64 words(5489);  // its first word is 14514284786278117030, by the standard's own example
  CHECK(uniform(words) == 14514284786278117030.0 / 18446744073709551616.0);
  std::mt19937 halves(5489);  // 3499211612 and 581869302
  CHECK(uniform(halves) == (3499211612.0 + 581869302.0 * 4294967296.0) / 18446744073709551616.0);
}

TEST_CASE("draws have the moments of their distribution") {
  std::mt19937_64 random(1);
  constexpr int kDraws = 200'000;
  const auto check = [&](auto&& draw, double mean, double variance) {
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = draw();
      sum += x;
      squares += (x - mean) * (x - mean);
    }
    CHECK(std::abs(sum / kDraws - mean) < 5.0 * std::sqrt(variance / kDraws));
    CHECK(squares / kDraws == Approx(variance).epsilon(0.03));
  };
  NormalDraws normal(3.0, 2.0);
  check([&] { return normal(random); }, 3.0, 4.0);
  ChiSquaredDraws squares(4.5);
  check([&] { return squares(random); }, 4.5, 9.0);
  const UniformDraws even(-1.0, 2.0);
  check([&] { return even(random); }, 0.5, 0.75);
  check([&] { return static_cast<double>(one_of(random, 6)); }, 2.5, 35.0 / 12.0);
  const WeightedDraws weighted({1.0, 0.0, 3.0});  // 0 once, 2 three times
  check([&] { return static_cast<double>(weighted(random)); }, 1.5, 0.75);
}
