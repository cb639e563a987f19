// The XYTZ machine under the thesis's printed equation (27): what it lacks in E_Y, the term ECY·X, is what is hidden.
#include "base/moved_targets.hpp"
#include "ecs_emulator/effects/places.hpp"
#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/effects/shape.hpp"
#include "ecs_emulator/hidden_cases/compose.hpp"
#include "ecs_emulator/scene/design.hpp"

namespace ecs::emulator {
namespace {

params::Machine compound_table() {
  params::Machine machine;
  machine.name = "machining centre with compound table";
  machine.configuration = "XYTZ";
  const std::array<double, 3> travel_mm{800.0, 500.0, 400.0};
  for (const Axis a : kAllAxes) {
    params::MachineAxis axis;
    axis.travel_mm = {0.0, travel_mm[index_of(a)]};
    axis.screw_pitch_mm = 10.0;
    axis.expansion_um_per_m_degC = 11.7;
    axis.measurement_line_mm = {0.0, 0.0, 0.0};
    axis.measurement_line_mm[index_of(a)].reset();
    machine.axes[index_of(a)] = axis;
  }
  return machine;
}

/// E_Y over X at several places of Y and Z, and over Y on one line.
std::vector<Stop> stops_in_EY() {
  std::vector<Line> lines;
  for (const double y_mm : {20.0, 140.0, 260.0, 380.0, 480.0})
    for (const double z_mm : {50.0, 300.0}) lines.push_back({Axis::X, Sense::EY, {0.0, y_mm, z_mm}});
  lines.push_back({Axis::Y, Sense::EY, {0.0, 0.0, 50.0}});
  Travel travel;
  for (int k = 0; k <= 16; ++k) travel.targets_mm[index_of(Axis::X)].push_back(20.0 + 47.5 * k);
  for (const double y_mm : {20.0, 80.0, 140.0, 200.0, 260.0, 320.0, 380.0, 430.0, 480.0})
    travel.targets_mm[index_of(Axis::Y)].push_back(y_mm);
  for (std::vector<double>& targets_mm : travel.targets_mm) targets_mm = moved_targets(std::move(targets_mm));
  travel.runs = 2;
  return stops_along(lines, travel);
}

}  // namespace

std::optional<HiddenCase> compose_xytz(Random& random, const Wanted& wanted) {
  HiddenCase c;
  c.kind = CaseKind::single;
  c.scene.machine = compound_table();
  settle_geometry(c.scene);
  c.scene.stops = stops_in_EY();
  const Ground ground = ground_of(c.scene);
  Absorbed absorbed(c.scene.stops.size());
  const auto at = [](const char* id, Axis axis, std::optional<Sense> sense, std::optional<Component> code) {
    return at_place(*effect_named(id), axis, sense, code);
  };
  for (const PlacedEffect& place :
       {at("offset", Axis::Y, Sense::EY, {}), at("scale", Axis::Y, Sense::EY, {}),
        at("progressive", Axis::Y, Sense::EY, {}), at("angular", Axis::X, {}, Component::ECX),
        at("angular", Axis::X, {}, Component::EAX), at("angular", Axis::Y, {}, Component::EAY)}) {
    c.base.push_back(*with_shape(random, c.scene, ground, place));
    absorbed.add(contribution_columns(c.scene, ground, c.base.back()));
  }
  const auto hidden = with_shape(random, c.scene, ground, at("angular", Axis::Y, {}, Component::ECY));
  c.hidden.push_back({*hidden, 0.0, 0.0});
  return finished(random, std::move(c), ground, absorbed, wanted.snr);
}

}  // namespace ecs::emulator
