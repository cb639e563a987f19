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

void note_targets(const Iso230& axis, std::vector<std::string>& notes) {
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
  if (axis.sense != static_cast<Sense>(index_of(axis.axis)))
    notes.emplace_back(
        "not a positioning error: the formulas of ISO 230-2 are used, the standard does not ask for them");
  const auto undirected = std::count_if(group.readings.begin(), group.readings.end(),
                                        [&](std::size_t i) { return set.readings[i].approach == Approach::unknown; });
  if (undirected > 0 && has_known_approach(set, group))
    notes.push_back(fmt::format("{} readings of unknown approach are left out", undirected));
  return notes;
}

}  // namespace ecs::laser
