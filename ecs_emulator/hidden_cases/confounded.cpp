// Designs on which different effects do exactly the same; and the XYTZ machine of the thesis.
#include <algorithm>
#include <cmath>

#include "ecs_emulator/hidden_cases/background.hpp"
#include "ecs_emulator/hidden_cases/compose.hpp"
#include "ecs_emulator/hidden_cases/scene.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

/// The confounded designs, in the numbers of Wanted::confusion.
enum Confusion : int { warm, air, warm_air, one_feed, zero, square, one_lever, cold };

using Kinds = std::vector<EffectKind>;

/// Effects that such a design can hide.
Kinds members_of(int confusion) {
  switch (confusion) {
    case warm:
      return {EffectKind::scale, EffectKind::thermal_scale, EffectKind::cosine};
    case air:
      return {EffectKind::scale, EffectKind::air_refraction, EffectKind::cosine};
    case warm_air:
      return {EffectKind::scale, EffectKind::thermal_scale, EffectKind::air_refraction, EffectKind::cosine};
    case one_feed:
      return {EffectKind::backlash, EffectKind::servo_lag};
    case zero:
      return {EffectKind::offset, EffectKind::dead_path};
    case square:
      return {EffectKind::scale, EffectKind::squareness};
    case one_lever:
      return {EffectKind::progressive, EffectKind::angular};
    default:
      return {EffectKind::scale, EffectKind::cosine};
  }
}

Needs needs_of(int confusion) {
  Needs n;
  n.constant = n.translations = n.one_axis = n.irregular = true;
  n.least_runs = 2;
  n.temperature = confusion == warm || confusion == warm_air;
  n.air = confusion == air || confusion == warm_air || confusion == zero;
  n.bidirectional = confusion == one_feed || confusion == zero;
  n.along = confusion != square && confusion != one_lever;
  n.whole_runs = confusion != square;
  n.squares = confusion == square;
  n.levers = confusion == one_lever;
  n.least_axes = confusion == square || confusion == one_lever ? 2 : 1;
  return n;
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
  const int lines = wanted.confusion == one_lever ? 3 : 1;
  Scene scene = draw_scene(random, needs_of(wanted.confusion), wanted.readings * static_cast<std::size_t>(lines));
  if (scene.stops.empty()) return scene;
  keep_first_line(scene);
  scene.shown = Shown{};
  scene.shown.time = false;
  scene.shown.feed = wanted.confusion == one_feed;
  scene.shown.air = wanted.confusion == air || wanted.confusion == warm_air || wanted.confusion == zero;
  return scene;
}

/// Effects that the base model of such a design must not hold: they would take the group's place.
Kinds left_out_of(int confusion) {
  Kinds no{EffectKind::thermal_scale, EffectKind::servo_lag,        EffectKind::load,
           EffectKind::angular,       EffectKind::thermal_drift,    EffectKind::warm_up,
           EffectKind::time_drift,    EffectKind::measurement_line, EffectKind::squareness};
  if (confusion == one_feed)
    no.insert(no.end(), {EffectKind::backlash, EffectKind::reversal_curve});
  else if (confusion == one_lever)
    no.insert(no.end(), {EffectKind::progressive, EffectKind::sag, EffectKind::step});
  else if (confusion != zero)
    no.push_back(EffectKind::scale);
  return no;
}

/// A size that nature allows, with some room.
bool is_natural(const Rival& rival) {
  if (rival.effect.kind == EffectKind::air_refraction) return rival.size > 0.05 && rival.size < 1.9;
  if (rival.effect.kind == EffectKind::dead_path) return rival.size > 0.02 && rival.size < 9.5;
  return true;
}

/// A rotation that acts on its own line through the position of its own axis.
bool has_own_lever(const Scene& scene, const PlacedEffect& effect) {
  if (effect.kind != EffectKind::angular) return false;
  return std::any_of(scene.terms.begin(), scene.terms.end(), [&](const Term& term) {
    return term.component == *effect.code && term.observed == direction_of(scene.stops.front().sense) &&
           term.uses_coordinate && term.lever == moving_axis(*effect.code);
  });
}

/// All that do the same as the hidden effect; empty where somebody comes too near without being the same.
std::vector<std::string> group_of(const HiddenCase& c, const Ground& ground, const Absorbed& absorbed, bool curves) {
  std::vector<std::string> group;
  bool disturbed = false;
  const auto weigh = [&](const Rival& rival) {
    if (rival.separation >= kApart) return false;
    const EffectKind kind = rival.effect.kind;
    const bool is_curve = kind == EffectKind::progressive || kind == EffectKind::angular;
    const bool expected = curves ? is_curve : !rival.flexible;
    disturbed = rival.separation > kSame || !expected || !is_natural(rival) || has_own_lever(c.scene, rival.effect);
    group.push_back(place_of(rival.effect));
    return disturbed;
  };
  const auto hidden = vector_of(contribution(c.scene, c.hidden.front().effect));
  const auto tried = rivals_of(c.scene, ground, absorbed, hidden, c.noise.sigma_um, true, weigh);
  return disturbed || tried.empty() ? std::vector<std::string>{} : group;
}

std::optional<PlacedEffect> member(Random& random, const Wanted& wanted, const Scene& scene, const Ground& ground) {
  const EffectKind kind = wanted.effects.empty() ? one(random, members_of(wanted.confusion)) : wanted.effects.front();
  std::vector<PlacedEffect> places =
      kind == EffectKind::angular ? possible_places(scene, ground, kind) : good_places(scene, ground, kind);
  std::erase_if(places, [&](const PlacedEffect& place) {
    return place.kind == EffectKind::angular && *place.axis != scene.stops.front().axis;
  });
  if (places.empty()) return std::nullopt;
  return with_shape(random, scene, ground, one(random, places));
}

}  // namespace

std::vector<int> confusions_of(EffectKind kind) {
  std::vector<int> found;
  for (int confusion = 0; confusion < kConfusions; ++confusion) {
    const Kinds members = members_of(confusion);
    if (std::find(members.begin(), members.end(), kind) != members.end()) found.push_back(confusion);
  }
  return found;
}

std::optional<HiddenCase> compose_confounded(Random& random, const Wanted& wanted) {
  HiddenCase c;
  c.kind = CaseKind::confounded;
  c.scene = confounded_scene(random, wanted);
  if (c.scene.stops.size() < 100) return std::nullopt;
  if (wanted.confusion == zero && c.scene.chain.axis_count() > 1) return std::nullopt;  // squareness is one more zero
  const Ground ground = ground_of(c.scene);
  const auto hidden = member(random, wanted, c.scene, ground);
  if (!hidden) return std::nullopt;
  c.hidden.push_back({*hidden, 0.0, 0.0});
  Reserved reserved;
  reserved.hidden = {*hidden};
  reserved.without = left_out_of(wanted.confusion);
  reserved.without_offset = wanted.confusion == zero;
  if (wanted.confusion == one_lever) {
    PlacedEffect scale;
    scale.kind = EffectKind::scale;
    scale.axis = c.scene.stops.front().axis;
    scale.sense = c.scene.stops.front().sense;
    reserved.needed = {scale};
  }
  Absorbed absorbed(c.scene.stops.size());
  c.base = draw_background(random, c.scene, ground, reserved, absorbed);
  const Eigen::VectorXd own = vector_of(contribution(c.scene, *hidden));
  if (!(absorbed.left_of(own).squaredNorm() > kLeastShare * own.squaredNorm())) return std::nullopt;
  auto done = finished(random, std::move(c), ground, absorbed, wanted.snr);
  if (!done) return std::nullopt;
  done->group = group_of(*done, ground, absorbed, wanted.confusion == one_lever);
  if (done->group.size() < 2) return std::nullopt;
  return done;
}

}  // namespace ecs::emulator
