// Instructions of one tick (target: 400; with two rotary axes and thermal rows 600), counted by callgrind; docs/core.md
// says how to read it. Run: valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null tick_callgrind
// [values] [rows] [ticks] [configuration] With thermal rows the tick adds their polynomial, and the slow loop runs once
// in so many ticks (0: never). With a configuration, such as XYACTZ, the two rotary axes turn as well; with
// "machine", "tool" or "both" after it they bend.
#include <cstdio>
#include <vector>

#include <valgrind/callgrind.h>

#include "bench/tick_map.hpp"

int main(int argc, char** argv) {
  const auto argument = [&](int which, int usual) { return argc > which ? std::atoi(argv[which]) : usual; };
  const auto values = static_cast<std::uint32_t>(argument(1, 32'000));
  const auto rows = static_cast<std::size_t>(argument(2, 0));
  const auto slow_ticks = static_cast<std::uint64_t>(argument(3, 100));
  const auto map = ecs::bench::full_map(values, ecs::bench::thermal_rows(rows));
  if (!map) return 1;
  constexpr std::size_t kTicks = 10'000;
  const auto walk = ecs::bench::random_walk(kTicks);
  const ecs::Vector3 datum_mm{-500.0, -500.0, -500.0};
  ecs::TickState state;
  ecs::start(state, walk[0], datum_mm, {ecs::Approach::forward, ecs::Approach::forward, ecs::Approach::forward});
  ecs::InputValues inputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i] = {20.0 + static_cast<double>(i), true, 0};
  ecs::ThermalState thermal;
  (void)ecs::begin_thermal(map->thermal, thermal, inputs, datum_mm, nullptr, 0.0);
  const bool rotary_axes = argc > 4;
  if (rotary_axes && !ecs::bench::add_rotary_axes(*map, argv[4], argc > 5 ? argv[5] : "")) return 1;
  ecs::RotaryTickState rotary;
  ecs::start_rotary(map->rotary, rotary, {}, {}, {});
  std::vector<ecs::PerRotary<std::int64_t>> turns;
  for (const auto& counts : walk) turns.push_back({3 * counts[0], -7 * counts[1]});
  CALLGRIND_START_INSTRUMENTATION;
  if (rows == 0 && !rotary_axes) {
    for (const auto& counts : walk) ecs::tick(*map, state, counts);
  } else {
    for (const auto& counts : walk) {
      if (slow_ticks > 0 && state.ticks % slow_ticks == 0) {
        for (auto& input : inputs) ++input.number;
        (void)ecs::step_thermal(map->thermal, thermal, inputs, state.position_mm, ecs::kThermalStep_s);
        ecs::follow_thermal(*map, thermal, rotary);
      }
      if (rotary_axes)
        ecs::tick(*map, state, counts, thermal.acting, rotary, turns[state.ticks]);
      else
        ecs::tick(*map, state, counts, thermal.acting);
    }
  }
  CALLGRIND_STOP_INSTRUMENTATION;
  std::printf("%zu ticks over %u values, %zu thermal rows; divide callgrind's \"Collected\" by the ticks\n", kTicks,
              values, rows);
  return state.ticks == kTicks ? 0 : 1;
}
