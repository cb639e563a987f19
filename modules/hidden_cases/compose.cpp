// One try at each kind of hidden case. Designs on which different effects do exactly the same: the group of a
// confounded case. The XYTZ machine under the thesis's printed equation (27): what it lacks in E_Y, the term ECY·X, is
// what is hidden.
#include "modules/hidden_cases/compose.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/moved_targets.hpp"

namespace ecs::emulator {
namespace {

constexpr double kForeign = 0.6;  ///< of the size of foreign structure that the library's best three must leave
constexpr int kLibrarySteps = 3;
constexpr double kOfRuns = 0.1;       ///< of the mean square of an effect that offsets of runs leave: no more is theirs
constexpr Eigen::Index kFewRuns = 4;  ///< below, a condition that changes from run to run only is an offset of each
constexpr int kLeastRuns = 5;         ///< in which a zero that moves from run to run shows
constexpr double kHallSensor = 0.3;   ///< how often a free base comes with a sensor that coincides with runs

/// What a design needs beyond what the hidden effect asks for: it must not give the effect away.
Needs distractions(Random& random, const Needs& needs) {
  Needs n = needs;
  const auto maybe = [&](bool& need, double probability) { need = need || chance(random, probability); };
  maybe(n.temperature, 0.15);
  maybe(n.feeds, 0.1);
  maybe(n.loads, 0.1);
  maybe(n.travel, 0.1);
  maybe(n.fine, 0.2);
  if (n.temperature || n.feeds || n.loads) n.least_runs = std::max(n.least_runs, 3);
  return n;
}

/// A map for some of the components that are measured; the first table is for one of them.
void draw_map(Random& random, Scene& scene, const Ground& ground, bool two_tables) {
  for (const Sense s : ground.senses) {
    for (const Axis a : kAllAxes) {
      const auto& cover = ground.cover(s, a);
      if (!cover.moved || is_rotation(s)) continue;
      SmoothCurve shape = draw_curve(random, cover.places_mm);
      shape.slope = random.normal();
      SmoothCurve difference = draw_curve(random, cover.places_mm);
      difference.mean = random.normal();
      UnitTable table{a, s, two_tables ? Approach::forward : Approach::unknown, {}, {}};
      UnitTable reverse{a, s, Approach::reverse, {}, {}};
      const double from_mm = cover.places_mm.front();
      const double to_mm = cover.places_mm.back();
      const int count = whole(random, 12, 60);
      for (int k = 0; k <= count; ++k) {
        const double p_mm = from_mm + (to_mm - from_mm) * k / count;
        table.p_mm.push_back(rounded(p_mm + scene.datum_mm[index_of(a)], 1000.0));
        const double half = two_tables ? 0.5 * value_at(difference, p_mm) : 0.0;
        table.value.push_back(value_at(shape, p_mm) + half);
        reverse.value.push_back(value_at(shape, p_mm) - half);
      }
      reverse.p_mm = table.p_mm;
      scene.map.push_back(table);
      if (two_tables) scene.map.push_back(reverse);
    }
  }
  scene.shown.compensated = chance(random, 0.6);
}

/// A component measured separately, along an axis that is moved.
void draw_known(Random& random, Scene& scene, const Ground& ground) {
  std::vector<Axis> moved;
  for (const Sense s : ground.senses)
    for (const Axis a : kAllAxes)
      if (ground.cover(s, a).moved && ground.cover(s, a).places_mm.size() >= 8) moved.push_back(a);
  if (moved.empty()) return;
  const Axis axis = one(random, moved);
  const Component code = curve_of(static_cast<Sense>(3 + whole(random, 0, 2)), axis);
  const auto& travel = scene.machine.axes[index_of(axis)]->travel_mm;
  SmoothCurve curve =
      draw_curve(random, {travel[0], 0.8 * travel[0] + 0.2 * travel[1], 0.5 * (travel[0] + travel[1]),
                          0.3 * travel[0] + 0.7 * travel[1], 0.2 * travel[0] + 0.8 * travel[1],
                          0.1 * travel[0] + 0.9 * travel[1], 0.05 * travel[0] + 0.95 * travel[1],
                          0.15 * travel[0] + 0.85 * travel[1], 0.4 * travel[0] + 0.6 * travel[1], travel[1]});
  curve.slope = random.normal();
  KnownCurve known{code, {}, {}};
  const int count = whole(random, 15, 50);
  for (int k = 0; k <= count; ++k) {
    known.p_mm.push_back(rounded(travel[0] + (travel[1] - travel[0]) * k / count, 100.0));
    known.value.push_back(rounded(15.0 * value_at(curve, known.p_mm.back()), 1000.0));
  }
  scene.known.push_back(known);
}

/// Scene, ground, map and known component.
std::optional<Ground> prepare(Random& random, const Needs& needs, bool known, std::size_t readings, Scene& scene) {
  scene = draw_scene(random, needs, readings);
  if (scene.stops.size() < 100) return std::nullopt;
  Ground ground = ground_of(scene);
  if (needs.map) draw_map(random, scene, ground, needs.one_axis && needs.bidirectional);
  if (known) draw_known(random, scene, ground);
  return ground;
}

std::optional<DrawnEffect> draw_effect(Random& random, const Scene& scene, const Ground& ground,
                                       const EffectDefinition& kind) {
  const auto places = places_of(kind, scene, ground, true);
  if (places.empty()) return std::nullopt;
  return with_shape(random, scene, ground, one(random, places));
}

/// Columns of 1, the position and both with the sign of the approach, for every sense and moving axis: a zero, a slope,
/// lost motion and its slope belong to any model.
Eigen::MatrixXd lines_either_way(const Scene& scene) {
  std::map<std::pair<Sense, Axis>, Eigen::Index> first;
  for (const Stop& stop : scene.stops)
    first.try_emplace({stop.sense, stop.axis}, 4 * static_cast<Eigen::Index>(first.size()));
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(scene.stops.size()), 4 * static_cast<Eigen::Index>(first.size()));
  for (std::size_t k = 0; k < scene.stops.size(); ++k) {
    const Stop& stop = scene.stops[k];
    const double p_m = 1e-3 * scene.p_mm(stop, stop.axis);
    columns.block<1, 4>(static_cast<Eigen::Index>(k), first.at({stop.sense, stop.axis})) << 1.0, p_m, stop.approach,
        stop.approach * p_m;
  }
  return columns;
}

/// The offset of each run (readings × runs).
Eigen::MatrixXd offsets_of_runs(const Scene& scene) {
  std::map<int, Eigen::Index> number;
  for (const Stop& stop : scene.stops) number.try_emplace(stop.run, static_cast<Eigen::Index>(number.size()));
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(scene.stops.size()), static_cast<Eigen::Index>(number.size()));
  for (std::size_t k = 0; k < scene.stops.size(); ++k)
    columns(static_cast<Eigen::Index>(k), number.at(scene.stops[k].run)) = 1.0;
  return columns;
}

/// Whether a condition that nobody sets acts like the offset of one run, or of each of few runs: a bad run, by
/// docs/physics.md, limits of effects.
bool is_offset_of_runs(const Scene& scene, const Absorbed& absorbed, const DrawnEffect& effect) {
  const Needs& needs = hiding_of(effect).needs;
  if (!needs.temperature && !needs.air && !needs.time) return false;
  const Eigen::VectorXd own = vector_of(contribution(scene, effect));
  const double alone = absorbed.left_of(own).squaredNorm();
  const auto explain = [&](const Eigen::MatrixXd& offsets) {
    Absorbed with = absorbed;
    with.add(offsets);
    return with.left_of(own).squaredNorm() < kOfRuns * alone;
  };
  const Eigen::MatrixXd offsets = offsets_of_runs(scene);
  if (offsets.cols() < kFewRuns && explain(offsets)) return true;
  for (Eigen::Index run = 0; run < offsets.cols(); ++run)
    if (explain(offsets.col(run))) return true;
  return false;
}

/// What is left of foreign structure after the library's best: forward selection, curves and periods too.
bool is_foreign(const Scene& scene, const Ground& ground, const Absorbed& absorbed, const std::vector<double>& value) {
  const Eigen::VectorXd structure = vector_of(value);
  Absorbed used = absorbed;
  used.add(lines_either_way(scene));
  const double size = used.left_of(structure).norm();
  if (!(size > std::sqrt(kLeastShare) * structure.norm())) return false;  // nothing at any stop is nothing
  for (int step = 0; step < kLibrarySteps; ++step) {
    const auto explains = [&](const Rival& rival) { return rival.separation < kForeign * size; };
    const auto rivals = rivals_of(scene, ground, used, structure, 1.0, true, explains);
    if (rivals.empty() || explains(rivals.back())) return rivals.empty();
    const auto best = std::min_element(rivals.begin(), rivals.end(),
                                       [](const Rival& a, const Rival& b) { return a.separation < b.separation; });
    used.add(contribution_columns(scene, ground, best->effect));
  }
  return true;
}

Needs needs_of(const Wanted& wanted) {
  if (wanted.kind == CaseKind::out_of_library) return wanted.structure->needs;
  Needs needs;
  for (const EffectDefinition* kind : wanted.effects) needs = needs | hiding_of(*kind).needs;
  return needs;
}

/// What the base model and the noise ask of the design, too.
Needs needs_beside(const Wanted& wanted) {
  Needs needs;
  if (wanted.in_base != nullptr) needs = hiding_of(*wanted.in_base).needs;
  needs.one_run = wanted.law == NoiseLaw::slow;
  if (wanted.law == NoiseLaw::by_run) needs.least_runs = kLeastRuns;
  return needs;
}

/// A thermometer of the hall, which was read once a run: it coincides with the runs and acts on nothing.
void add_hall_sensor(Random& random, Scene& scene) {
  std::map<int, double> degC;
  const std::vector<double> levels{19.5, 21.0, 22.5};
  scene.sensors.emplace_back("t_hall_degC");
  for (Stop& stop : scene.stops)
    stop.weather.degC.push_back(degC.try_emplace(stop.run, one(random, levels)).first->second);
}

}  // namespace

std::optional<HiddenCase> compose(Random& random, const Wanted& wanted) {
  HiddenCase c;
  c.kind = wanted.kind;
  c.free_base = wanted.free_base;
  const Needs asked = needs_of(wanted) | needs_beside(wanted);
  const bool known = asked.known || chance(random, 0.06);
  Needs needs = distractions(random, asked);
  if (!needs.map && wanted.kind != CaseKind::out_of_library) needs.map = chance(random, 0.06);
  const auto ground = prepare(random, needs, known, wanted.readings, c.scene);
  if (!ground) return std::nullopt;

  Reserved reserved;
  reserved.free = wanted.free_base;
  if (wanted.in_base != nullptr) {
    const auto places = places_of(*wanted.in_base, c.scene, *ground, true);
    if (places.empty()) return std::nullopt;
    reserved.needed.push_back(one(random, places));
  }
  if (wanted.kind == CaseKind::single || wanted.kind == CaseKind::pair) {
    for (const EffectDefinition* kind : wanted.effects) {
      const auto effect = draw_effect(random, c.scene, *ground, *kind);
      if (!effect) return std::nullopt;
      c.hidden.push_back({*effect, 0.0, 0.0});
      reserved.hidden.push_back(*effect);
      if (const auto line = line_of(*effect)) reserved.needed.push_back(*line);
    }
  }
  if (wanted.kind == CaseKind::out_of_library) {
    c.structure = draw_structure(random, c.scene, *ground, *wanted.structure);
    if (c.structure.value.empty()) return std::nullopt;
  }
  Absorbed absorbed(c.scene.stops.size());
  c.base = draw_background(random, c.scene, *ground, reserved, absorbed);
  for (const DrawnEffect& hidden : reserved.hidden) {
    const Eigen::VectorXd own = vector_of(contribution(c.scene, hidden));
    if (!(absorbed.left_of(own).squaredNorm() >= kLeastShare * own.squaredNorm()) || own.norm() == 0.0)
      return std::nullopt;
    if (is_offset_of_runs(c.scene, absorbed, hidden)) return std::nullopt;
  }
  if (!c.structure.value.empty() && !is_foreign(c.scene, *ground, absorbed, c.structure.value)) return std::nullopt;
  if (wanted.in_base != nullptr && std::none_of(c.base.begin(), c.base.end(), [&](const DrawnEffect& effect) {
        return effect.kind == wanted.in_base;
      }))
    return std::nullopt;
  if (wanted.free_base && chance(random, kHallSensor)) add_hall_sensor(random, c.scene);
  return finished(random, std::move(c), *ground, absorbed, wanted.snr, wanted.law);
}

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
  for (const EffectDefinition& kind : effects())
    if ((hiding_of(kind).confounded_in & design.id) != 0) members.push_back(&kind);
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
  if (!hiding_of(rival.effect).natural_size) return true;
  const Range& range = hiding_of(rival.effect).range;
  return rival.size > range.above && rival.size < range.below;
}

/// A rotation that acts on its own line through the position of its own axis.
bool has_own_lever(const Scene& scene, const DrawnEffect& effect) {
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
  const bool curves =
      std::all_of(members.begin(), members.end(), [](const auto* kind) { return hiding_of(*kind).is_flexible(); });
  std::vector<std::string> group;
  bool disturbed = false;
  const auto weigh = [&](const Rival& rival) {
    if (rival.separation >= kApart) return false;
    const bool expected = curves ? (hiding_of(rival.effect).confounded_in & design.id) != 0 : !rival.flexible;
    disturbed = rival.separation > kSame || !expected || !is_natural(rival) || has_own_lever(c.scene, rival.effect);
    group.push_back(name_of(rival.effect));
    return disturbed;
  };
  const auto hidden = vector_of(contribution(c.scene, c.hidden.front().effect));
  const auto tried = rivals_of(c.scene, ground, absorbed, hidden, c.noise.sigma_um, true, weigh);
  return disturbed || tried.empty() ? std::vector<std::string>{} : group;
}

std::optional<DrawnEffect> member(Random& random, const Wanted& wanted, const Scene& scene, const Ground& ground) {
  const EffectDefinition& kind =
      wanted.effects.empty() ? *one(random, members_of(*wanted.design)) : *wanted.effects.front();
  const bool rotation = kind.placed_by == PlacedBy::code_of_rotation;
  auto places = places_of(kind, scene, ground, !rotation);
  std::erase_if(places, [&](const DrawnEffect& place) { return rotation && *place.axis != scene.stops.front().axis; });
  if (places.empty()) return std::nullopt;
  return with_shape(random, scene, ground, one(random, places));
}

/// What holds mean and slope of the curves of the group.
std::vector<DrawnEffect> lines_of(const ConfoundedDesign& design, const Stop& first) {
  std::vector<DrawnEffect> lines;
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
  std::erase_if(found,
                [&](const ConfoundedDesign* design) { return (hiding_of(kind).confounded_in & design->id) == 0; });
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
  for (const DrawnEffect& place :
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
