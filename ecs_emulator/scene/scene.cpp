#include "ecs_emulator/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecs::emulator {

std::optional<std::size_t> Scene::sensor(const std::string& column) const {
  const auto found = std::find(sensors.begin(), sensors.end(), column);
  if (found == sensors.end()) return std::nullopt;
  return static_cast<std::size_t>(found - sensors.begin());
}

double Scene::degC(const std::string& column, const Stop& stop, double otherwise) const {
  const auto place = sensor(column);
  return place ? stop.weather.degC[*place] : otherwise;
}

double between_points(const std::vector<double>& x, const std::vector<double>& value, double at) {
  if (at <= x.front()) return value.front();
  if (at >= x.back()) return value.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  return std::lerp(value[above - 1], value[above], (at - x[above - 1]) / (x[above] - x[above - 1]));
}

Axis Ground::natural_axis(Sense sense) const {
  int moved = 0;
  Axis only = direction_of(sense);
  for (const Axis a : kAllAxes)
    if (cover(sense, a).moved) {
      ++moved;
      only = a;
    }
  return moved == 1 ? only : direction_of(sense);
}

Ground ground_of(const Scene& scene) {
  Ground ground;
  std::array<std::array<int, 3>, 6> ways{};
  for (const Stop& stop : scene.stops) {
    const auto s = static_cast<std::size_t>(stop.sense);
    if (std::find(ground.senses.begin(), ground.senses.end(), stop.sense) == ground.senses.end())
      ground.senses.push_back(stop.sense);
    for (const Axis a : kAllAxes)
      if (scene.chain.has(a)) ground.covers[s][index_of(a)].places_mm.push_back(scene.p_mm(stop, a));
    ground.covers[s][index_of(stop.axis)].moved = true;
    ways[s][index_of(stop.axis)] |= stop.approach > 0 ? 1 : 2;
  }
  for (std::size_t s = 0; s < 6; ++s)
    for (std::size_t a = 0; a < 3; ++a) {
      auto& places = ground.covers[s][a].places_mm;
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
      ground.covers[s][a].both_ways = ways[s][a] == 3;
    }
  return ground;
}

double refractivity(double air_degC, double pressure_hPa, double humidity_pct) {
  constexpr double kWavenumber2 = 1.0 / (0.6329908 * 0.6329908);  // um^-2
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - kWavenumber2) + 15998.0 / (38.9 - kWavenumber2));
  const double pressure_Pa = pressure_hPa * 100.0;
  const double dry = standard * pressure_Pa / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * air_degC) * pressure_Pa) /
                     (1.0 + 0.003661 * air_degC);
  const double saturated_Pa = 611.2 * std::exp(17.62 * air_degC / (243.12 + air_degC));
  return dry - 0.01 * humidity_pct * saturated_Pa * (3.7345 - 0.0401 * kWavenumber2) * 1e-10;
}

double missing_refraction(const Scene& scene, const Stop& stop) {
  return refractivity(scene.degC("t_air_degC", stop, 20.0), stop.weather.pressure_hPa, stop.weather.humidity_pct) -
         refractivity(20.0, 1013.25, 50.0);
}

namespace {

constexpr double kOverrun_mm = 5.0;
constexpr double kTurn_s = 8.0;  ///< to run past the end and come back

/// Time passing while the axes go from stop to stop.
class Traveller {
 public:
  Traveller(const Travel& travel, std::vector<Stop>& stops) : travel_(travel), stops_(stops) {}

  void pass(const Line& line, int run, bool forward) {
    std::vector<double> targets = travel_.targets_mm[index_of(line.axis)];
    if (!forward) std::reverse(targets.begin(), targets.end());
    const auto turn = static_cast<std::size_t>(run - 1);
    Stop stop;
    stop.axis = line.axis;
    stop.sense = line.sense;
    stop.position_mm = line.parked_mm;
    stop.approach = forward ? 1 : -1;
    stop.run = run;
    stop.feed_mm_min = travel_.feeds_mm_min[turn % travel_.feeds_mm_min.size()];
    stop.load_kg = travel_.loads_kg[turn % travel_.loads_kg.size()];
    clock_s_ += kTurn_s;
    double before_mm = targets.front();
    for (const double target_mm : targets) {
      clock_s_ += std::abs(target_mm - before_mm) / stop.feed_mm_min * 60.0 + travel_.dwell_s;
      before_mm = target_mm;
      stop.position_mm[index_of(line.axis)] = target_mm;
      stop.travel_since_reversal_mm = kOverrun_mm + std::abs(target_mm - targets.front());
      stop.time_s = clock_s_;
      stops_.push_back(stop);
    }
  }
  void wait(double seconds) { clock_s_ += seconds; }

 private:
  const Travel& travel_;
  std::vector<Stop>& stops_;
  double clock_s_ = 0.0;
};

constexpr double kStep_s = 20.0;

/// A slow wander: a few waves of random length.
class Wander {
 public:
  Wander(Random& random, double size, double shortest_s, double longest_s) {
    for (int k = 0; k < 3; ++k)
      waves_.push_back({size * between(random, 0.3, 1.0), log_between(random, shortest_s, longest_s),
                        between(random, 0.0, 2.0 * std::numbers::pi)});
  }
  [[nodiscard]] double at(double time_s) const {
    double sum = 0.0;
    for (const Wave& w : waves_) sum += w.size * std::sin(2.0 * std::numbers::pi * time_s / w.period_s + w.phase);
    return sum;
  }

 private:
  struct Wave {
    double size, period_s, phase;
  };
  std::vector<Wave> waves_;
};

/// A body that follows its surroundings with a lag, and may be heated from inside now and then.
struct Body {
  std::string name;
  double lag_s = 3600.0;
  double heating_degC = 0.0;
  double heating_lag_s = 1500.0;
  std::vector<double> switched_s;  ///< the heat goes on, off, on …
  double own = 0.0;
  double warm = 0.0;

  void step(double air_degC, double time_s) {
    own += (air_degC - own) * kStep_s / lag_s;
    const auto switches = std::upper_bound(switched_s.begin(), switched_s.end(), time_s) - switched_s.begin();
    warm += ((switches % 2 == 1 ? heating_degC : 0.0) - warm) * kStep_s / heating_lag_s;
  }
  [[nodiscard]] double degC() const { return own + warm; }
};

std::vector<Body> draw_bodies(Random& random, double air_degC, double duration_s) {
  std::vector<Body> bodies;
  const auto add = [&](const char* name, double lag_low_s, double lag_high_s, double heating_degC) {
    Body body;
    body.name = name;
    body.lag_s = log_between(random, lag_low_s, lag_high_s);
    body.heating_degC = heating_degC * between(random, 0.5, 1.5);
    body.heating_lag_s = log_between(random, 400.0, 2400.0);
    body.own = air_degC + between(random, -1.5, 1.5);
    const int switches = whole(random, 1, 4);
    for (int k = 0; k < switches; ++k) body.switched_s.push_back(between(random, 0.0, 0.9 * duration_s));
    std::sort(body.switched_s.begin(), body.switched_s.end());
    bodies.push_back(body);
  };
  add("t_material_degC", 1500.0, 6000.0, 1.5);
  if (chance(random, 0.7)) add("t_spindle_degC", 2000.0, 7000.0, 8.0);
  if (chance(random, 0.4)) add("t_column_degC", 4000.0, 15000.0, 2.0);
  if (chance(random, 0.2)) add("t_oil_degC", 1500.0, 4000.0, 5.0);
  return bodies;
}

/// One temperature of each body, one pressure, one humidity for the whole measurement.
void hold_still(Random& random, const Needs& needs, Scene& scene) {
  Weather weather;
  const auto sensor = [&](const char* name) {
    scene.sensors.emplace_back(name);
    weather.degC.push_back(rounded(20.0 + sign_of_chance(random) * between(random, 1.0, 5.0), 100.0));
  };
  if (needs.air) sensor("t_air_degC");
  if (needs.temperature) sensor("t_material_degC");
  if (needs.air) {
    weather.pressure_hPa = rounded(between(random, 970.0, 1030.0), 10.0);
    weather.humidity_pct = rounded(between(random, 30.0, 65.0), 10.0);
  }
  for (Stop& stop : scene.stops) stop.weather = weather;
}

}  // namespace

std::vector<Stop> stops_along(const std::vector<Line>& lines, const Travel& travel) {
  std::vector<Stop> stops;
  Traveller traveller(travel, stops);
  for (int run = 1; run <= travel.runs; ++run) {
    for (const Line& line : lines) {
      traveller.pass(line, run, !travel.backward_first);
      if (travel.bidirectional) traveller.pass(line, run, travel.backward_first);
    }
    traveller.wait(travel.pause_s);
  }
  const double first_s = stops.front().time_s;
  for (Stop& stop : stops) stop.time_s = std::round((stop.time_s - first_s) * 10.0) / 10.0;
  return stops;
}

void draw_weather(Random& random, const Needs& needs, Scene& scene) {
  if (needs.constant) return hold_still(random, needs, scene);
  const bool sensors = needs.temperature || needs.air || chance(random, 0.35);
  if (!sensors) return;
  const double duration_s = scene.stops.back().time_s;
  const Wander air(random, needs.temperature || needs.air ? 2.0 : 0.5, std::max(1800.0, duration_s / 3.0), 90'000.0);
  const Wander draught(random, 0.03, 120.0, 900.0);
  const Wander pressure(random, 5.0, std::max(3600.0, duration_s / 2.5), 60'000.0);
  const Wander humidity(random, 5.0, std::max(3600.0, duration_s / 3.0), 60'000.0);
  const double level_degC = between(random, 18.0, 24.0);
  const double level_hPa = between(random, 985.0, 1025.0);
  auto bodies = draw_bodies(random, level_degC + air.at(0.0), duration_s);
  scene.sensors = {"t_air_degC"};
  for (const Body& body : bodies) scene.sensors.push_back(body.name);
  double clock_s = 0.0;
  for (Stop& stop : scene.stops) {
    for (; clock_s < stop.time_s; clock_s += kStep_s)
      for (Body& body : bodies) body.step(level_degC + air.at(clock_s), clock_s);
    stop.weather.pressure_hPa = level_hPa + pressure.at(stop.time_s);
    stop.weather.humidity_pct = 48.0 + humidity.at(stop.time_s);
    stop.weather.degC = {level_degC + air.at(stop.time_s) + draught.at(stop.time_s)};
    for (const Body& body : bodies) {
      const double part = 1.0 - (clock_s - stop.time_s) / kStep_s;
      Body now = body;
      now.own += (level_degC + air.at(stop.time_s) - now.own) * (part - 1.0) * kStep_s / now.lag_s;
      stop.weather.degC.push_back(now.degC());
    }
  }
}

}  // namespace ecs::emulator
