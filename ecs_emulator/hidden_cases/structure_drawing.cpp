#include "ecs_emulator/hidden_cases/structure_drawing.hpp"

#include <algorithm>

#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {

StructureDrawing::StructureDrawing(Random& from, const Scene& on, const Ground& covered)
    : random(from), scene(on), ground(covered), sense(one(from, covered.senses)) {
  for (const Axis a : kAllAxes)
    if (ground.cover(sense, a).moved) axis = a;
  places_mm = &ground.cover(sense, axis).places_mm;
  for (const Stop& stop : scene.stops) runs = std::max(runs, stop.run);
  duration_s = scene.stops.back().time_s;
}

Structure StructureDrawing::with(std::vector<std::string> variables, std::string text, const Value& value) const {
  Structure s;
  for (const Stop& stop : scene.stops) s.value.push_back(stop.sense == sense ? value(stop) : 0.0);
  s.text = std::move(text);
  for (std::string& name : variables) {
    const bool shown = (name != "time_s" || scene.shown.time) && (name != "run" || scene.shown.run);
    if (shown) s.variables.push_back(std::move(name));
  }
  return s;
}

double StructureDrawing::part(const Stop& stop) const {
  return (scene.p_mm(stop, axis) - places_mm->front()) / (places_mm->back() - places_mm->front());
}

std::string StructureDrawing::column_of(Axis axis) { return std::string(1, "xyz"[index_of(axis)]) + "_mm"; }

double StructureDrawing::mean(const Value& value) const {
  double sum = 0.0;
  for (const Stop& stop : scene.stops) sum += value(stop);
  return sum / static_cast<double>(scene.stops.size());
}

std::map<int, double> StructureDrawing::draw_for_each_run() {
  std::map<int, double> values;
  for (int run = 1; run <= runs; ++run) values[run] = random.normal();
  return values;
}

double StructureDrawing::draw_waves() {
  constexpr std::size_t kFewestTargets = 24;
  constexpr double kTargetsAWave = 4.0, kFewest = 3.2;
  if (places_mm->size() < kFewestTargets) return 0.0;
  return log_between(random, kFewest, static_cast<double>(places_mm->size()) / kTargetsAWave);
}

std::optional<std::size_t> StructureDrawing::draw_sensor() {
  if (scene.sensors.size() < 2) return std::nullopt;
  return static_cast<std::size_t>(whole(random, 1, static_cast<int>(scene.sensors.size()) - 1));
}

Structure draw_structure(Random& random, const Scene& scene, const Ground& ground,
                         const StructureDefinition& definition) {
  StructureDrawing drawing(random, scene, ground);
  return definition.draw(drawing);
}

}  // namespace ecs::emulator
