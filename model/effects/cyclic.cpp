// A wave over the position, A·sin(2πp/P + φ) and its second harmonic: screw pitch, grating pitch, gear mesh,
// electronic subdivision. Searched at frequencies that are even and oversampled, up to the Nyquist frequency of the
// targets (Lomb 1976; Scargle 1982; VanderPlas 2018, 7; for uneven targets Eyer and Bartholdi 1999), and at the pitches
// of the machine; the common step of targets by Euclid's algorithm.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/moved_targets.hpp"
#include "model/data/curve_basis.hpp"
#include "model/effects/artefact_place.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::model::effects {
namespace {

/// At targets that are whole multiples of a period its sine is 0: what rounding leaves of it (1e-12) would be fitted
/// with amplitudes of metres.
double unless_rounding(double value) { return std::abs(value) < 1e-9 ? 0.0 : value; }
double sine_of(double angle_rad) { return unless_rounding(std::sin(angle_rad)); }
double cosine_of(double angle_rad) { return unless_rounding(std::cos(angle_rad)); }

/// Euclid's algorithm ends at this share of the least step: what is left is rounding of the file.
constexpr double kRestOfStep = 1e-3;
/// Least common step, in mean distances of targets: below it the targets have none in practice.
constexpr double kLeastStep = 0.02;
/// Highest frequency, in turns between two targets: uneven targets see more than half a turn; a choice. A wave that the
/// user knows of is sought further, as far as this many shapes over all targets go.
constexpr double kHighestTurns = 5.0, kHighestTurnsOfModel = 25.0;
constexpr std::size_t kShapesOfModel = 400'000;
/// Fewer turns over the travel are a slope or a curve, not a period.
constexpr double kFewestTurns = 2.0;
/// A wave that the user knows of may be shorter than even targets can show, and few of them see it as fewer turns than
/// that; as fewer than this it would take slopes and bows.
constexpr double kFewestTurnsSeen = 1.6;
/// A fit moves a frequency by at most this many turns over the travel: further away is another peak, for the search to
/// try.
constexpr double kPeak = 0.5;
/// Frequencies tried per 1/travel: three keep the nearest within a sixth of a turn over the travel (VanderPlas 2018:
/// five to ten; here the best are refined).
constexpr double kOversampling = 3.0;
/// Rounding of the highest frequency.
constexpr double kRounding = 1.0001;
/// A period is also chosen among this many: three approaches, or one or two harmonics.
constexpr double kWays = 3.0;
/// Parts and multiples of a pitch: gears, belts, poles of a motor and starts of a thread, in the order of trust.
constexpr std::array kPartsOfPitch{1.0, 0.5, 2.0, 1.0 / 3.0, 0.25, 0.2, 3.0, 4.0, 5.0, 0.1};
constexpr double kTurn_deg = 360.0;
/// Period assumed for planning: eight in the travel, no shorter than this [mm]; well inside what a plan can show.
constexpr double kPeriodsAssumed = 8.0, kLeastPeriod_mm = 1e-3;

/// Greatest step of which all positions are multiples, 0 if it is below `least`.
double common_step(const std::vector<double>& p, double least) {
  double step = 0.0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    double a = std::max(step, p[i] - p[i - 1]), b = std::min(step, p[i] - p[i - 1]);
    while (b > kRestOfStep * least) {
      const double rest = std::abs(a - b * std::round(a / b));
      a = b;
      b = rest;
    }
    step = a;
    if (step < least) return 0.0;
  }
  return step;
}

/// Pitches of the axis, their fractions and multiples, of which enough turns fit into the travel.
/// @param shortest_mm  below it a period looks like a slower one, as one of so many does by chance: the pitches alone
std::vector<double> pitches(const Observations& data, Axis axis, double travel_mm, double shortest_mm) {
  std::vector<double> facts;
  const auto& machine_axis = data.machine.axes[index_of(axis)];
  if (!machine_axis) return facts;
  for (const auto& pitch : {machine_axis->screw_pitch_mm, machine_axis->scale_pitch_mm}) {
    if (!pitch) continue;
    for (const double part : kPartsOfPitch)
      if (*pitch * part * kFewestTurns < travel_mm && (part == 1.0 || *pitch * part >= shortest_mm))
        facts.push_back(*pitch * part);
  }
  return facts;
}

/// Frequencies around pitches that uneven targets reach only there: a pitch of the machine file may be wrong by this
/// part, and a wave that is out of step with it over the travel hides it. Not where that are too many to try.
void add_near_pitches(const Observations& data, Axis axis, double travel_mm, double highest, TriedValues& tried) {
  constexpr double kWrong = 0.02;
  constexpr double kMostNear = 400.0;
  const auto& machine_axis = data.machine.axes[index_of(axis)];
  if (!machine_axis) return;
  for (const auto& pitch : {machine_axis->screw_pitch_mm, machine_axis->scale_pitch_mm}) {
    if (!pitch || 1.0 / *pitch <= highest) continue;
    const double least = (1.0 - kWrong) / *pitch, count = 2.0 * kWrong / *pitch * kOversampling * travel_mm;
    for (int i = 0; count <= kMostNear && i <= static_cast<int>(count); ++i)
      tried.values.push_back(1.0 / (least + i / (kOversampling * travel_mm)));
  }
}

/// A scan has this share of its steps alike, within this part of a step.
constexpr double kScanShare = 0.8, kAlike = 0.01;

/// The step of a scan: of readings at equal steps each way, whose two ways are out of step with each other. They see no
/// more than half a turn a step, because of a shorter wave each way sees the same alias. 0 if the readings are no scan.
double scan_step(const Observations& data, const Acting& acting, Axis axis) {
  double least = 0.0;
  for (const int way : {1, -1}) {
    std::vector<double> p, steps;
    for (const std::size_t k : acting.rows)
      if (data.approach[k] == way && data.axis[k] == axis) p.push_back(data.p_mm(k, axis));
    std::ranges::sort(p);
    for (std::size_t i = 1; i < p.size(); ++i)
      if (p[i] > p[i - 1]) steps.push_back(p[i] - p[i - 1]);
    if (steps.size() < kFewestWaveTargets) continue;
    std::ranges::sort(steps);
    const double usual = steps[steps.size() / 2];
    const auto alike = std::ranges::count_if(steps, [&](double s) { return std::abs(s - usual) <= kAlike * usual; });
    if (static_cast<double>(alike) < kScanShare * static_cast<double>(steps.size())) return 0.0;
    least = least == 0.0 ? usual : std::min(least, usual);
  }
  return least;
}

/// Whole fractions of a turn, up to as many as the targets show: what turns comes back (ISO 230-7). Of an arc the
/// turn itself is a period by nature.
/// @param scan_deg  step of a scan, 0: none
/// @param lowest    waves a turn, at least
TriedValues fractions_of_turn(const std::vector<double>& angles_deg, double scan_deg, double lowest,
                              const SearchExtent& extent) {
  TriedValues tried;
  const double arc = angles_deg.back() - angles_deg.front();
  const double mean_step = arc / static_cast<double>(angles_deg.size() - 1);
  const double step = common_step(angles_deg, kLeastStep * mean_step);
  double highest = kHighestTurns / mean_step;
  for (const double even : {step, scan_deg})
    if (even > 0.0) highest = std::min(highest, 0.5 / even);
  for (double order = lowest; order <= kTurn_deg * highest * kRounding && tried.values.size() < extent.most;
       order += 1.0)
    tried.values.push_back(kTurn_deg / order);
  tried.facts = tried.values;
  tried.independent = kWays * std::max(2.0, static_cast<double>(tried.values.size()));
  return tried;
}

/// Of readings of a ball: a shift of the axis next to the tool that follows one turn of it is bending by weight, an
/// effect of its own (head_bending): the same function under another name could not be told from it by any reading.
bool is_bending(const Observations& data, const EffectInstance& effect) {
  return !data.through_chain.empty() && !is_rotation(*effect.sense) && tilting_axis(data) == effect.axis;
}

TriedValues periods(const Observations& data, const EffectInstance& effect, const Acting& acting,
                    const SearchExtent& extent) {
  TriedValues tried;
  const std::vector<double> p = acting_positions(data, acting, *effect.axis);
  if (p.size() < kFewestWaveTargets) return tried;
  if (data.rotary)
    return fractions_of_turn(p, scan_step(data, acting, *effect.axis), is_bending(data, effect) ? 2.0 : 1.0, extent);
  const double travel = p.back() - p.front();
  const double mean_step = travel / static_cast<double>(p.size() - 1);
  const double step = even_step_mm(p).value_or(common_step(p, kLeastStep * mean_step));
  double highest = (extent.is_of_model ? kHighestTurnsOfModel : kHighestTurns) / mean_step;
  if (step > 0.0) highest = std::min(highest, 0.5 / step);
  const double lowest = kFewestTurns / travel;
  const auto wanted = static_cast<std::size_t>(std::max(1.0, kOversampling * travel * (highest - lowest)));
  const std::size_t count =
      std::min(wanted, extent.is_of_model ? std::max(extent.most, kShapesOfModel / p.size()) : extent.most);
  for (std::size_t i = 0; i <= count; ++i) {
    const double frequency = lowest + static_cast<double>(i) / (kOversampling * travel);
    if (step > 0.0 && frequency > highest * kRounding) break;
    tried.values.push_back(1.0 / frequency);
  }
  if (step <= 0.0) add_near_pitches(data, *effect.axis, travel, highest, tried);
  tried.far = mean_step / kHighestTurns;
  tried.independent = kWays * std::max(2.0, static_cast<double>(tried.values.size()) / kOversampling);
  tried.facts = pitches(data, *effect.axis, travel, step > 0.0 ? 1.0 / (highest * kRounding) : 0.0);
  if (extent.is_of_model && p.size() <= kFreeTargets && even_step_mm(p)) {
    tried.far = 1.0 / (highest * kRounding);
    const int slower = static_cast<int>(kOversampling * (kFewestTurns - kFewestTurnsSeen));
    for (int i = 0; i <= slower; ++i) {
      const double frequency = 1.0 / step - lowest + static_cast<double>(i) / (kOversampling * travel);
      if (frequency > highest * kRounding) tried.values.push_back(1.0 / frequency);
    }
  }
  return tried;
}

/// Within the peak of the start, at least two whole turns inside the travel; of a rotary axis as it is.
ValueRange period_limits(const Observations& data, const EffectInstance& effect, const Acting& acting, double start) {
  const auto [first, last] = acting_range(data, acting, *effect.axis);
  const double travel = last - first;
  if (travel <= 0.0 || data.rotary) return {start, start};
  const double lowest = kFewestTurns / travel, frequency = std::max(lowest, 1.0 / std::abs(start));
  return {1.0 / (frequency + kPeak / travel), 1.0 / std::max(lowest, frequency - kPeak / travel)};
}

double assumed_period(const Observations& plan, const EffectInstance& effect, const Acting& acting) {
  if (plan.rotary) return kTurn_deg;
  const auto& axis = plan.machine.axes[index_of(*effect.axis)];
  if (axis && axis->screw_pitch_mm) return *axis->screw_pitch_mm;
  const auto [least, greatest] = acting_range(plan, acting, *effect.axis);
  return std::max((greatest - least) / kPeriodsAssumed, kLeastPeriod_mm);
}

}  // namespace

EffectDefinition cyclic() {
  return {
      .id = "cyclic",
      .title = "Periodic error",
      .formula = "A sin(2 pi p/P + phi), harmonics 1-2",
      .cause =
          "pitch of screw, rack, gear or grating, electronic subdivision; for a long wave, form or supports of the way",
      .tells_apart =
          "the same period everywhere along the travel: often the pitch of a screw or scale, or one turn of a rotary "
          "axis",
      .check =
          "compare the period with pitches of screw, rack, gears and scale; check for an eccentric screw, a bent "
          "coupling, a dirty or tilted reading head",
      .headline = "a periodic error of +-{amplitude_um} in {where}, period {period_mm}",
      .parameters = {{"period_mm", "mm", "length of one period", Coding::searched},
                     {"amplitude_um", "um", "amplitude of the fundamental", Coding::amplitude},
                     {"phase_rad", "rad", "phase of the fundamental, sin(2 pi p/P + phase)", Coding::phase},
                     {"amplitude2_um", "um", "amplitude of the second harmonic", Coding::amplitude},
                     {"phase2_rad", "rad", "phase of the second harmonic", Coding::phase}},
      .carrier = Carrier::error_map,
      .how = "a table of the error map with increments well below the period",
      .separated_by =
          {90, "Measure {axis} over three periods of this wave in steps of {tenth}, in the middle of the travel.",
           false},
      .turns_into = {{Limit::at_greatest, "scale"}, {Limit::at_greatest, "progressive"}},
      .traits = {.periodic = true,
                 .shape_of_position = true,
                 .one_per_axis = true,
                 .several_alike = true,
                 .on_rotary_axes = true},
      .preference = 30,
      .columns_of_place =
          [](double p_mm, double searched, std::span<double> row) {
            const double angle = 2.0 * std::numbers::pi * p_mm / searched;
            for (std::size_t h = 0; 2 * h + 1 < row.size(); ++h) {
              const double harmonic = static_cast<double>(h + 1);
              row[2 * h] = sine_of(harmonic * angle);
              row[2 * h + 1] = cosine_of(harmonic * angle);
            }
          },
      .column_sets = {{0, 1}, {0, 1, 2, 3}},
      .search = {.tried = periods, .assumed = assumed_period, .limits = period_limits},
      .along_axis = [](const Site& site) { return site.once(site.places >= kFewestWaveTargets); },
      .of_reversal =
          [](const Site& site) {
            std::vector<EffectInstance> all;
            for (const ApproachMode mode : {ApproachMode::forward, ApproachMode::reverse})
              for (EffectInstance& one : site.once(site.places >= kFewestWaveTargets)) {
                all.push_back(std::move(one));
                all.back().approach = mode;
              }
            return all;
          },
  };
}

}  // namespace ecs::model::effects
