// The list of structures: one function and one row each.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "modules/hidden_cases/case.hpp"

namespace ecs::emulator {

/// What the structures are drawn with: the line that one is put on, and draws that several share.
class StructureDrawing {
 public:
  using Value = std::function<double(const Stop&)>;

  StructureDrawing(Random& from, const Scene& on, const Ground& covered)
      : random(from), scene(on), ground(covered), sense(one(from, covered.senses)) {
    for (const Axis a : kAllAxes)
      if (ground.cover(sense, a).moved) axis = a;
    places_mm = &ground.cover(sense, axis).places_mm;
    for (const Stop& stop : scene.stops) runs = std::max(runs, stop.run);
    duration_s = scene.stops.back().time_s;
  }

  /// Its value at the stops of the line's sense, its variables as far as the data show them.
  [[nodiscard]] Structure with(std::vector<std::string> variables, std::string text, const Value& value) const {
    Structure s;
    for (const Stop& stop : scene.stops) s.value.push_back(stop.sense == sense ? value(stop) : 0.0);
    s.text = std::move(text);
    for (std::string& name : variables) {
      const bool shown = (name != "time_s" || scene.shown.time) && (name != "run" || scene.shown.run);
      if (shown) s.variables.push_back(std::move(name));
    }
    return s;
  }

  /// 0 … 1 along the line.
  [[nodiscard]] double part(const Stop& stop) const {
    return (scene.p_mm(stop, axis) - places_mm->front()) / (places_mm->back() - places_mm->front());
  }
  /// Column of the coordinate of an axis.
  [[nodiscard]] static std::string column_of(Axis axis) { return std::string(1, small_letter_of(axis)) + "_mm"; }
  [[nodiscard]] std::string position() const { return column_of(axis); }
  [[nodiscard]] double mean(const Value& value) const {
    double sum = 0.0;
    for (const Stop& stop : scene.stops) sum += value(stop);
    return sum / static_cast<double>(scene.stops.size());
  }

  [[nodiscard]] std::map<int, double> draw_for_each_run() {
    std::map<int, double> values;
    for (int run = 1; run <= runs; ++run) values[run] = random.normal();
    return values;
  }
  [[nodiscard]] std::map<double, double> draw_for_each_target() {
    std::map<double, double> values;
    for (const double p : *places_mm) values[p] = random.normal();
    return values;
  }
  /// Waves along the line that its targets can show, no whole number of them. @pre kTargetsOfWaves targets
  [[nodiscard]] double draw_waves() {
    constexpr double kTargetsAWave = 4.0, kFewest = 3.2;
    return log_between(random, kFewest, static_cast<double>(places_mm->size()) / kTargetsAWave);
  }
  /// A sensor, not the air's. @pre temperatures were needed: there are two
  [[nodiscard]] std::size_t draw_sensor() {
    return static_cast<std::size_t>(whole(random, 1, static_cast<int>(scene.sensors.size()) - 1));
  }

  Random& random;
  const Scene& scene;
  const Ground& ground;
  Sense sense = Sense::EX;  ///< of the line
  Axis axis = Axis::X;
  const std::vector<double>* places_mm = nullptr;  ///< targets of the line
  int runs = 1;
  double duration_s = 0.0;
};

namespace {

constexpr double kRevolution_rad = 2.0 * std::numbers::pi;
constexpr std::size_t kTargetsOfWaves = 24;
double turn(double waves) { return std::sin(kRevolution_rad * waves); }

Structure bad_run(StructureDrawing& d) {
  const int bad = whole(d.random, 1, d.runs);
  const double tilt = chance(d.random, 0.3) ? between(d.random, -1.5, 1.5) : 0.0;
  return d.with({"run", "time_s"}, "one run differs from all others",
                [&](const Stop& s) { return s.run == bad ? 1.0 + tilt * d.part(s) : 0.0; });
}

Structure bad_pass(StructureDrawing& d) {
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
  const auto walk = d.draw_for_each_run();
  return d.with({"run", "time_s"}, "the zero walks at random from run to run",
                [&](const Stop& s) { return walk.at(s.run); });
}

Structure run_slopes(StructureDrawing& d) {
  const auto slopes = d.draw_for_each_run();
  return d.with({"run", "time_s", d.position()}, "every run has a scale of its own",
                [&](const Stop& s) { return slopes.at(s.run) * (d.part(s) - 0.5); });
}

Structure squared_temperature(StructureDrawing& d) {
  const std::size_t sensor = d.draw_sensor();
  const double middle = d.mean([&](const Stop& s) { return s.weather.degC[sensor]; });
  return d.with({d.scene.sensors[sensor], "time_s", "run"}, "an error that grows with the square of a temperature",
                [&](const Stop& s) { return std::pow(s.weather.degC[sensor] - middle, 2); });
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
  const double most = static_cast<double>(d.places_mm->size()) / 3.5;
  const double few = between(d.random, 0.25, 0.5) * most;
  const double phase = between(d.random, 0.0, kRevolution_rad);
  return d.with({d.position()}, "a wave whose period changes along the axis", [&](const Stop& s) {
    const double x = d.part(s);
    return std::sin(kRevolution_rad * (few * x + 0.5 * (most - few) * x * x) + phase);
  });
}

Structure burst(StructureDrawing& d) {
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
  const double step = 1.0 / static_cast<double>(d.places_mm->size());
  const double centre = between(d.random, 0.2, 0.8);
  const double width = between(d.random, 1.0, 1.8) * step;
  return d.with({d.position()}, "a bump at one place of the travel", [&](const Stop& s) {
    const double u = (d.part(s) - centre) / width;
    return std::exp(-0.5 * u * u);
  });
}

Structure graduation(StructureDrawing& d) {
  const auto marks = d.draw_for_each_target();
  return d.with({d.position()}, "every line of the scale is off by an amount of its own",
                [&](const Stop& s) { return marks.at(d.scene.p_mm(s, d.axis)); });
}

Structure growing_backlash(StructureDrawing& d) {
  return d.with({"approach", "time_s", "run"}, "lost motion that grows with time",
                [&](const Stop& s) { return s.approach * (s.time_s / d.duration_s - 0.5); });
}

Structure warm_backlash(StructureDrawing& d) {
  const std::size_t sensor = d.draw_sensor();
  const double middle = d.mean([&](const Stop& s) { return s.weather.degC[sensor]; });
  return d.with({"approach", d.scene.sensors[sensor], "time_s", "run"}, "lost motion that changes with temperature",
                [&](const Stop& s) { return s.approach * (s.weather.degC[sensor] - middle); });
}

Structure squared_feed(StructureDrawing& d) {
  return d.with({"feed_mm_min", "run", "time_s"}, "an error that goes with the square of the feed",
                [](const Stop& s) { return std::pow(s.feed_mm_min / 4000.0, 2); });
}

Structure squared_load(StructureDrawing& d) {
  return d.with({"load_kg", "run", "time_s"}, "an error that bends with the load",
                [](const Stop& s) { return std::pow((s.load_kg - 300.0) / 200.0, 2); });
}

Structure dying_wave(StructureDrawing& d) {
  const double waves = d.draw_waves();
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
  const double other = waves + between(d.random, 1.0, 1.8), phase = d.random.uniform();
  return d.with({d.position()}, "a wave whose size rises and falls: two gears of nearly the same pitch",
                [&](const Stop& s) { return turn(waves * d.part(s)) + turn(other * d.part(s) + phase); });
}

Structure period_jump(StructureDrawing& d) {
  const double waves = d.draw_waves();
  const double other = waves * between(d.random, 1.4, 1.9), place = between(d.random, 0.35, 0.65);
  return d.with({d.position()}, "a wave whose period changes at one place: two scales joined", [&](const Stop& s) {
    const double x = d.part(s);
    return turn(x < place ? waves * x : waves * place + other * (x - place));
  });
}

Structure scale_walk(StructureDrawing& d) {
  std::map<double, double> walk;
  double at = 0.0;
  for (const double p : *d.places_mm) walk[p] = at += d.random.normal();
  return d.with({d.position()}, "the error walks at random from target to target: a scale of many short pieces",
                [&](const Stop& s) { return walk.at(d.scene.p_mm(s, d.axis)); });
}

Structure one_way_graduation(StructureDrawing& d) {
  const int way = chance(d.random, 0.5) ? 1 : -1;
  const auto marks = d.draw_for_each_target();
  return d.with({d.position(), "approach"},
                "every target is off by an amount of its own, from one side only: a rough nut",
                [&](const Stop& s) { return s.approach == way ? marks.at(d.scene.p_mm(s, d.axis)) : 0.0; });
}

Structure zoned_backlash(StructureDrawing& d) {
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
  const double phase = d.random.uniform();
  return d.with({d.position(), "time_s", "run"}, "a wave that grows with time: a bearing that fails",
                [&](const Stop& s) { return (s.time_s / d.duration_s - 0.4) * turn(waves * d.part(s) + phase); });
}

Structure turning_phase(StructureDrawing& d) {
  const double waves = d.draw_waves();
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
  return d.with({"time_s", d.position(), "run"}, "a drift that starts again with every run: optics that settle",
                [&](const Stop& s) {
                  const auto& [from, to] = run_s.at(s.run);
                  return std::exp(-(s.time_s - from) / (part * std::max(to - from, 1.0)));
                });
}

Structure warm_form(StructureDrawing& d) {
  const std::size_t sensor = d.draw_sensor();
  const double middle = d.mean([&](const Stop& s) { return s.weather.degC[sensor]; });
  const double waves = between(d.random, 1.0, 1.6), phase = d.random.uniform();
  return d.with({d.position(), d.scene.sensors[sensor], "time_s", "run"},
                "a curve along the travel that grows with a temperature: a bed that warps",
                [&](const Stop& s) { return (s.weather.degC[sensor] - middle) * turn(waves * d.part(s) + phase); });
}

Structure loaded_backlash(StructureDrawing& d) {
  const double middle = d.mean([](const Stop& s) { return s.load_kg; });
  return d.with({"approach", "load_kg", "run"}, "lost motion that grows with the load",
                [&](const Stop& s) { return s.approach * (s.load_kg - middle) / 200.0; });
}

Structure resonance(StructureDrawing& d) {
  const double waves = d.draw_waves();
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
      {"chirp", kOneLine, chirp, 40},
      {"burst", kOneLine, burst, 30},
      {"dent", kOneLine, dent, 20},
      {"graduation", kOneLine, graduation, 14},
      {"growing_backlash", {.bidirectional = true, .time = true, .least_runs = 3}, growing_backlash},
      {"warm_backlash", {.temperature = true, .bidirectional = true, .time = true, .least_runs = 3}, warm_backlash},
      {"squared_feed", {.feeds = true, .least_runs = 3}, squared_feed},
      {"squared_load", {.loads = true, .least_runs = 4}, squared_load},
      {"dying_wave", kOneLine, dying_wave, kTargetsOfWaves},
      {"beating_waves", kOneLine, beating_waves, kTargetsOfWaves},
      {"period_jump", kOneLine, period_jump, kTargetsOfWaves},
      {"scale_walk", kOneLine, scale_walk, 20},
      {"one_way_graduation", kBothWays, one_way_graduation, 14},
      {"zoned_backlash", kBothWays, zoned_backlash, 20},
      {"growing_wave", kTimed, growing_wave, kTargetsOfWaves},
      {"turning_phase", kTimed, turning_phase, kTargetsOfWaves},
      {"settling", kTimed, settling},
      {"warm_form", {.temperature = true, .time = true, .least_runs = 5, .whole_runs = true}, warm_form},
      {"loaded_backlash", {.loads = true, .bidirectional = true, .least_runs = 4}, loaded_backlash},
      {"resonance", {.feeds = true, .least_runs = 4, .whole_runs = true}, resonance, kTargetsOfWaves},
      {"crane", {.time = true, .least_runs = 5}, crane},
  };
  return kAll;
}

Structure draw_structure(Random& random, const Scene& scene, const Ground& ground,
                         const StructureDefinition& definition) {
  StructureDrawing drawing(random, scene, ground);
  return drawing.places_mm->size() >= definition.least_targets ? definition.draw(drawing) : Structure{};
}

}  // namespace ecs::emulator
