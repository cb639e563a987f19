// Designs on which different effects do exactly the same: the group of a confounded case. The XYTZ machine under the
// thesis's printed equation (27): what it lacks in E_Y, the term ECY·X, is what is hidden.
#include <algorithm>

#include "base/moved_targets.hpp"
#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/effects/drawing.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/design.hpp"
#include "modules/hidden_cases/compose.hpp"
#include "modules/hidden_cases/space.hpp"

namespace ecs::emulator {

struct ConfoundedDesign {
  Design::Id id;
  Needs needs;
  Shown shown{.time = false};
  int lines = 1;                  ///< drawn, of which the first is kept
  bool one_axis_machine = false;  ///< squareness would do the same
};

namespace {

/// What all of them need: nothing changes but the position.
constexpr Needs kConstant{.one_axis = true, .translations = true, .constant = true, .irregular = true, .least_runs = 2};

Needs along(Needs needs) {
  needs.along = needs.whole_runs = true;
  return needs | kConstant;
}

const std::array<ConfoundedDesign, 8>& designs() {
  constexpr Shown kWithFeed{.time = false, .feed = true};
  constexpr Shown kWithAir{.time = false, .air = true};
  static const std::array<ConfoundedDesign, 8> kDesigns{{
      {.id = Design::kWarm, .needs = along({.temperature = true})},
      {.id = Design::kAir, .needs = along({.air = true}), .shown = kWithAir},
      {.id = Design::kWarmAir, .needs = along({.temperature = true, .air = true}), .shown = kWithAir},
      {.id = Design::kOneFeed, .needs = along({.bidirectional = true}), .shown = kWithFeed},
      {.id = Design::kZero,
       .needs = along({.air = true, .bidirectional = true}),
       .shown = kWithAir,
       .one_axis_machine = true},
      {.id = Design::kSquare, .needs = Needs{.squares = true, .least_axes = 2} | kConstant},
      {.id = Design::kOneLever,
       .needs = Needs{.levers = true, .least_axes = 2, .whole_runs = true} | kConstant,
       .lines = 3},
      {.id = Design::kCold, .needs = along({})},
  }};
  return kDesigns;
}

/// Effects that such a design can hide.
std::vector<const EffectDefinition*> members_of(const ConfoundedDesign& design) {
  std::vector<const EffectDefinition*> members;
  for (const EffectDefinition* kind : effects())
    if ((kind->confounded_in & design.id) != 0) members.push_back(kind);
  return members;
}

/// Keeps one line of the first axis and sense.
void keep_first_line(Scene& scene) {
  const Stop first = scene.stops.front();
  const std::size_t moving = index_of(first.axis);
  std::erase_if(scene.stops, [&](const Stop& stop) {
    Vector3 place = stop.position_mm;
    place[moving] = first.position_mm[moving];
    return stop.axis != first.axis || stop.sense != first.sense || place != first.position_mm;
  });
}

Scene confounded_scene(Random& random, const Wanted& wanted) {
  const ConfoundedDesign& design = *wanted.design;
  Scene scene = draw_scene(random, design.needs, wanted.readings * static_cast<std::size_t>(design.lines));
  if (scene.stops.empty()) return scene;
  keep_first_line(scene);
  scene.shown = design.shown;
  return scene;
}

/// A size that nature allows, with some room.
bool is_natural(const Rival& rival) {
  if (!rival.effect.kind->natural_size) return true;
  const Range& range = rival.effect.kind->parameters.front().range;
  return rival.size > range.above && rival.size < range.below;
}

/// A rotation that acts on its own line through the position of its own axis.
bool has_own_lever(const Scene& scene, const PlacedEffect& effect) {
  if (effect.kind->placed_by != PlacedBy::code_of_rotation) return false;
  return std::any_of(scene.terms.begin(), scene.terms.end(), [&](const Term& term) {
    return term.component == *effect.code && term.observed == direction_of(scene.stops.front().sense) &&
           term.uses_coordinate && term.lever == moving_axis(*effect.code);
  });
}

/// All that do the same as the hidden effect; empty where somebody comes too near without being the same.
std::vector<std::string> group_of(const HiddenCase& c, const Ground& ground, const Absorbed& absorbed,
                                  const ConfoundedDesign& design) {
  const auto members = members_of(design);
  const bool curves = std::all_of(members.begin(), members.end(), [](const auto* kind) { return is_flexible(*kind); });
  std::vector<std::string> group;
  bool disturbed = false;
  const auto weigh = [&](const Rival& rival) {
    if (rival.separation >= kApart) return false;
    const bool expected = curves ? (rival.effect.kind->confounded_in & design.id) != 0 : !rival.flexible;
    disturbed = rival.separation > kSame || !expected || !is_natural(rival) || has_own_lever(c.scene, rival.effect);
    group.push_back(name_of(rival.effect));
    return disturbed;
  };
  const auto hidden = vector_of(contribution(c.scene, c.hidden.front().effect));
  const auto tried = rivals_of(c.scene, ground, absorbed, hidden, c.noise.sigma_um, true, weigh);
  return disturbed || tried.empty() ? std::vector<std::string>{} : group;
}

std::optional<PlacedEffect> member(Random& random, const Wanted& wanted, const Scene& scene, const Ground& ground) {
  const EffectDefinition& kind =
      wanted.effects.empty() ? *one(random, members_of(*wanted.design)) : *wanted.effects.front();
  const bool rotation = kind.placed_by == PlacedBy::code_of_rotation;
  auto places = rotation ? possible_places(scene, ground, kind) : good_places(scene, ground, kind);
  std::erase_if(places, [&](const PlacedEffect& place) { return rotation && *place.axis != scene.stops.front().axis; });
  if (places.empty()) return std::nullopt;
  return with_shape(random, scene, ground, one(random, places));
}

/// What holds mean and slope of the curves of the group.
std::vector<PlacedEffect> lines_of(const ConfoundedDesign& design, const Stop& first) {
  std::vector<PlacedEffect> lines;
  for (const EffectDefinition* kind : members_of(design))
    if (const auto line = line_of(at_place(*kind, first.axis, first.sense))) lines.push_back(*line);
  return lines;
}

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

const std::vector<const ConfoundedDesign*>& confounded_designs() {
  static const std::vector<const ConfoundedDesign*> kAll = [] {
    std::vector<const ConfoundedDesign*> all;
    for (const ConfoundedDesign& design : designs()) all.push_back(&design);
    return all;
  }();
  return kAll;
}

std::vector<const ConfoundedDesign*> confounded_designs_of(const EffectDefinition& kind) {
  std::vector<const ConfoundedDesign*> found = confounded_designs();
  std::erase_if(found, [&](const ConfoundedDesign* design) { return (kind.confounded_in & design->id) == 0; });
  return found;
}

std::optional<HiddenCase> compose_confounded(Random& random, const Wanted& wanted) {
  HiddenCase c;
  c.kind = CaseKind::confounded;
  c.scene = confounded_scene(random, wanted);
  if (c.scene.stops.size() < 100) return std::nullopt;
  if (wanted.design->one_axis_machine && c.scene.chain.axis_count() > 1) return std::nullopt;
  const Ground ground = ground_of(c.scene);
  const auto hidden = member(random, wanted, c.scene, ground);
  if (!hidden) return std::nullopt;
  c.hidden.push_back({*hidden, 0.0, 0.0});
  Reserved reserved;
  reserved.hidden = {*hidden};
  reserved.design = wanted.design->id;
  reserved.needed = lines_of(*wanted.design, c.scene.stops.front());
  Absorbed absorbed(c.scene.stops.size());
  c.base = draw_background(random, c.scene, ground, reserved, absorbed);
  const Eigen::VectorXd own = vector_of(contribution(c.scene, *hidden));
  if (!(absorbed.left_of(own).squaredNorm() > kLeastShare * own.squaredNorm())) return std::nullopt;
  auto done = finished(random, std::move(c), ground, absorbed, wanted.snr);
  if (!done) return std::nullopt;
  done->group = group_of(*done, ground, absorbed, *wanted.design);
  if (done->group.size() < 2) return std::nullopt;
  return done;
}

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
