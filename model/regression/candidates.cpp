#include "model/regression/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/data/motions.hpp"
#include "model/effects/quantities.hpp"
#include "model/regression/needs.hpp"
#include "model/regression/regressors.hpp"

namespace ecs::model {
namespace {

/// Fitted values of an effect's columns, in the order of its parameters.
Eigen::VectorXd values_of(const EffectInstance& effect) {
  const auto& parameters = effect.definition().parameters;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string name(parameters[i].name);
    const auto& from = effect.parameters.contains(name) ? effect.parameters : effect.fitted;
    if (const auto found = from.find(name); found != from.end()) values(static_cast<Eigen::Index>(i)) = found->second;
  }
  return values;
}

bool acts_on_ball(const EffectInstance& effect) {
  if (effect.is_user()) return false;
  const Place place = effect.definition().place;
  return place == Place::artefact || place == Place::location;
}

/// An effect of which the columns of others do all but this share is not told from them: what is known of it is fifty
/// times less than on its own.
constexpr double kLeastOwnShare = 0.02;

/// Which part of an effect's column the columns of others do not do, 0 to 1.
double own_share(const Eigen::MatrixXd& others, const Eigen::VectorXd& column) {
  if (others.cols() == 0) return 1.0;
  return (column - others * PivotedQr(others).solve(column)).norm() / column.norm();
}

/// The zero of a rotary axis: COC of C. The workpiece is set up with it.
bool is_zero_of_axis(const EffectInstance& location) { return direction_of(*location.sense) == *location.axis; }

}  // namespace

std::vector<Exchangeable> exchangeable_locations(const Observations& data, const std::vector<EffectInstance>& fitted) {
  std::vector<Exchangeable> list;
  if (data.through_chain.empty()) return list;
  const Regressors regressors(data);
  Eigen::MatrixXd known(static_cast<Eigen::Index>(data.size()), 0);
  Eigen::VectorXd values(0);
  std::vector<const EffectInstance*> owner;  // of each column
  for (const EffectInstance& one : fitted) {
    if (!acts_on_ball(one)) continue;
    const Eigen::MatrixXd columns = regressors.columns(one, 0.0).of;
    const Eigen::VectorXd own = values_of(one);
    if (own.size() != columns.cols()) continue;
    known.conservativeResize(Eigen::NoChange, known.cols() + columns.cols());
    known.rightCols(columns.cols()) = columns;
    values.conservativeResize(values.size() + own.size());
    values.tail(own.size()) = own;
    owner.resize(static_cast<std::size_t>(values.size()), &one);
  }
  if (known.cols() == 0) return list;
  const PivotedQr qr(known);
  for (const EffectInstance& one : candidate_instances(data)) {
    if (one.definition().place != Place::location || is_zero_of_axis(one)) continue;
    if (std::ranges::any_of(fitted, [&](const auto& other) { return same_place(one, other); })) continue;
    const Eigen::VectorXd column = regressors.columns(one, 0.0).of.col(0);
    const Eigen::VectorXd share = qr.solve(column);
    if ((column - known * share).norm() > kLeastOwnShare * column.norm()) continue;
    Exchangeable found{one};
    for (Eigen::Index j = 0; j < share.size(); ++j) {
      if (std::abs(share(j)) * known.col(j).norm() <= kLeastOwnShare * column.norm()) continue;
      found.stands_for = std::max(found.stands_for, std::abs(values(j) / share(j)));
      const EffectInstance& of = *owner[static_cast<std::size_t>(j)];
      if (of.definition().place == Place::location) found.shares.push_back({of, share(j)});
    }
    list.push_back(std::move(found));
  }
  return list;
}

namespace {

constexpr Sense kSenses[] = {Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC};

bool has(const Observations& data, Sense sense) { return std::ranges::find(data.sense, sense) != data.sense.end(); }

std::vector<Axis> moved_axes(const Observations& data, Sense sense) {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.sense[k] == sense && data.axis[k] == a) {
        axes.push_back(a);
        break;
      }
  return axes;
}

bool both_approaches(const Observations& data, Sense sense, Axis axis) {
  bool forward = false, reverse = false;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.share_of(k, axis, sense) == 0.0) continue;
    forward = forward || data.approach_of(k, axis) > 0;
    reverse = reverse || data.approach_of(k, axis) < 0;
  }
  return forward && reverse;
}

/// Its readings were taken on the fly: a delay does there what lost motion does, so neither is taken for granted.
bool is_read_in_motion(const Observations& data, Sense sense, Axis axis) {
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.sense[k] == sense && data.axis[k] == axis && std::abs(speed_per_min(data, k)) > 0.0) return true;
  return false;
}

std::size_t places(const Observations& data, Sense sense, Axis axis) {
  std::vector<double> values;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.share_of(k, axis, sense) != 0.0) values.push_back(data.p_mm(k, axis));
  return distinct(std::move(values), 1e-6).size();
}

/// The library by preference.
const std::vector<EffectId>& by_preference() {
  static const std::vector<EffectId> sorted = [] {
    std::vector<EffectId> all;
    for (const EffectDefinition& definition : effect_library()) all.push_back(&definition);
    std::ranges::stable_sort(all, [](EffectId a, EffectId b) { return a->preference < b->preference; });
    return all;
  }();
  return sorted;
}

Site site_at(const Observations& data, Sense sense, Axis axis, bool any_axis_varies) {
  return {data, sense, axis, places(data, sense, axis), any_axis_varies};
}

/// What the definitions seek at a site of this kind; only those that every line has, if so asked.
void add_at(const Site& site, CandidatesAt EffectDefinition::*kind, bool usual_only, std::vector<EffectInstance>& out) {
  for (const EffectId id : by_preference()) {
    if (id->*kind == nullptr || (site.data.rotary && !id->traits.on_rotary_axes)) continue;
    if ((usual_only && !id->traits.is_usual) || lacks_needs(site.data, *id)) continue;
    for (EffectInstance& one : (id->*kind)(site)) {
      one.id = id;
      if (!is_tied_to_runs(site.data, one)) out.push_back(std::move(one));
    }
  }
}

/// What a circle shows too little of, so that it would stand for other causes: lost motion shows at both ends alone,
/// where the axis turns round, so not how it varies between them; of a bend that counts from a zero far away a piece,
/// which is a bow and a slope. A line measured along the axis sees both, and has the optics of a line.
bool needs_line(const EffectInstance& effect) {
  const EffectTraits& traits = effect.traits();
  return traits.of_optics() || (traits.is_curve && traits.of_approach) ||
         (traits.is_smooth && !traits.is_curve && !traits.of_condition);
}
bool seen_by_line(const Observations& all, const EffectInstance& effect, bool few_lengths) {
  constexpr double kShortestLever_m = 1e-6;
  if (!needs_line(effect) && !(few_lengths && effect.traits().shape_of_position)) return true;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!all.on_path(k) && all.axis[k] == effect.axis && all.approach[k] != 0 &&
        (effect.code ? std::abs(lever_m(all, k, *effect.code)) > kShortestLever_m : all.sense[k] == effect.sense))
      return true;
  return false;
}

/// A few lengths, such as those of gauge blocks: each has a calibration error of its own, so that they show no shape.
bool are_few_lengths(const Observations& all) {
  std::map<Channel, std::set<double>> ends;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (all.on_path(k)) ends[all.channel(k)].insert(all.along_of(k));
  std::size_t lengths = 0;
  for (const auto& each : ends) lengths += std::max<std::size_t>(each.second.size(), 2) - 1;
  return lengths <= kFreeTargets;
}

/// Error motions of the rotary axes that moved, in all six senses: they reach readings of a ball through the chain.
void add_motions(const Observations& data, std::vector<EffectInstance>& out) {
  const auto of_motion = [&](const Site& site, CandidatesAt EffectDefinition::*kind) {
    std::vector<EffectInstance> found;
    add_at(site, kind, false, found);
    for (EffectInstance& one : found)
      if (one.definition().place == Place::axis_and_sense) out.push_back(std::move(one));
  };
  for (const Sense sense : kSenses)
    for (const Axis axis : data.rotary_axes) {
      if (places(data, sense, axis) < 2) continue;
      of_motion(site_at(data, sense, axis, true), &EffectDefinition::along_axis);
      if (both_approaches(data, sense, axis))
        of_motion(site_at(data, sense, axis, true), &EffectDefinition::of_reversal);
    }
}

void add_levered(const Observations& data, std::vector<EffectInstance>& out) {
  std::set<Component> seen;
  for (const Term& term : data.terms) {
    if (!term.has_lever || !term.uses_coordinate) continue;
    if (!has(data, static_cast<Sense>(term.observed)) || !seen.insert(term.component).second) continue;
    EffectInstance effect;
    effect.id = effect_at(is_squareness(term.component) ? Place::squareness : Place::rotation);
    effect.axis = is_squareness(term.component) ? term.lever : moving_axis(term.component);
    effect.code = term.component;
    out.push_back(effect);
  }
}

void add_map_faults(const Observations& data, std::vector<EffectInstance>& out) {
  if (!data.map || std::ranges::find(data.compensated, true) == data.compensated.end()) return;
  std::vector<EffectInstance> places;
  std::set<Component> components;
  std::set<Axis> axes;
  for (const laser::MapTable& table : data.map->tables) {
    components.insert(table.component);
    axes.insert(moving_axis(table.component));
  }
  for (const Component component : components) {
    EffectInstance one;
    one.axis = moving_axis(component);
    one.sense = sense_of(component);
    if (is_angular(component)) {
      one.sense = std::nullopt;
      one.code = component;
    }
    places.push_back(one);
  }
  for (const Axis axis : axes) {
    const auto of_axis = [&](Component c) { return moving_axis(c) == axis; };
    if (std::ranges::count_if(components, of_axis) < 2) continue;  // it is that component
    EffectInstance one;
    one.axis = axis;
    places.push_back(one);
  }
  places.emplace_back();  // the whole map
  for (const EffectId id : by_preference())
    for (EffectInstance place : places) {
      if (id->place != Place::map) continue;
      place.id = id;
      out.push_back(place);
    }
}

/// The place of the ball, location errors as far as the readings tell them from each other, lost motion. An error of an
/// axis line that does the same as one of them, or a zero of the probe, is kept as its alternative.
std::vector<EffectInstance> usual_of_ball(const Observations& data) {
  const auto site = [&](Sense sense, Axis axis) { return site_at(data, sense, axis, true); };
  const Regressors regressors(data);
  const auto column_of = [&](const EffectInstance& effect) { return regressors.columns(effect, 0.0).of; };
  std::vector<EffectInstance> usual, once, zeros;
  add_at(site(data.sense.front(), Axis::X), &EffectDefinition::of_sense, false, once);
  for (const Sense sense : kSenses)
    if (has(data, sense)) add_at(site(sense, natural_axis(data, sense)), &EffectDefinition::of_sense, true, zeros);
  Eigen::MatrixXd known(static_cast<Eigen::Index>(data.size()), 0);
  const auto take = [&](EffectInstance effect) {
    const Eigen::MatrixXd columns = column_of(effect);
    known.conservativeResize(Eigen::NoChange, known.cols() + columns.cols());
    known.rightCols(columns.cols()) = columns;
    usual.push_back(std::move(effect));
  };
  std::vector<EffectInstance> locations;
  for (const EffectInstance& one : once) {
    if (one.definition().place == Place::artefact && one.traits().is_usual) take(one);
    if (one.definition().place == Place::location) locations.push_back(one);
  }
  std::stable_partition(locations.begin(), locations.end(), [](const auto& one) { return !is_zero_of_axis(one); });
  std::vector<EffectInstance> rivals;
  for (const EffectInstance& one : locations)
    own_share(known, column_of(one)) > kLeastOwnShare ? take(one) : rivals.push_back(one);
  for (EffectInstance& one : zeros)
    if (one.definition().place == Place::sense) rivals.push_back(std::move(one));
  for (EffectInstance& one : usual) {
    if (one.definition().place != Place::location) continue;
    const Eigen::MatrixXd alone = column_of(one);
    std::vector<std::string> same;
    for (const EffectInstance& other : rivals)
      if (own_share(alone, column_of(other)) < kLeastOwnShare) same.push_back(place_text(other));
    one.tied_with = fmt::format("{}", fmt::join(same, ", "));
  }
  for (const Axis axis : data.rotary_axes)
    for (const Axis about : kAllAxes) {
      const auto own = static_cast<Sense>(kAxes + index_of(about));
      const auto& geometry = data.machine.rotary[index_of(axis)];
      const double turns = geometry ? std::abs(geometry->direction[index_of(about)]) : about == axis ? 1.0 : 0.0;
      if (turns > kLeastOwnShare && both_approaches(data, own, axis))
        add_at(site(own, axis), &EffectDefinition::of_reversal, true, usual);
    }
  return usual;
}

}  // namespace

std::vector<EffectInstance> Site::once(bool worth_trying) const {
  if (!worth_trying) return {};
  EffectInstance effect;
  effect.axis = axis;
  effect.rotary = data.rotary;
  effect.sense = sense;
  return {effect};
}

std::vector<EffectInstance> Site::on_further_lines() const {
  std::vector<EffectInstance> each;
  if (data.line.empty() || !data.paths.empty()) return each;
  int lines = 0;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.axis[k] == axis && data.sense[k] == sense) lines = std::max(lines, data.line_of(k));
  for (int number = 2; number <= lines; ++number) {
    each.push_back(once().front());
    each.back().line = number;
  }
  return each;
}

Axis natural_axis(const Observations& all, Sense sense) { return all.motions().natural_axis(sense); }

std::vector<Axis> varied_axes(const Observations& all, Sense sense) {
  const Observations& data = all.motions();
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    if (places(data, sense, a) >= 2) axes.push_back(a);
  return axes;
}

std::vector<EffectInstance> candidate_instances(const Observations& all) {
  const Observations& data = all.motions();
  std::vector<EffectInstance> out;
  for (const Sense sense : kSenses) {
    if (!has(data, sense)) continue;
    const std::vector<Axis> varied = varied_axes(data, sense);
    const auto site = [&](Axis axis) { return site_at(data, sense, axis, !varied.empty()); };
    add_at(site(natural_axis(data, sense)), &EffectDefinition::of_sense, false, out);
    if (!data.through_chain.empty()) continue;
    for (const Axis axis : varied) add_at(site(axis), &EffectDefinition::along_axis, false, out);
    for (const Axis axis : moved_axes(data, sense))
      if (both_approaches(data, sense, axis)) add_at(site(axis), &EffectDefinition::of_reversal, false, out);
  }
  add_motions(data, out);
  add_levered(data, out);
  add_map_faults(data, out);
  // a circle and a diagonal show a slope across as squareness, which is the commoner cause (where lines are measured
  // across, their straight edge has a slope of its own), and a jump at an end of the travel as what a reversal does
  if (!all.paths.empty()) {
    const bool few = are_few_lengths(all);
    std::erase_if(out, [&](const EffectInstance& one) { return !seen_by_line(all, one, few); });
    const auto reverses = [](const EffectInstance& one) { return one.traits().of_approach; };
    const auto leans = [](const EffectInstance& one) { return one.definition().place == Place::squareness; };
    std::stable_partition(out.begin(), out.end(), reverses);
    std::stable_partition(out.begin(), out.end(), leans);
  }
  // of effects that do the same the first is named: those of the machine before the set-up
  std::stable_partition(out.begin(), out.end(), [](const EffectInstance& one) {
    const Place place = one.definition().place;
    return place != Place::set_up && (place != Place::artefact || !one.traits().of_measurement);
  });
  return out;
}

namespace {

/// Its line was measured in another set-up than the first of its sense and axis: the readout has a new zero.
bool has_own_set_up(const Observations& data, const EffectInstance& of_line) {
  const auto set_up = data.extras.find("set_up");
  if (set_up == data.extras.end()) return false;
  std::array<double, 2> first{kNotMeasured, kNotMeasured};  // of line 1, and of this one
  for (std::size_t k = data.size(); k-- > 0;)
    if (data.axis[k] == of_line.axis && data.sense[k] == of_line.sense)
      for (const int line : {1, of_line.line})
        if (data.line_of(k) == line) first[line == 1 ? 0 : 1] = set_up->second[k];
  return first[0] != first[1];
}

}  // namespace

std::vector<EffectInstance> usual_effects(const Observations& all) {
  constexpr std::size_t kForSlope = 3;
  const Observations data = without_paths(all);
  std::vector<EffectInstance> usual;
  if (!data.through_chain.empty()) return usual_of_ball(data);
  for (const Sense sense : kSenses) {
    if (!has(data, sense)) continue;
    const auto site = [&](Axis axis) { return site_at(data, sense, axis, true); };
    add_at(site(natural_axis(data, sense)), &EffectDefinition::of_sense, true, usual);
    for (const Axis axis : moved_axes(data, sense)) {
      if (places(data, sense, axis) >= kForSlope) add_at(site(axis), &EffectDefinition::along_axis, true, usual);
      if (both_approaches(data, sense, axis) && !is_read_in_motion(data, sense, axis))
        add_at(site(axis), &EffectDefinition::of_reversal, true, usual);
    }
  }
  std::erase_if(usual, [&](const EffectInstance& one) {
    return one.from_run > 0 || (one.line > 1 && (one.id != effect_named("offset") || !has_own_set_up(data, one)));
  });
  return usual;
}

}  // namespace ecs::model
