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
  for (auto _ : bench) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    ecs::tick(*map, state, walk[i++ & (walk.size() - 1)]);
    benchmark::DoNotOptimize(state.dac_counts);
  }
}
BENCHMARK(volumetric_tick)->ArgName("values")->Arg(360)->Arg(32'000)->Arg(160'000);

/// With 16 thermal rows, and two rotary axes beside the same without.
void warm_tick(benchmark::State& bench, const char* configuration) {
  const auto map = ecs::bench::full_map(32'000, ecs::bench::thermal_rows(16));
  const bool turns = *configuration != '\0';
  if (!map || (turns && !ecs::bench::add_rotary_axes(*map, configuration)))
    return bench.SkipWithError("the map does not compile");
  const auto walk = ecs::bench::random_walk(1 << 14);
  ecs::TickState state;
  ecs::ThermalState thermal;
  ecs::RotaryTickState rotary;
  ecs::start(state, walk[0], {-500.0, -500.0, -500.0}, {});
  if (turns) ecs::start_rotary(map->rotary, rotary, {}, {}, {});
  std::size_t i = 0;
  for (auto _ : bench) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    const auto& counts = walk[i++ & (walk.size() - 1)];
    if (turns)
      ecs::tick(*map, state, counts, thermal.acting, rotary, {3 * counts[0], -7 * counts[1]});
    else
      ecs::tick(*map, state, counts, thermal.acting);
    benchmark::DoNotOptimize(state.dac_counts);
  }
}
BENCHMARK_CAPTURE(warm_tick, three_axes, "");
BENCHMARK_CAPTURE(warm_tick, tables, "XYACTZ");
BENCHMARK_CAPTURE(warm_tick, heads, "XYTZCB");
BENCHMARK_CAPTURE(warm_tick, table_and_head, "XYCTZB");

}  // namespace

BENCHMARK_MAIN();
