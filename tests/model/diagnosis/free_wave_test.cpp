#include "model/diagnosis/free_wave.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "base/random.hpp"
#include "tests/model/support/searching.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using doctest::Approx;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kTravel_mm = 1000.0;  // nearly: the targets are a little uneven

/// A wave of one size whose phase is drawn anew for every run and approach.
laser::MeasurementSet with_free_wave(double period_mm, double amplitude_um, unsigned seed, const Plan& plan = {}) {
  std::mt19937_64 random(seed + 7000);
  UniformDraws any(0.0, 2.0 * std::numbers::pi);
  std::map<std::pair<int, double>, double> phases;
  return measured(
      plan, kSigma_um,
      [&](const laser::Reading& r) {
        const auto phase = phases.find({r.run, d(r)});
        const double rad = phase == phases.end() ? phases[{r.run, d(r)}] = any(random) : phase->second;
        return amplitude_um * std::sin(2.0 * std::numbers::pi * p(r) / period_mm + rad);
      },
      seed);
}

std::optional<FreeWave> free_wave_in(const laser::MeasurementSet& set) {
  const Searching of(set, kSigma_um, {});
  return free_wave(of.data, of.search.base().y, std::vector<bool>(of.data.size(), false));
}

}  // namespace

TEST_CASE("a wave with another phase in every pass is found at its period") {
  CHECK(rc::check([] {
    const double turns = *rc::gen::inRange(30, 150) * 0.1;
    const auto found =
        free_wave_in(with_free_wave(kTravel_mm / turns, 0.6, static_cast<unsigned>(*rc::gen::inRange(1, 10'000))));
    RC_ASSERT(found.has_value());
    // frequencies closer than half a turn over the travel are one
    RC_ASSERT(std::abs(kTravel_mm / found->period_mm - turns) < 0.6);
  }));
}

TEST_CASE("noise shows a free wave in none of four hundred sets") {
  for (const int targets : {10, 41})
    for (unsigned seed = 1; seed <= 200; ++seed) {
      Plan plan;
      plan.targets = targets;
      CHECK_FALSE(free_wave_in(measured(plan, kSigma_um, nothing, seed)));
    }
}

TEST_CASE("a stronger free wave is the more certain one, and its size does not depend on the unit") {
  const auto weak = free_wave_in(with_free_wave(62.5, 0.3, 3)), strong = free_wave_in(with_free_wave(62.5, 0.6, 3));
  REQUIRE(weak);
  REQUIRE(strong);
  CHECK(strong->minus_log_p > 1.5 * weak->minus_log_p);
  const Searching of(with_free_wave(62.5, 0.6, 3), kSigma_um, {});
  const auto scaled = free_wave(of.data, 1e3 * of.search.base().y, std::vector<bool>(of.data.size(), false));
  REQUIRE(scaled);
  CHECK(scaled->minus_log_p == Approx(strong->minus_log_p));
  CHECK(scaled->period_mm == strong->period_mm);
}

TEST_CASE("a slow shape of fewer than two turns over the travel is no wave") {
  CHECK_FALSE(free_wave_in(with_free_wave(2.2 * kTravel_mm, 0.3, 5)));
}

TEST_CASE("one pass has no other to differ from, and passes of seven readings show no wave") {
  Plan once;
  once.runs = 1;
  once.both_ways = false;
  CHECK_FALSE(free_wave_in(with_free_wave(100.0, 2.0, 1, once)));
  Plan brief;
  brief.targets = 7;
  brief.step_mm = 150.0;
  CHECK_FALSE(free_wave_in(with_free_wave(400.0, 2.0, 1, brief)));
}

TEST_CASE("outliers neither make a free wave nor hide one") {
  const Searching of(with_free_wave(62.5, 0.6, 2), kSigma_um, {});
  std::vector<bool> left_out(of.data.size(), false);
  VectorXd residual = of.search.base().y;
  for (const std::size_t k : {std::size_t{20}, std::size_t{77}, std::size_t{160}}) {
    residual(static_cast<Index>(k)) = 1e4;
    left_out[k] = true;
  }
  const auto found = free_wave(of.data, residual, left_out);
  REQUIRE(found);
  CHECK(found->period_mm == Approx(62.5).epsilon(0.03));
}
