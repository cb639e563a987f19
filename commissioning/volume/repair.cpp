// Sums of what the effects contribute: readings by the fit, places of a volume and of a circle by prediction. What the
// unit can compensate is compensated by the fitted values, straight between the points of a map's tables, while the
// machine has the values of a refit (repair_places.hpp).
#include "commissioning/volume/repair.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/maps/machine_map.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/volume/repair_places.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::commissioning {
namespace {

/// Less is no gain: a hundredth of what is left otherwise, or the resolution of a map.
constexpr double kNoGain = 0.01, kResolution_um = 0.1;
constexpr std::uint64_t kRefitSeed = 1;
/// Within this share of the true value, or so much, a prediction is as good as it need be.
constexpr double kNear = 0.1, kNear_um = 1.0;

using Vectors = std::vector<Vector3>;

/// Length of vectors counted from the last two, the reference from both sides.
struct Sizes {
  double largest_um = 0.0, rms_um = 0.0;
};
Sizes sizes_of(const Vectors& vectors, const std::vector<double>& weight) {
  Sizes sizes;
  if (vectors.size() < 3) return sizes;
  const Vector3 &a = vectors[vectors.size() - 1], &b = vectors[vectors.size() - 2];
  double sum = 0.0, whole = 0.0;
  for (std::size_t i = 0; i + 2 < vectors.size(); ++i) {
    double square = 0.0;
    for (std::size_t d = 0; d < kAxes; ++d) square += std::pow(vectors[i][d] - 0.5 * (a[d] + b[d]), 2);
    sizes.largest_um = std::max(sizes.largest_um, std::sqrt(square));
    sum += weight[i] * square;
    whole += weight[i];
  }
  sizes.rms_um = std::sqrt(sum / whole);
  return sizes;
}

/// G of ISO 230-4 about the least-squares centre; the places are even, so that centre and deviation are orthogonal.
double circular_deviation_um(const Circle& circle, const Vectors& vectors) {
  if (vectors.empty()) return 0.0;
  const double n = static_cast<double>(vectors.size());
  std::vector<double> radial;
  double cosine = 0.0, sine = 0.0;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / n;
    radial.push_back(vectors[i][circle.first] * std::cos(angle) + vectors[i][circle.second] * std::sin(angle));
    cosine += 2.0 / n * radial.back() * std::cos(angle);
    sine += 2.0 / n * radial.back() * std::sin(angle);
  }
  for (std::size_t i = 0; i < radial.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / n;
    radial[i] -= cosine * std::cos(angle) + sine * std::sin(angle);
  }
  const auto [least, greatest] = std::minmax_element(radial.begin(), radial.end());
  return *greatest - *least;
}

/// What one effect, or what is left of all, gives everywhere.
struct Contribution {
  std::vector<double> readings;
  Vectors volume, circle;

  void add(const Contribution& other, double times) {
    for (std::size_t k = 0; k < readings.size(); ++k) readings[k] += times * other.readings[k];
    for (std::size_t k = 0; k < volume.size(); ++k)
      for (std::size_t d = 0; d < kAxes; ++d) volume[k][d] += times * other.volume[k][d];
    for (std::size_t k = 0; k < circle.size(); ++k)
      for (std::size_t d = 0; d < kAxes; ++d) circle[k][d] += times * other.circle[k][d];
  }
};

Remaining CauseCost::*const kQuantities[] = {&CauseCost::readings_rms, &CauseCost::volume_largest,
                                             &CauseCost::volume_rms, &CauseCost::circle};
using QuantitySizes = std::array<double, std::size(kQuantities)>;

QuantitySizes sizes_left(const Contribution& rest, const std::vector<double>& weight, const Circle& circle) {
  const Sizes volume = sizes_of(rest.volume, weight);
  return {model::rms_of(rest.readings), volume.largest_um, volume.rms_um, circular_deviation_um(circle, rest.circle)};
}

/// Two sizes are as good as one another within this share of the true one, or so little.
double near_um(double size_um) { return std::max(kNear_um, kNear * size_um); }

/// The size that most of the draws agree with: where they fall into two heaps, such as a step before or behind the
/// place that the map has, their median may lie between the heaps, where none is. Of all such sizes the one nearest to
/// the median of these draws.
/// @param drawn  ascending, not empty
Expected expected_of(const std::vector<double>& drawn) {
  Expected best;
  std::size_t most = 0;
  for (std::size_t first = 0, end = 0; first < drawn.size(); ++first) {
    const double greatest = drawn[first] + near_um(drawn[first]);
    while (end < drawn.size() && drawn[end] - near_um(drawn[end]) <= greatest) ++end;
    if (end - first <= most) continue;
    most = end - first;
    best.um = std::clamp(drawn[first + most / 2], drawn[end - 1] - near_um(drawn[end - 1]), greatest);
  }
  best.least_um = drawn.front();
  best.at_most_um = drawn.back();
  best.share = static_cast<double>(most) / static_cast<double>(drawn.size());
  return best;
}

/// One draw after the other; `expected` when all are in.
class Draws {
 public:
  void take(const QuantitySizes& sizes) {
    for (std::size_t q = 0; q < sizes.size(); ++q) drawn_[q].push_back(sizes[q]);
  }
  [[nodiscard]] Expected expected(std::size_t quantity) const {
    std::vector<double> values = drawn_[quantity];
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    return expected_of(values);
  }

  /// In some quantity, in all draws but the share that a bound leaves: what uncertain values gain by chance is none.
  [[nodiscard]] bool is_gain(const Draws& after) const {
    for (std::size_t q = 0; q < drawn_.size(); ++q) {
      std::size_t gains = 0;
      for (std::size_t k = 0; k < drawn_[q].size(); ++k)
        if (drawn_[q][k] - after.drawn_[q][k] > std::max(kNoGain * drawn_[q][k], kResolution_um)) ++gains;
      if (gains > 0 && gains + drawn_[q].size() / kRefits >= drawn_[q].size()) return true;
    }
    return false;
  }

 private:
  std::array<std::vector<double>, std::size(kQuantities)> drawn_;
};

/// A prediction that may as well come out otherwise.
std::string doubt(const CauseCost& cost, std::string_view quantity, std::string_view remedy, const Expected& size) {
  return fmt::format("{0}: {3:.1f} um if {1} is {2} ({4:.0f} %, possible range {5:.1f} to {6:.1f} um)", quantity,
                     name_with_alternatives(cost.effect), remedy, size.um, 100.0 * size.share, size.least_um,
                     size.at_most_um);
}

/// Predictions that are not likely enough, and why. @param steps  that fall anywhere between two targets, in words
void note_doubts(RepairAnswer& answer, const std::vector<std::string>& steps) {
  constexpr double kLikely = 0.8;
  constexpr std::size_t kMost = 3;
  std::vector<std::string> doubts;
  for (const CauseCost& cost : answer.causes) {
    const auto look = [&](std::string_view quantity, const Remaining& one) {
      if (one.left.share < kLikely) doubts.push_back(doubt(cost, quantity, "left as it is", one.left));
      if (one.compensated.share < kLikely) doubts.push_back(doubt(cost, quantity, "compensated", one.compensated));
      if (one.repaired.share < kLikely) doubts.push_back(doubt(cost, quantity, "repaired", one.repaired));
    };
    look("Volume, largest", cost.volume_largest);
    look("Volume, rms", cost.volume_rms);
    if (answer.diameter_mm > 0.0) look("Circle G", cost.circle);
  }
  if (doubts.empty()) return;
  std::string note;
  if (!steps.empty())
    note = fmt::format(
        "{}. Between these targets, an error as large as the step may remain after compensation, and the readings do "
        "not show it. Measure there in fine steps. ",
        fmt::join(steps, ", "));
  note += "Some predictions are uncertain. In brackets: probability of being right within 10 % or 1 um. ";
  const std::size_t more = doubts.size() > kMost ? doubts.size() - kMost : 0;
  doubts.resize(doubts.size() - more);
  note += fmt::format("{}", fmt::join(doubts, ". "));
  if (more > 0) note += fmt::format(". {} more: see the fields of --json that end in _share", more);
  answer.notes.push_back(std::move(note));
}

struct CauseDraws {
  Draws left, compensated, repaired;
};

/// Zero and slope of a straightness readout that no axis of the machine could correct: they come with the alignment of
/// the optics, not with the machine.
bool is_alignment(const model::EffectInstance& effect, const params::Machine& machine) {
  const bool across =
      effect.axis && effect.sense && !is_rotation(*effect.sense) && direction_of(*effect.sense) != *effect.axis;
  return across && effect.traits().is_usual && !effect.traits().of_approach && !is_carried(effect, machine);
}

Remedy remedy_for(const model::EffectInstance& effect, const params::Machine& machine, const CauseDraws& draws) {
  if (is_of_measurement(effect) || is_alignment(effect, machine))
    return draws.left.is_gain(draws.repaired) ? Remedy::set_up : Remedy::nothing;
  if (draws.compensated.is_gain(draws.repaired)) return Remedy::repair;
  return draws.left.is_gain(draws.compensated) ? Remedy::compensate : Remedy::nothing;
}

double largest_cost_um(const CauseCost& cost) {
  double most = 0.0;
  for (const auto quantity : kQuantities)
    most = std::max(most,
                    (cost.*quantity).left.um - std::min((cost.*quantity).compensated.um, (cost.*quantity).repaired.um));
  return most;
}

/// The chosen remedy alone increases a figure by more than its own uncertainty would be worth a word.
bool makes_worse(const CauseCost& cost) {
  constexpr double kWorse = 1.05;  // as of a line that compensation makes worse (what_if.cpp)
  return std::ranges::any_of(kQuantities, [&](const auto quantity) {
    const Remaining& one = cost.*quantity;
    return (cost.remedy == Remedy::repair ? one.repaired : one.compensated).um > kWorse * one.left.um;
  });
}

std::string_view remedy_text(Remedy remedy) {
  switch (remedy) {
    case Remedy::compensate:
      return "compensate";
    case Remedy::repair:
      return "repair";
    case Remedy::set_up:
      return "put the measurement right";
    case Remedy::nothing:
      break;
  }
  return "leave";
}

Cell remaining_cell(std::string_view name, const Remaining& one) {
  const auto shown = [](const Expected& size) {
    return shown_cell(fmt::format("{:.2f} ({:.2f})", size.um, size.at_most_um));
  };
  return record_cell(fmt::format("  {:<16} {{left:>17}} {{compensated:>17}} {{repaired:>17}}\n", name),
                     "left"_is(shown(one.left)), "compensated"_is(shown(one.compensated)),
                     "repaired"_is(shown(one.repaired)), "left_um"_is(one.left.um),
                     "compensated_um"_is(one.compensated.um), "repaired_um"_is(one.repaired.um),
                     "left_at_most_um"_is(one.left.at_most_um), "compensated_at_most_um"_is(one.compensated.at_most_um),
                     "repaired_at_most_um"_is(one.repaired.at_most_um), "left_share"_is(one.left.share),
                     "compensated_share"_is(one.compensated.share), "repaired_share"_is(one.repaired.share));
}

Cell cause_cell(const CauseCost& cost, bool has_circle) {
  const std::string head =
      paragraph(fmt::format("{}: {} ({}{})", name_with_alternatives(cost.effect), remedy_text(cost.remedy),
                            cost.remedy == Remedy::repair ? "first confirm it: " : "", cost.how),
                0, 2);
  Cell circle = remaining_cell("circle G", cost.circle);
  if (!has_circle) circle = null_cell();
  Cell largest = remaining_cell("volume, largest", cost.volume_largest);
  Cell rms = remaining_cell("volume, rms", cost.volume_rms);
  if (cost.remedy == Remedy::set_up) largest.text = rms.text = circle.text = "";  // it is no error of the volume
  return record_cell("{head}{readings_rms}{volume_largest}{volume_rms}{circle}\n", "head"_shown(head),
                     inlined({effect_json(cost.effect), ""}), "remedy"_is(remedy_text(cost.remedy)),
                     "readings_rms"_is(remaining_cell("readings, rms", cost.readings_rms)),
                     "volume_largest"_is(std::move(largest)), "volume_rms"_is(std::move(rms)),
                     "circle"_is(std::move(circle)));
}

/// Of an error that is a value times coordinates.
Result<Vectors> linear_errors(const ErrorsAt& errors, const Places& places) {
  constexpr double kFar_mm = 1000.0;
  Places few(kAxes + 1);
  for (std::size_t a = 0; a < kAxes; ++a) few[a + 1].position_mm[a] = kFar_mm;
  ECS_TRY(at, errors(few));
  Vectors all(places.size(), at.front());
  for (std::size_t k = 0; k < places.size(); ++k)
    for (std::size_t a = 0; a < kAxes; ++a)
      for (std::size_t d = 0; d < kAxes; ++d)
        all[k][d] += ((at)[a + 1][d] - at.front()[d]) * places[k].position_mm[a] / kFar_mm;
  return all;
}

/// An effect of one sense by the coordinate of one axis, or by none, is asked at each coordinate once.
Result<Vectors> errors_of_effect(const model::EffectInstance& effect, const ModelWork& work, const Places& places,
                                 const std::string& model_file) {
  model::Model alone = work.model;
  alone.effects = {effect};
  const auto errors = errors_of_model(alone, *work.machine, model_file);
  const model::Place acts_by = effect.definition().place;
  if (acts_by == model::Place::squareness) return linear_errors(errors, places);
  if (acts_by != model::Place::axis_and_sense && acts_by != model::Place::sense) return errors(places);
  std::map<std::pair<double, PerAxis<Approach>>, std::size_t> number;
  std::vector<std::size_t> which;
  Places different;
  for (const MachinePlace& place : places) {
    const auto [at, is_new] = number.try_emplace(
        {effect.axis ? place.position_mm[index_of(*effect.axis)] : 0.0, place.approach}, different.size());
    if (is_new) different.push_back(place);
    which.push_back(at->second);
  }
  ECS_TRY(few, errors(different));
  Vectors all;
  all.reserve(places.size());
  for (const std::size_t k : which) all.push_back((few)[k]);
  return all;
}

Result<Contribution> contribution_of(const model::EffectFit& effect, const ModelWork& work, const Places& volume,
                                     const Circle& circle, const std::string& model_file) {
  ECS_TRY(in_volume, errors_of_effect(effect.effect, work, volume, model_file));
  ECS_TRY(on_circle, errors_of_effect(effect.effect, work, circle.places, model_file));
  return Contribution{effect.contribution, std::move(in_volume), std::move(on_circle)};
}

/// What the unit takes an effect for at the places: straight between the points of its axis's table, squareness
/// exactly.
Result<Vectors> errors_in_map(const model::EffectInstance& effect, const ModelWork& work, const TablePoints& tables_mm,
                              const Places& places, const std::string& model_file) {
  if (!effect.axis || tables_mm[index_of(*effect.axis)].empty() ||
      effect.definition().place == model::Place::squareness)
    return errors_of_effect(effect, work, places, model_file);
  const std::size_t axis = index_of(*effect.axis);
  std::array<Places, 2> at{places, places};
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto points_mm = points_about(tables_mm[axis], places[k].position_mm[axis]);
    for (std::size_t end = 0; end < 2; ++end) at[end][k].position_mm[axis] = points_mm[end];
  }
  auto below = errors_of_effect(effect, work, at[0], model_file);
  if (!below) return below;
  ECS_TRY(above, errors_of_effect(effect, work, at[1], model_file));
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double from_mm = at[0][k].position_mm[axis], to_mm = at[1][k].position_mm[axis];
    const double share = (places[k].position_mm[axis] - from_mm) / (to_mm - from_mm);
    for (std::size_t d = 0; d < kAxes; ++d) (*below)[k][d] = std::lerp((*below)[k][d], above[k][d], share);
  }
  return below;
}

Result<Contribution> contribution_in_map(const model::EffectFit& effect, const ModelWork& work,
                                         const TablePoints& tables_mm, const Places& volume, const Circle& circle,
                                         const std::string& model_file) {
  ECS_TRY(in_volume, errors_in_map(effect.effect, work, tables_mm, volume, model_file));
  ECS_TRY(on_circle, errors_in_map(effect.effect, work, tables_mm, circle.places, model_file));
  return Contribution{effect.contribution, std::move(in_volume), std::move(on_circle)};
}

}  // namespace

Result<RepairAnswer> repair_answer(const ModelWork& work, const std::string& model_file, std::size_t places) {
  if (!work.machine)
    return problem(ProblemKind::usage, "expected --machine: the machine file gives the travels of the axes");
  if (work.data.rotary)
    return problem(ProblemKind::refused, "the volume covers linear axes: use `ecs model what-if` for rotary ones");
  ECS_TRY(fit, in_file(model::fit(work.model, work.data), model_file));
  model::Model in_map = work.model;
  in_map.effects.clear();
  for (const model::EffectFit& effect : fit.effects) in_map.effects.push_back(effect.effect);
  const auto tables_mm = tables_of(*work.machine, in_map);
  std::vector<std::string> steps;
  for (const model::EffectInstance& effect : in_map.effects)
    if (const auto targets = targets_about(effect, work.data))
      steps.push_back(fmt::format("{} may be anywhere from {:.4g} to {:.4g} mm from the datum", to_text(effect),
                                  (*targets)[0], (*targets)[1]));
  const Circle circle = circle_of(*work.machine);
  RepairAnswer answer;
  answer.readings = work.data.size();
  answer.diameter_mm = circle.diameter_mm;
  answer.plane =
      fmt::format("{}{}", letter_of(static_cast<Axis>(circle.first)), letter_of(static_cast<Axis>(circle.second)));
  answer.noise_um = fit.noise.noise_um;

  const auto contributions = [&](const model::Fit& of, const auto& contribution) -> Result<std::vector<Contribution>> {
    std::vector<Contribution> each;
    for (const model::EffectFit& effect : of.effects) {
      ECS_TRY(one, contribution(effect));
      each.push_back(std::move(one));
    }
    return each;
  };
  std::vector<CauseDraws> draws(fit.effects.size());
  VolumePlaces volume;
  Result<std::vector<Contribution>> fitted;
  const auto draw = [&](const model::Fit& possible) -> Result<void> {
    if (volume.places.empty() || !steps.empty()) {
      volume = volume_places(*work.machine, places, possible, fit, work.data, tables_mm);
      fitted = contributions(fit, [&](const model::EffectFit& effect) {
        return contribution_in_map(effect, work, tables_mm, volume.places, circle, model_file);
      });
      if (!fitted) return tl::unexpected(fitted.error());
    }
    ECS_TRY(machine, contributions(possible, [&](const model::EffectFit& effect) {
              return contribution_of(effect, work, volume.places, circle, model_file);
            }));
    Contribution rest{fit.residual, Vectors(volume.places.size()), Vectors(circle.places.size())};
    for (std::size_t i = 0; i < machine.size(); ++i) {
      rest.add(machine[i], 1.0);
      if (is_carried(fit.effects[i].effect, *work.machine)) rest.add((*fitted)[i], -1.0);
    }
    for (std::size_t i = 0; i < machine.size(); ++i) {
      const bool carried = is_carried(fit.effects[i].effect, *work.machine);
      Contribution other = rest;
      draws[i].compensated.take(sizes_left(other, volume.weight, circle));
      if (carried) other.add((*fitted)[i], 1.0);
      draws[i].left.take(sizes_left(other, volume.weight, circle));
      other.add(machine[i], -1.0);
      draws[i].repaired.take(sizes_left(other, volume.weight, circle));
    }
    return {};
  };
  for (const model::Fit& possible : refits(work.model, work.data, fit, kRefits, kRefitSeed)) ECS_DO(draw(possible));
  answer.places = volume.places.empty() ? 0 : volume.places.size() / 2 - 1;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    CauseCost cost;
    cost.effect = fit.effects[i].effect;
    for (std::size_t q = 0; q < std::size(kQuantities); ++q)
      cost.*
          kQuantities[q] = {draws[i].left.expected(q), draws[i].compensated.expected(q), draws[i].repaired.expected(q)};
    cost.remedy = remedy_for(cost.effect, *work.machine, draws[i]);
    cost.how = cost.remedy == Remedy::repair ? std::string(cost.effect.definition().check)
               : !is_of_measurement(cost.effect) && is_alignment(cost.effect, *work.machine)
                   ? "zero and slope of this readout come from the alignment of the optics"
               : cost.remedy == Remedy::nothing && is_carried(cost.effect, *work.machine)
                   ? "could be compensated by " + how_compensated(cost.effect, *work.machine)
                   : how_compensated(cost.effect, *work.machine);
    answer.causes.push_back(std::move(cost));
  }
  std::stable_sort(answer.causes.begin(), answer.causes.end(),
                   [](const CauseCost& a, const CauseCost& b) { return largest_cost_um(a) > largest_cost_um(b); });
  if (!fit.undetermined.empty())
    answer.notes.push_back(
        fmt::format("{}. Predictions for these causes may therefore be far off. First make the measurement that `ecs "
                    "model next` proposes",
                    fmt::join(fit.undetermined, "; ")));
  for (const CauseCost& cost : answer.causes) {
    if (cost.remedy == Remedy::compensate && !measurement_alternatives(cost.effect).empty())
      answer.notes.push_back(
          cost_if_of_measurement(cost.effect, fmt::format("{:.3g} um rms", cost.readings_rms.left.um)));
    if ((cost.remedy == Remedy::compensate || cost.remedy == Remedy::repair) && makes_worse(cost))
      answer.notes.push_back(fmt::format(
          "{}: {} makes one of the figures worse, because this cause and another one partly cancel each other there. "
          "Apply the remedies of all causes together",
          name_with_alternatives(cost.effect), cost.remedy == Remedy::repair ? "repair" : "compensation"));
  }
  note_doubts(answer, steps);
  return answer;
}

Cell repair_cell(const RepairAnswer& answer) {
  const bool has_circle = answer.diameter_mm > 0.0;
  std::string head = fmt::format(
      "The table lists the remaining error [um]. Each block is for one cause: left as it is, compensated, or repaired. "
      "All other causes are compensated as far as the unit can. If left and compensated are equal in every row, the "
      "unit does not compensate the cause, or these readings do not contain it. In brackets: upper 95 % bound (equal "
      "to the value if every parameter is fixed). The rows \"readings\" ({}) also contain the residual of the model, "
      "with the noise; volume and circle contain only the causes of the model. Volume: {} "
      "positions, each in both approaches, with errors relative to the reference position: a constant offset shows "
      "only in the readings.",
      answer.readings, answer.places);
  if (std::ranges::any_of(answer.causes, [](const CauseCost& cost) { return cost.remedy == Remedy::set_up; }))
    head +=
        " \"Put the measurement right\" is for an error of the measurement, not of the machine. It has no rows for the "
        "volume, and \"repaired\" means without this error.";
  if (std::ranges::any_of(answer.causes, [](const CauseCost& cost) { return !cost.effect.definition().needs.empty(); }))
    head +=
        " Volume and circle are computed without load, at a slow feed and constant temperature: effects of feed, load, "
        "time or temperature appear only in the readings.";
  if (has_circle)
    head += fmt::format(" Circle: in {} around the middle of the travels, diameter {:.0f} mm.", answer.plane,
                        answer.diameter_mm);
  return record_cell(
      "{head}\n                                left       compensated          repaired\n{causes}{notes}",
      "head"_shown(paragraph(head)), "readings"_is(answer.readings), "points"_is(answer.places),
      "noise_um"_is(answer.noise_um),
      "circle_diameter_mm"_is(has_circle ? number_or_null(answer.diameter_mm) : Json(nullptr)),
      "circle_plane"_is(has_circle ? Json(answer.plane) : Json(nullptr)),
      "causes"_is(list_cell(answer.causes, [&](const auto& cost) { return cause_cell(cost, has_circle); })),
      "notes"_is(answer.notes, notes_text(answer.notes)));
}

}  // namespace ecs::commissioning
