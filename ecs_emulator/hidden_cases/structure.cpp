// The list of structures: one function and one row each.
#include "ecs_emulator/hidden_cases/structure.hpp"

#include <cmath>
#include <numbers>

#include "ecs_emulator/hidden_cases/structure_drawing.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {

namespace structure {  // structure_moving.cpp
Structure dying_wave(StructureDrawing& d);
Structure beating_waves(StructureDrawing& d);
Structure period_jump(StructureDrawing& d);
Structure scale_walk(StructureDrawing& d);
Structure one_way_graduation(StructureDrawing& d);
Structure zoned_backlash(StructureDrawing& d);
Structure growing_wave(StructureDrawing& d);
Structure turning_phase(StructureDrawing& d);
Structure settling(StructureDrawing& d);
Structure warm_form(StructureDrawing& d);
Structure loaded_backlash(StructureDrawing& d);
Structure resonance(StructureDrawing& d);
Structure crane(StructureDrawing& d);
}  // namespace structure

namespace {

constexpr double kRevolution_rad = 2.0 * std::numbers::pi;

Structure bad_run(StructureDrawing& d) {
  if (d.runs < 3) return {};
  const int bad = whole(d.random, 1, d.runs);
  const double tilt = chance(d.random, 0.3) ? between(d.random, -1.5, 1.5) : 0.0;
  return d.with({"run", "time_s"}, "one run differs from all others",
                [&](const Stop& s) { return s.run == bad ? 1.0 + tilt * d.part(s) : 0.0; });
}

Structure bad_pass(StructureDrawing& d) {
  if (d.runs < 3) return {};
  const int bad = whole(d.random, 1, d.runs);
  const int way = chance(d.random, 0.5) ? 1 : -1;
  return d.with({"run", "approach", "time_s"}, "the axis stuck in one direction of one run",
                [&](const Stop& s) { return s.run == bad && s.approach == way ? 1.0 : 0.0; });
}

Structure wander(StructureDrawing& d) {
  const double period_s = d.duration_s / between(d.random, 1.4, 2.6);
  const double phase = between(d.random, 0.0, kRevolution_rad);
  return d.with({"time_s", "run"}, "the zero wanders with the time of day, over more than one run",
                [&](const Stop& s) { return std::sin(kRevolution_rad * s.time_s / period_s + phase); });
}

Structure bumped_optics(StructureDrawing& d) {
  const double when_s = d.duration_s * between(d.random, 0.2, 0.8);
  return d.with({"time_s", "run"}, "somebody bumped the optics: a jump at a moment of time",
                [&](const Stop& s) { return s.time_s > when_s ? 1.0 : 0.0; });
}

Structure random_runs(StructureDrawing& d) {
  if (d.runs < 5) return {};
  const auto walk = d.draw_for_each_run();
  return d.with({"run", "time_s"}, "the zero walks at random from run to run",
                [&](const Stop& s) { return walk.at(s.run); });
}

Structure run_slopes(StructureDrawing& d) {
  if (d.runs < 4) return {};
  const auto slopes = d.draw_for_each_run();
  return d.with({"run", "time_s", d.position()}, "every run has a scale of its own",
                [&](const Stop& s) { return slopes.at(s.run) * (d.part(s) - 0.5); });
}

Structure squared_temperature(StructureDrawing& d) {
  const auto sensor = d.draw_sensor();
  if (!sensor) return {};
  const double middle = d.mean([&](const Stop& s) { return s.weather.degC[*sensor]; });
  return d.with({d.scene.sensors[*sensor], "time_s", "run"}, "an error that grows with the square of a temperature",
                [&](const Stop& s) { return std::pow(s.weather.degC[*sensor] - middle, 2); });
}

Structure humidity(StructureDrawing& d) {
  if (!d.scene.shown.air) return {};
  return d.with({"humidity_pct", "time_s", "run"}, "an error that follows the humidity",
                [](const Stop& s) { return 0.2 * (s.weather.humidity_pct - 50.0); });
}

/// Curved along both of two axes: no rotation of a rigid carriage does that.
Structure product(StructureDrawing& d) {
  for (const Axis other : kAllAxes) {
    const auto& places = d.ground.cover(d.sense, other).places_mm;
    if (other == d.axis || places.size() < 4) continue;
    const double from = places.front();
    const double span = places.back() - from;
    const double a = between(d.random, 0.8, 1.2);
    const double b = between(d.random, 0.8, 1.2);
    return d.with({d.position(), d.column_of(other)}, "an error curved along two axes at once, as no rigid body moves",
                  [&](const Stop& s) {
                    const double y = (d.scene.p_mm(s, other) - from) / span;
                    return std::cos(kRevolution_rad * a * d.part(s)) * std::cos(kRevolution_rad * b * y);
                  });
  }
  return {};
}

Structure chirp(StructureDrawing& d) {
  if (d.places_mm->size() < 40) return {};
  const double most = static_cast<double>(d.places_mm->size()) / 3.5;
  const double few = between(d.random, 0.25, 0.5) * most;
  const double phase = between(d.random, 0.0, kRevolution_rad);
  return d.with({d.position()}, "a wave whose period changes along the axis", [&](const Stop& s) {
    const double x = d.part(s);
    return std::sin(kRevolution_rad * (few * x + 0.5 * (most - few) * x * x) + phase);
  });
}

Structure burst(StructureDrawing& d) {
  if (d.places_mm->size() < 30) return {};
  const double step = 1.0 / static_cast<double>(d.places_mm->size());
  const double centre = between(d.random, 0.25, 0.75);
  const double width = between(d.random, 3.0, 5.0) * step;
  const double wave = between(d.random, 3.0, 4.5) * step;
  const double phase = between(d.random, 0.0, kRevolution_rad);
  return d.with({d.position()}, "ripples at one place of the travel", [&](const Stop& s) {
    const double u = d.part(s) - centre;
    return std::exp(-0.5 * u * u / (width * width)) * std::sin(kRevolution_rad * u / wave + phase);
  });
}

Structure dent(StructureDrawing& d) {
  if (d.places_mm->size() < 20) return {};
  const double step = 1.0 / static_cast<double>(d.places_mm->size());
  const double centre = between(d.random, 0.2, 0.8);
  const double width = between(d.random, 1.0, 1.8) * step;
  return d.with({d.position()}, "a bump at one place of the travel", [&](const Stop& s) {
    const double u = (d.part(s) - centre) / width;
    return std::exp(-0.5 * u * u);
  });
}

Structure graduation(StructureDrawing& d) {
  if (d.runs < 3 || d.places_mm->size() < 14) return {};
  std::map<double, double> marks;
  for (const double p : *d.places_mm) marks[p] = d.random.normal();
  return d.with({d.position()}, "every line of the scale is off by an amount of its own",
                [&](const Stop& s) { return marks.at(d.scene.p_mm(s, d.axis)); });
}

Structure growing_backlash(StructureDrawing& d) {
  return d.with({"approach", "time_s", "run"}, "lost motion that grows with time",
                [&](const Stop& s) { return s.approach * (s.time_s / d.duration_s - 0.5); });
}

Structure warm_backlash(StructureDrawing& d) {
  const auto sensor = d.draw_sensor();
  if (!sensor) return {};
  const double middle = d.mean([&](const Stop& s) { return s.weather.degC[*sensor]; });
  return d.with({"approach", d.scene.sensors[*sensor], "time_s", "run"}, "lost motion that changes with temperature",
                [&](const Stop& s) { return s.approach * (s.weather.degC[*sensor] - middle); });
}

Structure squared_feed(StructureDrawing& d) {
  return d.with({"feed_mm_min", "run", "time_s"}, "an error that goes with the square of the feed",
                [](const Stop& s) { return std::pow(s.feed_mm_min / 4000.0, 2); });
}

Structure squared_load(StructureDrawing& d) {
  return d.with({"load_kg", "run", "time_s"}, "an error that bends with the load",
                [](const Stop& s) { return std::pow((s.load_kg - 300.0) / 200.0, 2); });
}

}  // namespace

const std::vector<StructureDefinition>& structures() {
  constexpr Needs kOneLine{.least_runs = 3, .whole_runs = true};
  constexpr Needs kBothWays{.bidirectional = true, .least_runs = 3, .whole_runs = true};
  constexpr Needs kTimed{.time = true, .least_runs = 4, .whole_runs = true};
  static const std::vector<StructureDefinition> kAll{
      {"bad_run", {.time = true, .least_runs = 3, .whole_runs = true}, bad_run},
      {"bad_pass", {.bidirectional = true, .time = true, .least_runs = 3, .whole_runs = true}, bad_pass},
      {"wander", {.time = true, .least_runs = 5}, wander},
      {"bumped_optics", {.time = true, .least_runs = 5}, bumped_optics},
      {"random_runs", {.time = true, .least_runs = 5, .whole_runs = true}, random_runs},
      {"run_slopes", {.time = true, .least_runs = 5, .whole_runs = true}, run_slopes},
      {"squared_temperature", {.temperature = true, .time = true, .least_runs = 5}, squared_temperature},
      {"humidity", {.air = true, .time = true, .least_runs = 5}, humidity},
      {"product", {.translations = true, .grid = true, .least_axes = 2}, product},
      {"chirp", kOneLine, chirp},
      {"burst", kOneLine, burst},
      {"dent", kOneLine, dent},
      {"graduation", kOneLine, graduation},
      {"growing_backlash", {.bidirectional = true, .time = true, .least_runs = 3}, growing_backlash},
      {"warm_backlash", {.temperature = true, .bidirectional = true, .time = true, .least_runs = 3}, warm_backlash},
      {"squared_feed", {.feeds = true, .least_runs = 3}, squared_feed},
      {"squared_load", {.loads = true, .least_runs = 4}, squared_load},
      {"dying_wave", kOneLine, structure::dying_wave},
      {"beating_waves", kOneLine, structure::beating_waves},
      {"period_jump", kOneLine, structure::period_jump},
      {"scale_walk", kOneLine, structure::scale_walk},
      {"one_way_graduation", kBothWays, structure::one_way_graduation},
      {"zoned_backlash", kBothWays, structure::zoned_backlash},
      {"growing_wave", kTimed, structure::growing_wave},
      {"turning_phase", kTimed, structure::turning_phase},
      {"settling", kTimed, structure::settling},
      {"warm_form", {.temperature = true, .time = true, .least_runs = 5, .whole_runs = true}, structure::warm_form},
      {"loaded_backlash", {.loads = true, .bidirectional = true, .least_runs = 4}, structure::loaded_backlash},
      {"resonance", {.feeds = true, .least_runs = 4, .whole_runs = true}, structure::resonance},
      {"crane", {.time = true, .least_runs = 5}, structure::crane},
  };
  return kAll;
}

}  // namespace ecs::emulator
