#include "laser/analysis/iso230_notes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"

namespace ecs::laser {
namespace {

constexpr int kRuns = 5;                  ///< in each direction, axes up to 2000 mm
constexpr double kTargetsPerMetre = 5.0;  ///< and at least five
constexpr double kLongAxis_mm = 2000.0;
constexpr double kTurn_deg = 360.0;

/// [mm], of a rotary axis [deg].
double span_mm(const Iso230& axis) { return axis.targets.back().position_mm - axis.targets.front().position_mm; }

bool is_evenly_spaced(const Iso230& axis) {
  if (axis.targets.size() < 3) return false;
  const double step = span_mm(axis) / static_cast<double>(axis.targets.size() - 1);
  for (std::size_t i = 0; i < axis.targets.size(); ++i)
    if (std::abs(axis.targets[i].position_mm - axis.targets.front().position_mm - step * static_cast<double>(i)) >
        axis.merge_tolerance_mm)
      return false;
  return true;
}

/// Targets that the standard asks for of a rotary axis, by its travel [deg].
std::size_t rotary_targets(double travel_deg) {
  if (travel_deg <= 90.0) return 3;
  return travel_deg <= 180.0 ? 5 : 8;
}

/// Where 0 and 360 degrees were both measured, they are one place.
void note_closing(const Iso230& axis, std::vector<std::string>& notes) {
  const Iso230Target &first = axis.targets.front(), &last = axis.targets.back();
  const bool closes = std::abs(last.position_mm - first.position_mm - kTurn_deg) <= axis.merge_tolerance_mm;
  const auto mean = [](const Iso230Target& t) {
    return t.mean ? t.mean : t.mean_forward ? t.mean_forward : t.mean_reverse;
  };
  if (closes && mean(first) && mean(last))
    notes.push_back(fmt::format("a full turn: the same place at {:g} and {:g} deg differs by {:+.3g} um/m",
                                first.position_mm, last.position_mm, *mean(last) - *mean(first)));
}

void note_rotary_targets(const Iso230& axis, std::vector<std::string>& notes) {
  const std::size_t wanted = rotary_targets(span_mm(axis));
  if (axis.targets.size() < wanted)
    notes.push_back(fmt::format("fewer than {} targets ({} on {:g} deg)", wanted, axis.targets.size(), span_mm(axis)));
  if (is_evenly_spaced(axis))
    notes.push_back("targets are evenly spaced: a periodic error of that pitch does not show");
  note_closing(axis, notes);
}

void note_targets(const Iso230& axis, std::vector<std::string>& notes) {
  if (axis.rotary) return note_rotary_targets(axis, notes);
  const std::size_t count = axis.targets.size();
  const double metres = span_mm(axis) / kMmPerM;
  if (count < 5) notes.push_back(fmt::format("fewer than 5 targets ({})", count));
  if (metres > 0.0 && metres <= kLongAxis_mm / kMmPerM && static_cast<double>(count) < kTargetsPerMetre * metres)
    notes.push_back(fmt::format("fewer than 5 targets per metre ({} on {:.3f} m)", count, metres));
  if (metres > kLongAxis_mm / kMmPerM)
    notes.push_back(
        "longer than 2000 mm: the standard asks for targets about every 250 mm and gives A and R for shorter axes");
  if (is_evenly_spaced(axis))
    notes.push_back("targets are evenly spaced: a periodic error of that pitch does not show");
}

void note_runs(const Iso230& axis, std::vector<std::string>& notes) {
  const auto side = [&](const char* name, int Iso230Target::*count) {
    const auto [fewest, most] = std::minmax_element(axis.targets.begin(), axis.targets.end(),
                                                    [&](const auto& a, const auto& b) { return a.*count < b.*count; });
    const int low = (*fewest).*count;
    const int high = (*most).*count;
    if (high == 0) return false;
    if (low < kRuns) notes.push_back(fmt::format("fewer than 5 {} readings at a target ({})", name, low));
    if (low != high)
      notes.push_back(fmt::format("targets differ between {} runs: {} to {} readings at a target", name, low, high));
    return true;
  };
  const bool forward = side("forward", &Iso230Target::n_forward);
  const bool reverse = side("reverse", &Iso230Target::n_reverse);
  if (forward != reverse)
    notes.push_back(fmt::format("{} approach only: no bidirectional values", forward ? "forward" : "reverse"));
  if (!forward && !reverse) notes.emplace_back("approach unknown: no values of one or of both directions");
}

void note_left_out(const Iso230& axis, std::vector<std::string>& notes) {
  const auto lacks = [&](auto mean, auto s) {
    return std::count_if(axis.targets.begin(), axis.targets.end(),
                         [&](const Iso230Target& target) { return target.*mean && !(target.*s); });
  };
  const auto single = lacks(&Iso230Target::mean_forward, &Iso230Target::s_forward) +
                      lacks(&Iso230Target::mean_reverse, &Iso230Target::s_reverse);
  if (single > 0)
    notes.push_back(fmt::format(
        "{} single readings give no standard deviation: they take no part in R, A and the 3 sigma band", single));
  const auto one_sided = std::count_if(axis.targets.begin(), axis.targets.end(), [](const Iso230Target& target) {
    return target.mean_forward.has_value() != target.mean_reverse.has_value();
  });
  if (axis.B && one_sided > 0)
    notes.push_back(fmt::format("{} targets have one approach only: they take no part in B, M and R", one_sided));
}

}  // namespace

std::vector<std::string> iso230_notes(const MeasurementSet& set, const Group& group, const Iso230& axis) {
  std::vector<std::string> notes;
  note_targets(axis, notes);
  note_runs(axis, notes);
  note_left_out(axis, notes);
  if (axis.sense != static_cast<Sense>(index_of(axis.axis) + (axis.rotary ? kAxes : 0)))
    notes.emplace_back(
        "not a positioning error: the formulas of ISO 230-2 are used, the standard does not ask for them");
  const auto undirected = std::count_if(group.readings.begin(), group.readings.end(),
                                        [&](std::size_t i) { return set.readings[i].approach == Approach::unknown; });
  if (undirected > 0 && has_known_approach(set, group))
    notes.push_back(fmt::format("{} readings of unknown approach are left out", undirected));
  return notes;
}

}  // namespace ecs::laser
