// Time of one tick of the compensation loop, in nanoseconds (target: 60). Instructions: tick_callgrind.cpp.
// Run: tick_bench --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include "bench/tick_map.hpp"

namespace {

void volumetric_tick(benchmark::State& bench) {
  const auto map = ecs::bench::full_map(static_cast<std::uint32_t>(bench.range(0)));
  if (!map) return bench.SkipWithError("the map does not compile");
  const auto walk = ecs::bench::random_walk(1 << 14);
  ecs::TickState state;
  ecs::start(state, walk[0], {-500.0, -500.0, -500.0},
             {ecs::Approach::forward, ecs::Approach::forward, ecs::Approach::forward});
  std::size_t i = 0;
  for (auto _ : bench) {
    ecs::tick(*map, state, walk[i++ & (walk.size() - 1)]);
    benchmark::DoNotOptimize(state.dac_counts);
  }
}
BENCHMARK(volumetric_tick)->ArgName("values")->Arg(360)->Arg(32'000)->Arg(160'000);

}  // namespace

BENCHMARK_MAIN();
