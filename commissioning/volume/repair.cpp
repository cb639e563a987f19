// Sums of what the effects contribute: readings by the fit, places of a volume and of a circle by prediction. What the
// unit can compensate is compensated by the fitted values while the machine has those of a refit (refits.hpp); between
// its points a map leaves less than its resolution.
#include "commissioning/volume/repair.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/paragraph.hpp"
#include "commissioning/maps/export_source.hpp"
#include "commissioning/models/effect_words.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/volume/refits.hpp"
#include "model/effects/definition.hpp"
#include "volume/grid.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kCirclePlaces = 180;
/// The circle: at most this share of the shorter travel and no larger; a choice, ISO 230-4 leaves it to the user.
constexpr double kShareOfTravel = 0.8, kLargestDiameter_mm = 300.0;
/// Less is no gain: a hundredth of what is left otherwise, or the resolution of a map.
constexpr double kNoGain = 0.01, kResolution_um = 0.1;
constexpr std::uint64_t kRefitSeed = 1;

using Vectors = std::vector<Vector3>;
using Places = std::vector<controllers::MachinePlace>;

struct Circle {
  std::size_t first = 0, second = 1;  ///< axes of the plane
  double diameter_mm = 0.0;
  Places places;
};

volume::Travels travels_of_axes(const params::Machine& machine) {
  volume::Travels travels;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (machine.axes[a]) travels[a] = machine.axes[a]->travel_mm;
  return travels;
}

/// Places of the volume, each from both sides; the reference comes last.
struct VolumePlaces {
  Places places;
  std::vector<double> weight;  ///< share of the volume that a place stands for; of the reference 0
};

/// More places on the axis of an effect of which nobody knows where it falls between two targets: between them, and
/// just beside the place where the map has it, so that none falls between two places unseen.
void add_places_about(const model::EffectInstance& effect, const params::Machine& machine,
                      const model::Observations& data, volume::Grid& grid) {
  constexpr int kPlacesBetween = 8;
  constexpr double kBeside_mm = 0.01;
  const auto targets = targets_about(effect, data);
  if (!targets || !machine.axes[index_of(*effect.axis)]) return;
  std::vector<double>& mm = grid.mm[index_of(*effect.axis)];
  const double datum_mm = machine.axes[index_of(*effect.axis)]->datum_mm, least = mm.front(), greatest = mm.back();
  const double place_mm = effect.fitted.at(std::string(effect.definition().searched_parameter()));
  std::vector<double> more{place_mm - kBeside_mm, place_mm + kBeside_mm};
  for (int i = 0; i < kPlacesBetween; ++i)
    more.push_back(std::lerp((*targets)[0], (*targets)[1], (i + 0.5) / kPlacesBetween));
  for (const double p_mm : more)
    if (p_mm + datum_mm > least && p_mm + datum_mm < greatest) mm.push_back(p_mm + datum_mm);
  std::sort(mm.begin(), mm.end());
  mm.erase(std::unique(mm.begin(), mm.end()), mm.end());
}

/// Half the way to the neighbours on either side.
std::vector<double> shares_of(const std::vector<double>& mm) {
  std::vector<double> shares(mm.size(), 1.0);
  for (std::size_t i = 0; i < mm.size() && mm.size() > 1; ++i)
    shares[i] = 0.5 * (mm[std::min(i + 1, mm.size() - 1)] - mm[i == 0 ? 0 : i - 1]);
  return shares;
}

VolumePlaces volume_places(const params::Machine& machine, std::size_t most, const model::Fit& fit,
                           const model::Observations& data) {
  Vector3 datum_mm{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (machine.axes[a]) datum_mm[a] = machine.axes[a]->datum_mm;
  volume::Grid grid = volume::grid_over(travels_of_axes(machine), most, datum_mm);
  for (const model::EffectFit& effect : fit.effects) add_places_about(effect.effect, machine, data, grid);
  VolumePlaces out;
  const auto add = [&](const Vector3& at, double weight) {
    for (const Approach side : {Approach::forward, Approach::reverse}) {
      out.places.push_back({at, {side, side, side}});
      out.weight.push_back(weight);
    }
  };
  PerAxis<std::vector<double>> share;
  for (std::size_t a = 0; a < kAxes; ++a) share[a] = shares_of(grid.mm[a]);
  for (std::size_t x = 0; x < grid.mm[0].size(); ++x)
    for (std::size_t y = 0; y < grid.mm[1].size(); ++y)
      for (std::size_t z = 0; z < grid.mm[2].size(); ++z)
        add(grid.at({x, y, z}), share[0][x] * share[1][y] * share[2][z]);
  add(datum_mm, 0.0);
  return out;
}

/// In the plane of the two longest travels through the middle, run counter-clockwise: each axis arrives as it moves.
Circle circle_of(const params::Machine& machine) {
  const volume::Travels travels = travels_of_axes(machine);
  const auto length = [&](std::size_t a) { return travels[a] ? (*travels[a])[1] - (*travels[a])[0] : 0.0; };
  std::array<std::size_t, kAxes> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  Circle circle;
  circle.first = std::min(order[0], order[1]);
  circle.second = std::max(order[0], order[1]);
  circle.diameter_mm = std::min(kShareOfTravel * length(order[1]), kLargestDiameter_mm);
  if (circle.diameter_mm <= 0.0) return circle;
  Vector3 middle{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (travels[a]) middle[a] = 0.5 * ((*travels[a])[0] + (*travels[a])[1]);
  for (std::size_t i = 0; i < kCirclePlaces; ++i) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / kCirclePlaces;
    controllers::MachinePlace place{middle, {Approach::forward, Approach::forward, Approach::forward}};
    place.position_mm[circle.first] += 0.5 * circle.diameter_mm * std::cos(angle);
    place.position_mm[circle.second] += 0.5 * circle.diameter_mm * std::sin(angle);
    if (std::sin(angle) > 0.0) place.approach[circle.first] = Approach::reverse;
    if (std::cos(angle) < 0.0) place.approach[circle.second] = Approach::reverse;
    circle.places.push_back(place);
  }
  return circle;
}

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

double rms_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
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
  return {rms_of(rest.readings), volume.largest_um, volume.rms_um, circular_deviation_um(circle, rest.circle)};
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
    return {values[values.size() / 2], values.back()};
  }

 private:
  std::array<std::vector<double>, std::size(kQuantities)> drawn_;
};

bool is_gain(const Expected& before, const Expected& after) {
  return before.um - after.um > std::max(kNoGain * before.um, kResolution_um);
}

Remedy remedy_for(const CauseCost& cost) {
  const auto gains = [&](Expected Remaining::*from, Expected Remaining::*to) {
    return std::any_of(std::begin(kQuantities), std::end(kQuantities),
                       [&](auto quantity) { return is_gain(cost.*quantity.*from, cost.*quantity.*to); });
  };
  if (cost.effect.traits().of_measurement)
    return gains(&Remaining::left, &Remaining::repaired) ? Remedy::set_up : Remedy::nothing;
  if (gains(&Remaining::compensated, &Remaining::repaired)) return Remedy::repair;
  return gains(&Remaining::left, &Remaining::compensated) ? Remedy::compensate : Remedy::nothing;
}

double largest_cost_um(const CauseCost& cost) {
  double most = 0.0;
  for (const auto quantity : kQuantities)
    most = std::max(most,
                    (cost.*quantity).left.um - std::min((cost.*quantity).compensated.um, (cost.*quantity).repaired.um));
  return most;
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
                     {{"left", shown(one.left)},
                      {"compensated", shown(one.compensated)},
                      {"repaired", shown(one.repaired)},
                      {"left_um", {number_or_null(one.left.um), {}}},
                      {"compensated_um", {number_or_null(one.compensated.um), {}}},
                      {"repaired_um", {number_or_null(one.repaired.um), {}}},
                      {"left_at_most_um", {number_or_null(one.left.at_most_um), {}}},
                      {"compensated_at_most_um", {number_or_null(one.compensated.at_most_um), {}}},
                      {"repaired_at_most_um", {number_or_null(one.repaired.at_most_um), {}}}});
}

Cell cause_cell(const CauseCost& cost, bool has_circle) {
  const std::string head = paragraph(
      fmt::format("{}: {} ({})", name_with_alternatives(cost.effect), remedy_text(cost.remedy), cost.how), 0, 2);
  Cell circle = remaining_cell("circle G", cost.circle);
  if (!has_circle) circle = null_cell();
  return record_cell("{head}{readings_rms}{volume_largest}{volume_rms}{circle}\n",
                     {{"head", shown_cell(head)},
                      {"", {effect_json(cost.effect), ""}},
                      {"remedy", {remedy_text(cost.remedy), ""}},
                      {"readings_rms", remaining_cell("readings, rms", cost.readings_rms)},
                      {"volume_largest", remaining_cell("volume, largest", cost.volume_largest)},
                      {"volume_rms", remaining_cell("volume, rms", cost.volume_rms)},
                      {"circle", std::move(circle)}});
}

Result<Contribution> contribution_of(const model::EffectFit& effect, const ModelWork& work, const Places& volume,
                                     const Circle& circle, const std::string& model_file) {
  model::Model alone = work.model;
  alone.effects = {effect.effect};
  const auto errors = errors_of_model(alone, *work.machine, model_file);
  auto in_volume = errors(volume);
  if (!in_volume) return tl::unexpected(in_volume.error());
  auto on_circle = errors(circle.places);
  if (!on_circle) return tl::unexpected(on_circle.error());
  return Contribution{effect.contribution, std::move(*in_volume), std::move(*on_circle)};
}

}  // namespace

Result<RepairAnswer> repair_answer(const ModelWork& work, const std::string& model_file, std::size_t places) {
  if (!work.machine) return problem(ProblemKind::usage, "expected --machine: its file holds the travels of the axes");
  if (work.data.rotary)
    return problem(ProblemKind::refused, "the volume is of linear axes: `ecs model what-if` takes rotary ones");
  const auto fit = model::fit(work.model, work.data);
  if (!fit) return tl::unexpected(in_file(fit.error(), model_file));
  const VolumePlaces volume = volume_places(*work.machine, places, *fit, work.data);
  const Circle circle = circle_of(*work.machine);
  RepairAnswer answer;
  answer.readings = work.data.size();
  answer.places = volume.places.size() / 2 - 1;
  answer.diameter_mm = circle.diameter_mm;
  answer.plane =
      fmt::format("{}{}", letter_of(static_cast<Axis>(circle.first)), letter_of(static_cast<Axis>(circle.second)));
  answer.noise_um = fit->noise.noise_um;

  const auto contributions = [&](const model::Fit& of) -> Result<std::vector<Contribution>> {
    std::vector<Contribution> each;
    for (const model::EffectFit& effect : of.effects) {
      auto one = contribution_of(effect, work, volume.places, circle, model_file);
      if (!one) return tl::unexpected(one.error());
      each.push_back(std::move(*one));
    }
    return each;
  };
  const auto fitted = contributions(*fit);
  if (!fitted) return tl::unexpected(fitted.error());
  struct CauseDraws {
    Draws left, compensated, repaired;
  };
  std::vector<CauseDraws> draws(fitted->size());
  const auto draw = [&](const model::Fit& possible) -> Result<void> {
    const auto machine = contributions(possible);
    if (!machine) return tl::unexpected(machine.error());
    Contribution rest{fit->residual, Vectors(volume.places.size()), Vectors(circle.places.size())};
    for (std::size_t i = 0; i < machine->size(); ++i) {
      rest.add((*machine)[i], 1.0);
      if (is_carried(fit->effects[i].effect, *work.machine)) rest.add((*fitted)[i], -1.0);
    }
    for (std::size_t i = 0; i < machine->size(); ++i) {
      const bool carried = is_carried(fit->effects[i].effect, *work.machine);
      Contribution other = rest;
      draws[i].compensated.take(sizes_left(other, volume.weight, circle));
      if (carried) other.add((*fitted)[i], 1.0);
      draws[i].left.take(sizes_left(other, volume.weight, circle));
      other.add((*machine)[i], -1.0);
      draws[i].repaired.take(sizes_left(other, volume.weight, circle));
    }
    return {};
  };
  for (const model::Fit& possible : refits(work.model, work.data, *fit, kRefits, kRefitSeed))
    if (auto drawn = draw(possible); !drawn) return tl::unexpected(drawn.error());
  bool unseen = false;
  for (std::size_t i = 0; i < fitted->size(); ++i) {
    CauseCost cost;
    cost.effect = fit->effects[i].effect;
    for (std::size_t q = 0; q < std::size(kQuantities); ++q)
      cost.*
          kQuantities[q] = {draws[i].left.expected(q), draws[i].compensated.expected(q), draws[i].repaired.expected(q)};
    cost.remedy = remedy_for(cost);
    cost.how = cost.remedy == Remedy::repair ? std::string(cost.effect.definition().check)
                                             : how_compensated(cost.effect, *work.machine);
    unseen = unseen || !cost.effect.definition().needs.empty();
    answer.causes.push_back(std::move(cost));
  }
  std::stable_sort(answer.causes.begin(), answer.causes.end(),
                   [](const CauseCost& a, const CauseCost& b) { return largest_cost_um(a) > largest_cost_um(b); });
  if (unseen)
    answer.notes.emplace_back(
        "volume and circle are those of a machine at rest, unloaded, without a change of temperature: what depends on "
        "a condition shows in the readings only");
  return answer;
}

Cell repair_cell(const RepairAnswer& answer) {
  const bool has_circle = answer.diameter_mm > 0.0;
  Cell causes{Json::array(), ""};
  for (const CauseCost& cost : answer.causes) causes.add(cause_cell(cost, has_circle));
  std::string head = fmt::format(
      "What is left [um] if one cause is left as it is, compensated or repaired, everything else that the unit can "
      "compensate being compensated; in brackets at most, with 95 %. {} readings (noise of one {:.2f} um), {} places "
      "of the volume from both sides",
      answer.readings, answer.noise_um, answer.places);
  if (has_circle)
    head += fmt::format(", a circle of {:.0f} mm in {} through the middle", answer.diameter_mm, answer.plane);
  return record_cell(
      "{head}\n                                left       compensated          repaired\n{causes}{notes}",
      {{"head", shown_cell(paragraph(head + "."))},
       {"readings", count_cell(answer.readings)},
       {"points", count_cell(answer.places)},
       {"noise_um", {number_or_null(answer.noise_um), ""}},
       {"circle_diameter_mm", {has_circle ? number_or_null(answer.diameter_mm) : Json(nullptr), ""}},
       {"circle_plane", {has_circle ? Json(answer.plane) : Json(nullptr), ""}},
       {"causes", std::move(causes)},
       {"notes", {answer.notes, notes_text(answer.notes)}}});
}

}  // namespace ecs::commissioning
