#include "modules/hidden_cases/scene.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "base/moved_targets.hpp"

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

namespace {

/// Refractive index of air less 1, at 633 nm: Edlén's equation as revised by Birch and Downs (Metrologia 30, 1993, 155;
/// 31, 1994, 315), with the Magnus formula for the vapour pressure.
double refractivity(double air_degC, double pressure_hPa, double humidity_pct) {
  constexpr double kWavenumber2 = 1.0 / (0.6329908 * 0.6329908);  // um^-2
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - kWavenumber2) + 15998.0 / (38.9 - kWavenumber2));
  const double pressure_Pa = pressure_hPa * 100.0;
  const double dry = standard * pressure_Pa / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * air_degC) * pressure_Pa) /
                     (1.0 + 0.003661 * air_degC);
  const double saturated_Pa = 611.2 * std::exp(17.62 * air_degC / (243.12 + air_degC));
  return dry - 0.01 * humidity_pct * saturated_Pa * (3.7345 - 0.0401 * kWavenumber2) * 1e-10;
}

}  // namespace

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

/// Sensors and weather for stops that have their times.
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
std::string draw_configuration(Random& random, int axes) {
  std::vector<char> letters{'X', 'Y', 'Z'};
  if (axes == 3 || chance(random, 0.3)) shuffle(random, letters);
  letters.resize(static_cast<std::size_t>(axes));
  std::string text(letters.begin(), letters.end());
  const int carrying_work = axes == 1 && chance(random, 0.7) ? 0 : whole(random, 0, axes);
  text.insert(static_cast<std::size_t>(carrying_work), "T");
  return text;
}

params::MachineAxis draw_axis(Random& random) {
  params::MachineAxis axis;
  const double length_mm = rounded(log_between(random, 250.0, 4000.0), 0.02);
  const int kind = whole(random, 0, 2);
  axis.travel_mm = kind == 0   ? std::array{0.0, length_mm}
                   : kind == 1 ? std::array{-length_mm, 0.0}
                               : std::array{-length_mm / 2.0, length_mm / 2.0};
  axis.datum_mm = chance(random, 0.8) ? 0.0 : one(random, std::vector{axis.travel_mm[0], axis.travel_mm[1]});
  axis.transducer = chance(random, 0.8) ? Transducer::encoder : Transducer::resolver;
  axis.resolution_um = one(random, std::vector{0.1, 0.5, 1.0});
  if (chance(random, 0.85)) axis.screw_pitch_mm = one(random, std::vector{5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0});
  if (chance(random, 0.5)) axis.scale_pitch_mm = one(random, std::vector{0.02, 0.04, 0.1});
  if (chance(random, 0.8)) axis.expansion_um_per_m_degC = one(random, std::vector{8.0, 10.5, 11.7, 12.2});
  return axis;
}

std::vector<Axis> axes_of(const Scene& scene) {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    if (scene.chain.has(a)) axes.push_back(a);
  return axes;
}
const std::array<double, 2>& travel_of(const Scene& scene, Axis axis) {
  return scene.machine.axes[index_of(axis)]->travel_mm;
}

/// On the axis's measurement line, else at the datums.
Vector3 parking_place(const Scene& scene, Axis moving) {
  Vector3 place{};
  for (const Axis a : axes_of(scene)) {
    const auto& line = scene.machine.axes[index_of(moving)]->measurement_line_mm[index_of(a)];
    place[index_of(a)] = line.value_or(scene.datum_mm[index_of(a)]);
  }
  return place;
}

/// `count` places spread over the travel of an axis.
std::vector<double> places_of(Random& random, const Scene& scene, Axis axis, int count) {
  const auto& [low_mm, high_mm] = travel_of(scene, axis);
  std::vector<double> places;
  for (int k = 0; k < count; ++k)
    places.push_back(rounded(low_mm + (high_mm - low_mm) * (k + between(random, 0.1, 0.9)) / count, 0.1));
  return places;
}

/// A rotation of one axis, seen in one direction with one lever.
struct Lever {
  Component code = Component::ECX;
  Axis observed = Axis::X;
  Axis lever = Axis::Y;
};
std::vector<Lever> levers_of(const Scene& scene) {
  std::vector<Lever> levers;
  for (const Term& term : scene.terms)
    if (is_angular(term.component) && term.uses_coordinate && term.lever != moving_axis(term.component) &&
        scene.chain.has(term.observed))
      levers.push_back({term.component, term.observed, term.lever});
  return levers;
}

std::vector<Line> lever_lines(Random& random, const Scene& scene, const Needs& needs) {
  const auto levers = levers_of(scene);
  if (levers.empty()) return {};
  const Lever& lever = one(random, levers);
  const Axis moving = moving_axis(lever.code);
  std::vector<Line> lines;
  Line line{moving, static_cast<Sense>(index_of(lever.observed)), parking_place(scene, moving)};
  for (const double place_mm : places_of(random, scene, lever.lever, whole(random, 2, 5))) {
    line.parked_mm[index_of(lever.lever)] = place_mm;
    lines.push_back(line);
  }
  if (!needs.fine && chance(random, 0.4)) lines.push_back({lever.lever, line.sense, parking_place(scene, lever.lever)});
  return lines;
}

std::vector<Line> grid_lines(Random& random, const Scene& scene) {
  auto axes = axes_of(scene);
  shuffle(random, axes);
  std::vector<Line> lines;
  Line line{axes[0], translation_along(one(random, axes)), parking_place(scene, axes[0])};
  for (const double place_mm : places_of(random, scene, axes[1], whole(random, 4, 7))) {
    line.parked_mm[index_of(axes[1])] = place_mm;
    lines.push_back(line);
  }
  return lines;
}

std::vector<Line> square_lines(Random& random, const Scene& scene) {
  std::vector<Line> lines;
  for (const Term& term : scene.terms)
    if (is_squareness(term.component))
      lines.push_back({term.lever, translation_along(term.observed), parking_place(scene, term.lever)});
  if (lines.empty()) return {};
  std::vector<Line> chosen{one(random, lines)};
  if (chance(random, 0.5)) {  // the axis that it is square to
    const Axis first = direction_of(chosen[0].sense);
    chosen.push_back({first, translation_along(first), parking_place(scene, first)});
  }
  return chosen;
}

std::vector<Line> free_lines(Random& random, const Scene& scene, const Needs& needs) {
  auto axes = axes_of(scene);
  shuffle(random, axes);
  const double what = needs.whole_runs ? 0.0 : random.uniform();
  std::vector<Line> lines;
  if (what > 0.85 && axes.size() > 1 && !needs.one_axis) {  // every axis in two or three directions
    for (const Axis a : axes)
      for (const Axis s : axes)
        if (a == s || chance(random, 0.7)) lines.push_back({a, translation_along(s), parking_place(scene, a)});
    return lines;
  }
  if (what > 0.65 && axes.size() > 1 && !needs.one_axis) {  // positioning of every axis
    for (const Axis a : axes) lines.push_back({a, translation_along(a), parking_place(scene, a)});
    return lines;
  }
  if (what > 0.5) {  // one axis in all directions
    for (const Axis s : kAllAxes) lines.push_back({axes[0], translation_along(s), parking_place(scene, axes[0])});
    return lines;
  }
  Line line{axes[0], translation_along(axes[0]), parking_place(scene, axes[0])};
  if (!needs.along && chance(random, 0.35))
    line.sense = translation_along(one(random, std::vector<Axis>(kAllAxes.begin(), kAllAxes.end())));
  if (!needs.along && !needs.translations && chance(random, 0.12))
    line.sense = static_cast<Sense>(3 + whole(random, 0, 2));
  lines.push_back(line);
  return lines;
}

std::vector<Line> draw_lines(Random& random, const Scene& scene, const Needs& needs) {
  if (needs.levers) return lever_lines(random, scene, needs);
  if (needs.squares) return square_lines(random, scene);
  if (needs.grid ||
      (!needs.one_axis && !needs.along && !needs.whole_runs && axes_of(scene).size() > 1 && chance(random, 0.12)))
    return grid_lines(random, scene);
  return free_lines(random, scene, needs);
}

std::vector<double> draw_targets(Random& random, const Scene& scene, Axis axis, int count, bool fine, bool even) {
  auto [low_mm, high_mm] = travel_of(scene, axis);
  const double pitch_mm = scene.machine.axes[index_of(axis)]->screw_pitch_mm.value_or(10.0);
  const bool irregular = !even;
  if (fine && !irregular) {  // a stretch of the travel, closely
    const double step_mm = pitch_mm / between(random, 3.2, 6.0);
    const double length_mm = std::min(high_mm - low_mm, step_mm * (count - 1));
    low_mm += between(random, 0.0, high_mm - low_mm - length_mm);
    high_mm = low_mm + length_mm;
  } else {
    const double margin_mm = 0.03 * (high_mm - low_mm);
    low_mm += between(random, 0.0, margin_mm);
    high_mm -= between(random, 0.0, margin_mm);
  }
  std::vector<double> targets;
  for (int k = 0; k < count; ++k) {
    const double place = irregular ? (k + between(random, 0.1, 0.9)) / count : k / (count - 1.0);
    targets.push_back(rounded(low_mm + (high_mm - low_mm) * place, irregular ? 1000.0 : 100.0));
  }
  return even ? moved_targets(std::move(targets)) : targets;
}

Travel draw_travel(Random& random, const Needs& needs, std::size_t lines, std::size_t readings, Scene& scene) {
  Travel travel;
  travel.bidirectional = needs.bidirectional || chance(random, 0.75);
  travel.backward_first = chance(random, 0.3);
  const double passes = static_cast<double>(lines) * (travel.bidirectional ? 2.0 : 1.0);
  const double wanted = static_cast<double>(readings);
  const int least_targets = needs.fine ? 24 : lines > 3 ? 7 : 10;
  const int most_runs = std::max(1, static_cast<int>(wanted / passes / least_targets));
  travel.runs = std::max(std::min(most_runs, one(random, std::vector{1, 2, 3, 3, 5, 5, 7, 10})), needs.least_runs);
  if (needs.one_run) travel.runs = 1;
  const int count = std::max(least_targets, static_cast<int>(std::ceil(wanted / passes / travel.runs)));
  scene.even_grid = !chance(random, 0.45) && !needs.irregular;
  for (const Axis a : axes_of(scene))
    travel.targets_mm[index_of(a)] = draw_targets(random, scene, a, count, needs.fine, scene.even_grid);
  travel.dwell_s = between(random, 1.0, 5.0);
  const bool slow = needs.temperature || needs.air || needs.time;
  travel.pause_s = slow && !needs.constant ? log_between(random, 400.0, 3000.0) : log_between(random, 20.0, 300.0);
  travel.feeds_mm_min = {one(random, std::vector{1000.0, 2000.0, 3000.0, 5000.0})};
  if (needs.feeds) travel.feeds_mm_min = {1000.0, 6000.0, 3000.0};
  if (needs.loads)
    travel.loads_kg =
        one(random, std::vector<std::vector<double>>{{0.0, 500.0, 250.0}, {0.0, 800.0}, {100.0, 300.0, 0.0, 600.0}});
  return travel;
}

/// An axis that is measured itself is parked inside the stretch on which it is: nobody knows its errors elsewhere.
void park_where_measured(std::vector<Line>& lines, const Travel& travel) {
  for (Line& line : lines)
    for (const Line& other : lines) {
      if (other.axis == line.axis) continue;
      const auto& targets = travel.targets_mm[index_of(other.axis)];
      double& parked_mm = line.parked_mm[index_of(other.axis)];
      parked_mm = std::clamp(parked_mm, targets.front(), targets.back());
    }
}

void show_columns(Random& random, const Needs& needs, Scene& scene) {
  Shown& s = scene.shown;
  const bool one_run = scene.stops.back().run == 1;
  bool two_ways = false;
  for (const Stop& stop : scene.stops) two_ways = two_ways || stop.approach != scene.stops.front().approach;
  s.run = !one_run || chance(random, 0.7);
  s.approach = two_ways || needs.bidirectional || chance(random, 0.7);
  s.time = needs.time || needs.temperature || needs.air || !scene.sensors.empty() || chance(random, 0.75);
  s.feed = needs.feeds || (!needs.constant && chance(random, 0.2));
  s.load = needs.loads;
  s.travel = needs.travel || (!needs.constant && chance(random, 0.15));
  s.air = needs.air || (!needs.constant && !scene.sensors.empty() && chance(random, 0.5));
  s.first_time_s = chance(random, 0.3) ? rounded(between(random, 5.0, 5000.0), 1.0) : 0.0;
}

/// A machine of one to three axes in any configuration.
params::Machine draw_machine(Random& random, int least_axes) {
  params::Machine machine;
  machine.name = fmt::format("machine {}", whole(random, 1000, 9999));
  machine.configuration = draw_configuration(random, std::max(least_axes, one(random, std::vector{1, 2, 3, 3})));
  const auto chain = ecs::chain_of(machine.configuration);
  for (const Axis a : kAllAxes)
    if (chain->has(a)) machine.axes[index_of(a)] = draw_axis(random);
  for (const Axis a : kAllAxes) {
    if (!chain->has(a) || chance(random, 0.3)) continue;
    for (const Axis other : kAllAxes) {
      if (other == a || !chain->has(other)) continue;
      const auto& travel = machine.axes[index_of(other)]->travel_mm;
      machine.axes[index_of(a)]->measurement_line_mm[index_of(other)] =
          rounded(between(random, travel[0], travel[1]), 0.1);
    }
  }
  return machine;
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

void settle_geometry(Scene& scene) {
  scene.chain = *params::chain_of(scene.machine);
  scene.lines_mm = params::measurement_lines_of(scene.machine);
  scene.terms = *terms_of(scene.chain, Convention::iso, CurveKind::carriage);
  for (const Axis a : kAllAxes)
    if (const auto& axis = scene.machine.axes[index_of(a)]) scene.datum_mm[index_of(a)] = axis->datum_mm;
}

Needs operator|(const Needs& a, const Needs& b) {
  constexpr std::array kFlags{&Needs::temperature,   &Needs::air,       &Needs::feeds,   &Needs::loads,
                              &Needs::travel,        &Needs::map,       &Needs::known,   &Needs::one_axis,
                              &Needs::bidirectional, &Needs::fine,      &Needs::along,   &Needs::translations,
                              &Needs::levers,        &Needs::squares,   &Needs::grid,    &Needs::constant,
                              &Needs::time,          &Needs::irregular, &Needs::one_run, &Needs::whole_runs};
  Needs n;
  for (const auto flag : kFlags) n.*flag = a.*flag || b.*flag;
  n.least_axes = std::max(a.least_axes, b.least_axes);
  n.least_runs = std::max(a.least_runs, b.least_runs);
  return n;
}

Scene draw_scene(Random& random, const Needs& needs, std::size_t readings) {
  Scene scene;
  scene.machine = draw_machine(random, needs.least_axes);
  settle_geometry(scene);
  auto lines = draw_lines(random, scene, needs);
  if (lines.empty()) return scene;
  const Travel travel = draw_travel(random, needs, lines.size(), readings, scene);
  park_where_measured(lines, travel);
  scene.stops = stops_along(lines, travel);
  draw_weather(random, needs, scene);
  show_columns(random, needs, scene);
  return scene;
}

}  // namespace ecs::emulator
