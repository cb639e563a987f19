// How much faster than real time the virtual workshop runs: a three-axis machine, every axis on its drive at the step
// of 0.1 ms, and the unit compensating at 1 kHz from a full volumetric map. Run: machine_bench; for the profile:
// valgrind --tool=callgrind machine_callgrind [seconds]
#include <benchmark/benchmark.h>

#include "bench/workshop_bench.hpp"

namespace {

void run(benchmark::State& state, const std::string& drive, bool with_unit) {
  ecs::bench::Workbench bench(drive, with_unit);
  double simulated_s = 0.0;
  for (auto step : state) simulated_s += bench.run(1.0);
  state.counters["times_real_time"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
}

void servo_and_unit(benchmark::State& state) { run(state, "servo", true); }
void servo_alone(benchmark::State& state) { run(state, "servo", false); }
void ideal_and_unit(benchmark::State& state) { run(state, "ideal", true); }

}  // namespace

BENCHMARK(servo_and_unit)->Unit(benchmark::kMillisecond);
BENCHMARK(servo_alone)->Unit(benchmark::kMillisecond);
BENCHMARK(ideal_and_unit)->Unit(benchmark::kMillisecond);

BENCHMARK_MAIN();
