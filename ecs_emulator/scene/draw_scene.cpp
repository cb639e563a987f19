// Machines, and the lines that are measured on them.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/moved_targets.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {
namespace {

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
