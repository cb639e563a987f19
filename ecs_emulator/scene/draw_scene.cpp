#include <algorithm>
#include <cmath>

#include "base/moved_targets.hpp"
#include "ecs_emulator/random/draw.hpp"
#include "ecs_emulator/scene/design.hpp"

namespace ecs::emulator {
namespace {

std::vector<Axis> axes_of(const Scene& scene) {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    if (scene.chain.has(a)) axes.push_back(a);
  return axes;
}
const std::array<double, 2>& travel_of(const Scene& scene, Axis axis) {
  return scene.machine.axes[index_of(axis)]->travel_mm;
}
Sense along(Axis axis) { return static_cast<Sense>(index_of(axis)); }

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
  Line line{axes[0], along(one(random, axes)), parking_place(scene, axes[0])};
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
      lines.push_back({term.lever, along(term.observed), parking_place(scene, term.lever)});
  if (lines.empty()) return {};
  std::vector<Line> chosen{one(random, lines)};
  if (chance(random, 0.5)) {  // the axis that it is square to
    const Axis first = direction_of(chosen[0].sense);
    chosen.push_back({first, along(first), parking_place(scene, first)});
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
        if (a == s || chance(random, 0.7)) lines.push_back({a, along(s), parking_place(scene, a)});
    return lines;
  }
  if (what > 0.65 && axes.size() > 1 && !needs.one_axis) {  // positioning of every axis
    for (const Axis a : axes) lines.push_back({a, along(a), parking_place(scene, a)});
    return lines;
  }
  if (what > 0.5) {  // one axis in all directions
    for (const Axis s : kAllAxes) lines.push_back({axes[0], along(s), parking_place(scene, axes[0])});
    return lines;
  }
  Line line{axes[0], along(axes[0]), parking_place(scene, axes[0])};
  if (!needs.along && chance(random, 0.35))
    line.sense = along(one(random, std::vector<Axis>(kAllAxes.begin(), kAllAxes.end())));
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

}  // namespace

Needs operator|(const Needs& a, const Needs& b) {
  Needs n;
  n.temperature = a.temperature || b.temperature;
  n.air = a.air || b.air;
  n.feeds = a.feeds || b.feeds;
  n.loads = a.loads || b.loads;
  n.travel = a.travel || b.travel;
  n.map = a.map || b.map;
  n.known = a.known || b.known;
  n.one_axis = a.one_axis || b.one_axis;
  n.bidirectional = a.bidirectional || b.bidirectional;
  n.fine = a.fine || b.fine;
  n.along = a.along || b.along;
  n.translations = a.translations || b.translations;
  n.levers = a.levers || b.levers;
  n.squares = a.squares || b.squares;
  n.grid = a.grid || b.grid;
  n.constant = a.constant || b.constant;
  n.time = a.time || b.time;
  n.irregular = a.irregular || b.irregular;
  n.least_axes = std::max(a.least_axes, b.least_axes);
  n.least_runs = std::max(a.least_runs, b.least_runs);
  n.one_run = a.one_run || b.one_run;
  n.whole_runs = a.whole_runs || b.whole_runs;
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
