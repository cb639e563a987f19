// Structures that waves, zones and moments make: one function each (rows in structure.cpp).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ecs_emulator/hidden_cases/structure_drawing.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator::structure {
namespace {

constexpr double kFullTurn_rad = 2.0 * std::numbers::pi;
double turn(double waves) { return std::sin(kFullTurn_rad * waves); }

}  // namespace

Structure dying_wave(StructureDrawing& d) {
  const double waves = d.draw_waves();
  if (waves == 0.0) return {};
  const double phase = d.random.uniform(), decay = between(d.random, 2.5, 4.0);
  const bool from_far_end = chance(d.random, 0.5);
  return d.with({d.position()}, "a wave that dies along the travel: a bent screw far from its bearing",
                [&](const Stop& s) {
                  const double x = from_far_end ? 1.0 - d.part(s) : d.part(s);
                  return 3.0 * std::exp(-decay * x) * turn(waves * x + phase);
                });
}

Structure beating_waves(StructureDrawing& d) {
  const double waves = d.draw_waves();
  if (waves == 0.0) return {};
  const double other = waves + between(d.random, 1.0, 1.8), phase = d.random.uniform();
  return d.with({d.position()}, "a wave whose size rises and falls: two gears of nearly the same pitch",
                [&](const Stop& s) { return turn(waves * d.part(s)) + turn(other * d.part(s) + phase); });
}

Structure period_jump(StructureDrawing& d) {
  const double waves = d.draw_waves();
  if (waves == 0.0) return {};
  const double other = waves * between(d.random, 1.4, 1.9), place = between(d.random, 0.35, 0.65);
  return d.with({d.position()}, "a wave whose period changes at one place: two scales joined", [&](const Stop& s) {
    const double x = d.part(s);
    return turn(x < place ? waves * x : waves * place + other * (x - place));
  });
}

Structure scale_walk(StructureDrawing& d) {
  if (d.places_mm->size() < 20) return {};
  std::map<double, double> walk;
  double at = 0.0;
  for (const double p : *d.places_mm) walk[p] = at += d.random.normal();
  return d.with({d.position()}, "the error walks at random from target to target: a scale of many short pieces",
                [&](const Stop& s) { return walk.at(d.scene.p_mm(s, d.axis)); });
}

Structure one_way_graduation(StructureDrawing& d) {
  if (d.runs < 3 || d.places_mm->size() < 14) return {};
  const int way = chance(d.random, 0.5) ? 1 : -1;
  std::map<double, double> marks;
  for (const double p : *d.places_mm) marks[p] = d.random.normal();
  return d.with({d.position(), "approach"},
                "every target is off by an amount of its own, from one side only: a rough nut",
                [&](const Stop& s) { return s.approach == way ? marks.at(d.scene.p_mm(s, d.axis)) : 0.0; });
}

Structure zoned_backlash(StructureDrawing& d) {
  if (d.places_mm->size() < 20) return {};
  std::vector<double> edges, sizes;
  for (int zone = 0; zone < 5; ++zone) {
    edges.push_back((zone + between(d.random, 0.7, 1.3)) / 5.0);
    sizes.push_back(d.random.normal());
  }
  return d.with({d.position(), "approach"},
                "lost motion that jumps from zone to zone: a screw worn where it works most", [&](const Stop& s) {
                  const auto zone = std::lower_bound(edges.begin(), edges.end() - 1, d.part(s)) - edges.begin();
                  return s.approach * sizes[static_cast<std::size_t>(zone)];
                });
}

Structure growing_wave(StructureDrawing& d) {
  const double waves = d.draw_waves();
  if (waves == 0.0) return {};
  const double phase = d.random.uniform();
  return d.with({d.position(), "time_s", "run"}, "a wave that grows with time: a bearing that fails",
                [&](const Stop& s) { return (s.time_s / d.duration_s - 0.4) * turn(waves * d.part(s) + phase); });
}

Structure turning_phase(StructureDrawing& d) {
  const double waves = d.draw_waves();
  if (waves == 0.0) return {};
  const double turns = between(d.random, 1.0, 2.5);
  return d.with({d.position(), "time_s", "run"}, "a wave whose phase drifts with time: a belt that slips",
                [&](const Stop& s) { return turn(waves * d.part(s) + turns * s.time_s / d.duration_s); });
}

Structure settling(StructureDrawing& d) {
  std::map<int, std::pair<double, double>> run_s;
  for (const Stop& s : d.scene.stops) {
    auto& [from, to] = run_s.try_emplace(s.run, s.time_s, s.time_s).first->second;
    to = s.time_s;
  }
  const double part = between(d.random, 0.1, 0.2);
  return d.with({"time_s", d.position(), "run"}, "a drift that begins anew with every run: optics that settle",
                [&](const Stop& s) {
                  const auto& [from, to] = run_s.at(s.run);
                  return std::exp(-(s.time_s - from) / (part * std::max(to - from, 1.0)));
                });
}

Structure warm_form(StructureDrawing& d) {
  const auto sensor = d.draw_sensor();
  if (!sensor) return {};
  const double middle = d.mean([&](const Stop& s) { return s.weather.degC[*sensor]; });
  const double waves = between(d.random, 1.0, 1.6), phase = d.random.uniform();
  return d.with({d.position(), d.scene.sensors[*sensor], "time_s", "run"},
                "a curve along the travel that grows with a temperature: a bed that warps",
                [&](const Stop& s) { return (s.weather.degC[*sensor] - middle) * turn(waves * d.part(s) + phase); });
}

Structure loaded_backlash(StructureDrawing& d) {
  const double middle = d.mean([](const Stop& s) { return s.load_kg; });
  return d.with({"approach", "load_kg", "run"}, "lost motion that grows with the load",
                [&](const Stop& s) { return s.approach * (s.load_kg - middle) / 200.0; });
}

Structure resonance(StructureDrawing& d) {
  const double waves = d.draw_waves();
  if (waves == 0.0) return {};
  double fastest = 0.0;
  for (const Stop& s : d.scene.stops) fastest = std::max(fastest, s.feed_mm_min);
  return d.with({d.position(), "feed_mm_min", "run"}, "a wave at the highest feed only: a resonance",
                [&](const Stop& s) { return s.feed_mm_min == fastest ? turn(waves * d.part(s)) : 0.0; });
}

Structure crane(StructureDrawing& d) {
  std::vector<double> switched_s;
  const int times = whole(d.random, 5, 9);
  for (int k = 0; k < times; ++k) switched_s.push_back(d.duration_s * (k + between(d.random, 0.2, 0.8)) / times);
  return d.with(
      {"time_s", "run"}, "the zero jumps to and fro: a crane loads the floor and leaves it", [&](const Stop& s) {
        return (std::lower_bound(switched_s.begin(), switched_s.end(), s.time_s) - switched_s.begin()) % 2 == 0 ? 0.0
                                                                                                                : 1.0;
      });
}

}  // namespace ecs::emulator::structure
