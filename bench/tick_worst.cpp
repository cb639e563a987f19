// How long the slowest of very many ticks take, in nanoseconds, beside the slowest readings of the clock alone: what
// both have in common is the computer's (interrupts, other programs), not the tick's.
// The loop of a unit beside its worst hosts is measured by `tests/attacks/attacks ECS ECS_EMULATOR --only loop`.
// Run: tick_worst [TICKS]   (100,000,000 if not given), on a quiet computer, with the map of tick_bench
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "bench/tick_map.hpp"

namespace {

constexpr std::uint32_t kValues = 32'000;

/// Durations by whole nanoseconds; those beyond the last place are kept one by one.
class Durations {
 public:
  void add(std::int64_t ns) {
    ++count_;
    worst_ns_ = std::max(worst_ns_, ns);
    if (ns < kPlaces)
      ++places_[static_cast<std::size_t>(std::max<std::int64_t>(ns, 0))];
    else
      long_ones_.push_back(ns);
  }
  /// The duration that this share of all does not exceed.
  [[nodiscard]] std::int64_t quantile(double share) {
    auto left = static_cast<std::int64_t>(share * static_cast<double>(count_));
    for (std::size_t ns = 0; ns < places_.size(); ++ns)
      if ((left -= places_[ns]) < 0) return static_cast<std::int64_t>(ns);
    std::sort(long_ones_.begin(), long_ones_.end());
    return left < std::ssize(long_ones_) ? long_ones_[static_cast<std::size_t>(left)] : worst_ns_;
  }
  void print(const char* name) {
    fmt::print("{:10} {:>12} times   median {:>6} ns   99.99 % {:>6} ns   99.9999 % {:>8} ns   worst {:>9} ns\n", name,
               count_, quantile(0.5), quantile(0.9999), quantile(0.999999), worst_ns_);
  }

 private:
  static constexpr std::int64_t kPlaces = 20'000;
  std::vector<std::int64_t> places_ = std::vector<std::int64_t>(kPlaces, 0);
  std::vector<std::int64_t> long_ones_;
  std::int64_t count_ = 0;
  std::int64_t worst_ns_ = 0;
};

Durations timed(std::uint64_t times, const std::function<void(std::uint64_t)>& work) {
  using Clock = std::chrono::steady_clock;
  Durations durations;
  for (std::uint64_t i = 0; i < times; ++i) {
    const auto begun = Clock::now();
    work(i);
    durations.add(std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begun).count());
  }
  return durations;
}

}  // namespace

int main(int count, char** words) {
  const std::uint64_t ticks = count > 1 ? std::strtoull(words[1], nullptr, 10) : 100'000'000;
  const auto map = ecs::bench::full_map(kValues);
  if (!map || ticks == 0) return EXIT_FAILURE;
  const auto walk = ecs::bench::random_walk(1 << 14);
  ecs::TickState state;
  ecs::start(state, walk[0], {-500.0, -500.0, -500.0},
             {ecs::Approach::forward, ecs::Approach::forward, ecs::Approach::forward});
  std::int64_t sum = 0;  // so that no tick is left out
  timed(ticks, [&](std::uint64_t i) {
    ecs::tick(*map, state, walk[i & (walk.size() - 1)]);
    sum += state.dac_counts[0];
  }).print("tick");
  timed(ticks, [&](std::uint64_t i) { sum += static_cast<std::int64_t>(i & 1); }).print("clock");
  fmt::print("sum of outputs {}\n", sum);
}
