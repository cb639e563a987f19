// Instructions of one tick (target: 400), counted by callgrind; docs/core.md says how to read it.
// Run: valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null tick_callgrind [values]
#include <cstdio>
#include <cstdlib>

#include <valgrind/callgrind.h>

#include "bench/tick_map.hpp"

int main(int argc, char** argv) {
  const auto values = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 32'000);
  const auto map = ecs::bench::full_map(values);
  if (!map) return 1;
  constexpr std::size_t kTicks = 10'000;
  const auto walk = ecs::bench::random_walk(kTicks);
  ecs::TickState state;
  ecs::start(state, walk[0], {-500.0, -500.0, -500.0},
             {ecs::Approach::forward, ecs::Approach::forward, ecs::Approach::forward});
  CALLGRIND_START_INSTRUMENTATION;
  for (const auto& counts : walk) ecs::tick(*map, state, counts);
  CALLGRIND_STOP_INSTRUMENTATION;
  std::printf("%zu ticks over %u values; divide callgrind's \"Collected\" by the ticks\n", kTicks, values);
  return state.ticks == kTicks ? 0 : 1;
}
