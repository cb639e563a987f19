#include "commissioning/maps/compare.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/measurements/fields.hpp"
#include "laser/groups.hpp"
#include "laser/map/rotary_map.hpp"

namespace ecs::commissioning {
namespace {

using laser::ErrorMap;
using laser::MapRotaryAxis;
using laser::MapTable;

constexpr double kSamePlace_mm = 1e-6, kSameParked_mm = 1e-3;

bool is_declared_zero(const ErrorMap& map, Component component) {
  return std::ranges::any_of(map.header.declared_zero, [&](const auto& zero) { return zero.component == component; });
}

/// Forward and reverse; none where a curve has no table for one of them.
using Tables = std::vector<const MapTable*>;
Tables tables_of(const ErrorMap& map, Component component) {
  Tables tables;
  for (const Approach approach : {Approach::forward, Approach::reverse})
    if (const MapTable* table = laser::table_of(map, component, approach); table && !table->position_mm.empty())
      tables.push_back(table);
  return tables.size() == 2 ? tables : Tables{};
}

double error_by(const Tables& tables, std::size_t approach, double position_mm) {
  return tables.empty() ? 0.0 : -laser::compensation_at(*tables[approach], position_mm);
}

std::vector<double> shared_places(const Tables& first, const Tables& second) {
  double low = -HUGE_VAL, high = HUGE_VAL;
  std::vector<double> places;
  for (const Tables* tables : {&first, &second})
    for (const MapTable* table : *tables) {
      low = std::max(low, table->position_mm.front());
      high = std::min(high, table->position_mm.back());
      places.insert(places.end(), table->position_mm.begin(), table->position_mm.end());
    }
  std::ranges::sort(places);
  std::erase_if(places, [&](double p) { return p < low || p > high; });
  const auto same = [](double a, double b) { return b - a < kSamePlace_mm; };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
  return places;
}

/// Fewer than two points: no travel in common.
CurveChange change_of(const Tables& in_first, const Tables& in_second, Component component) {
  CurveChange change{component, false, {}, shared_places(in_first, in_second), {}, {}};
  for (const Tables& tables : {in_first, in_second})
    change.by_approach = change.by_approach || (!tables.empty() && tables[0] != tables[1]);
  for (const double p : change.position_mm) {
    change.forward.push_back(error_by(in_second, 0, p) - error_by(in_first, 0, p));
    change.reverse.push_back(error_by(in_second, 1, p) - error_by(in_first, 1, p));
  }
  return change;
}

/// Nothing: a note says why.
std::optional<CurveChange> curve_change(const ErrorMap& first, const ErrorMap& second, Component component,
                                        std::vector<std::string>& notes) {
  const Tables in_first = tables_of(first, component), in_second = tables_of(second, component);
  if (in_first.empty() && in_second.empty()) return std::nullopt;
  for (const auto& [tables, map, name] : {std::tuple(&in_first, &first, "first"), {&in_second, &second, "second"}})
    if (tables->empty() && !is_declared_zero(*map, component)) {
      notes.push_back(
          fmt::format("{} is not in the {} map, or for one approach only: not compared", name_of(component), name));
      return std::nullopt;
    }
  CurveChange change = change_of(in_first, in_second, component);
  if (change.position_mm.size() < 2) {
    notes.push_back(fmt::format("{}: the maps have no travel in common: not compared", name_of(component)));
    return std::nullopt;
  }
  return change;
}

void note_other(std::vector<std::string>& notes, std::string_view what, const std::string& first,
                const std::string& second) {
  if (!first.empty() && !second.empty() && first != second)
    notes.push_back(fmt::format("the files are of different {}: {} and {}", what, first, second));
}

/// "Y 33.12, Z 0" of a line along X.
std::string place_of_line(Component component, const Vector3& parked_mm) {
  laser::Group group;
  group.axis = moving_axis(component);
  group.parked_mm = parked_mm;
  return parked_text(group);
}

/// A measured line of X, Y or Z as tables: forward and reverse, or one for both.
struct LineOfTables {
  Component component = Component::EXX;
  Vector3 parked_mm{}, parked_deg{};
  std::vector<MapTable> tables;

  [[nodiscard]] bool is_same_as(const LineOfTables& other) const {
    bool same = component == other.component && parked_deg == other.parked_deg;
    for (std::size_t a = 0; a < kAxes; ++a)
      same = same && std::abs(parked_mm[a] - other.parked_mm[a]) <= kSameParked_mm;
    return same;
  }
  /// Forward and reverse, without those that the other line has not; none where the lines share no approach.
  [[nodiscard]] Tables shared_with(const LineOfTables& other) const {
    const bool any = other.tables.front().approach == Approach::unknown || tables.front().approach == Approach::unknown;
    Tables shared;
    for (const MapTable& table : tables)
      if (any || std::ranges::find(other.tables, table.approach, &MapTable::approach) != other.tables.end())
        shared.push_back(&table);
    if (shared.size() == 1) shared.push_back(shared.front());
    return shared;
  }
  [[nodiscard]] std::string name() const {
    return fmt::format("{} at {}", name_of(component), place_of_line(component, parked_mm));
  }
};

LineOfTables line_of(const laser::MeasurementSet& set, const laser::Group& group, Component component) {
  LineOfTables line{component, group.parked_mm, group.parked_deg, {}};
  const auto targets = laser::targets_of(set, group, laser::target_tolerance_mm(set, group));
  const auto add = [&](Approach approach, std::vector<double> laser::TargetReadings::*readings) {
    MapTable table{component, approach, {}, {}};
    for (const laser::TargetReadings& target : targets)
      if (const auto mean = laser::mean_of(target.*readings)) {
        table.position_mm.push_back(target.position_mm);
        table.compensation.push_back(-*mean);
      }
    if (!table.position_mm.empty()) line.tables.push_back(std::move(table));
  };
  if (!laser::has_known_approach(set, group)) {
    add(Approach::unknown, &laser::TargetReadings::undirected);
  } else {
    add(Approach::forward, &laser::TargetReadings::forward);
    add(Approach::reverse, &laser::TargetReadings::reverse);
  }
  return line;
}

/// A note for those that are there twice.
std::vector<LineOfTables> measured_lines(const laser::MeasurementSet& set, std::string_view which,
                                         std::vector<std::string>& notes) {
  std::vector<LineOfTables> lines;
  for (const laser::Group& group : laser::groups_of(set)) {
    LineOfTables line = line_of(set, group, curve_of(group.sense, group.axis));
    if (std::ranges::any_of(lines, [&](const LineOfTables& other) { return other.is_same_as(line); }))
      notes.push_back(fmt::format(
          "{} is twice in the {} file, with and without compensation: only the first is compared", line.name(), which));
    else
      lines.push_back(std::move(line));
  }
  return lines;
}

const MapRotaryAxis* axis_in(const laser::MapHeader& header, char letter) {
  const auto found =
      std::ranges::find_if(header.rotary, [&](const MapRotaryAxis& one) { return one.axis.letter == letter; });
  return found == header.rotary.end() ? nullptr : &*found;
}

std::vector<double> angles_deg_of(const MapRotaryAxis& first, const MapRotaryAxis& second) {
  std::vector<double> angles_deg;
  for (const MapRotaryAxis* one : {&first, &second})
    for (std::size_t k = 0; k < one->compensation[0][0].size(); ++k)
      angles_deg.push_back(one->start_deg + static_cast<double>(k) * one->increment_deg);
  return angles_deg;
}

/// Nothing: zero in both, or no angle in common.
std::optional<RotaryChange> rotary_curve_change(const MapRotaryAxis& first, const MapRotaryAxis& second,
                                                std::size_t sense) {
  const auto sides = [&](const MapRotaryAxis& one) { return one.compensation[0][sense] != one.compensation[1][sense]; };
  const auto is_zero = [](double value) { return value == 0.0; };
  bool any = false;
  for (const MapRotaryAxis* one : {&first, &second})
    for (const auto& side : one->compensation) any = any || !std::ranges::all_of(side[sense], is_zero);
  if (!any) return std::nullopt;
  RotaryChange change{laser::rotary_curve_name(first.axis.letter, sense), sense < kAxes ? "um" : "um/m", 0.0, {}, {}};
  for (const double angle_deg : angles_deg_of(first, second))
    for (const std::size_t side : {1U, 0U}) {
      const auto before = laser::rotary_error_at(first, side, sense, angle_deg);
      const auto after = laser::rotary_error_at(second, side, sense, angle_deg);
      if (!before || !after || (change.at_deg && std::abs(*after - *before) <= std::abs(change.largest))) continue;
      change.largest = *after - *before;
      change.at_deg = angle_deg;
      change.approach = !sides(first) && !sides(second) ? Approach::unknown
                        : side == 1                     ? Approach::forward
                                                        : Approach::reverse;
    }
  return change.at_deg ? std::optional(change) : std::nullopt;
}

/// Location errors and curves of the axes that both maps have; a note for what else differs.
void add_rotary_changes(const laser::MapHeader& first, const laser::MapHeader& second, MapChange& change) {
  note_other(change.notes, "rotary configurations", first.rotary_configuration, second.rotary_configuration);
  for (const char letter : {'A', 'B', 'C'}) {
    const MapRotaryAxis* const in_first = axis_in(first, letter);
    const MapRotaryAxis* const in_second = axis_in(second, letter);
    if (in_first == nullptr && in_second == nullptr) continue;
    if (in_first == nullptr || in_second == nullptr) {
      change.notes.push_back(fmt::format("the rotary axis {} is not in the {} map: not compared", letter,
                                         in_first == nullptr ? "first" : "second"));
      continue;
    }
    const RotaryAxis &a = in_first->axis, &b = in_second->axis;
    if (a.direction != b.direction || a.pivot_mm != b.pivot_mm)
      change.notes.push_back(fmt::format(
          "the rotary axis {} has another direction or pivot in the second map: its errors act at other arms", letter));
    if (a.deg_per_count != b.deg_per_count || a.zero_deg != b.zero_deg || a.deadband_deg != b.deadband_deg)
      change.notes.push_back(fmt::format("the transducer of the rotary axis {} is described differently", letter));
    for (std::size_t s = 0; s < 6; ++s)
      if (a.location[s] != 0.0 || b.location[s] != 0.0)
        change.rotary.push_back({laser::rotary_location_name(letter, s),
                                 s < kAxes ? "um" : "um/m",
                                 b.location[s] - a.location[s],
                                 {},
                                 Approach::unknown});
    for (std::size_t s = 0; s < 6; ++s)
      if (auto curve = rotary_curve_change(*in_first, *in_second, s)) change.rotary.push_back(std::move(*curve));
  }
  const auto before = laser::parts_of(first.bending), after = laser::parts_of(second.bending);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i].largest != 0.0 || after[i].largest != 0.0)
      change.rotary.push_back(
          {after[i].name, after[i].unit, after[i].largest - before[i].largest, {}, Approach::unknown});
}

}  // namespace

ChangeFigures figures_of(const CurveChange& change) {
  ChangeFigures f;
  const auto n = static_cast<double>(change.position_mm.size());
  double centre_mm = 0.0, mean_forward = 0.0, mean_reverse = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < change.position_mm.size(); ++i) {
    centre_mm += change.position_mm[i] / n;
    mean_forward += change.forward[i] / n;
    mean_reverse += change.reverse[i] / n;
    squares += (change.forward[i] * change.forward[i] + change.reverse[i] * change.reverse[i]) / (2.0 * n);
    for (const auto& [value, approach] :
         {std::pair(change.forward[i], Approach::forward), {change.reverse[i], Approach::reverse}})
      if (std::abs(value) > std::abs(f.largest)) {
        f.largest = value;
        f.at_mm = change.position_mm[i];
        f.approach = change.by_approach ? approach : Approach::unknown;
      }
  }
  f.rms = std::sqrt(squares);
  f.mean = (mean_forward + mean_reverse) / 2.0;
  f.reversal = mean_forward - mean_reverse;
  double moment = 0.0, weight = 0.0, left = 0.0;
  for (std::size_t i = 0; i < change.position_mm.size(); ++i) {
    const double arm_m = (change.position_mm[i] - centre_mm) / 1e3;
    moment += arm_m * (change.forward[i] + change.reverse[i]) / 2.0;
    weight += arm_m * arm_m;
  }
  f.slope_per_m = moment / weight;
  for (std::size_t i = 0; i < change.position_mm.size(); ++i) {
    const double line = f.slope_per_m * (change.position_mm[i] - centre_mm) / 1e3;
    left += std::pow(change.forward[i] - mean_forward - line, 2) + std::pow(change.reverse[i] - mean_reverse - line, 2);
  }
  f.left_rms = std::sqrt(left / (2.0 * n));
  return f;
}

MapChange change_between(const ErrorMap& first, const ErrorMap& second) {
  MapChange change;
  note_other(change.notes, "machines", first.header.machine, second.header.machine);
  note_other(change.notes, "serial numbers", first.header.serial_number, second.header.serial_number);
  note_other(change.notes, "configurations", first.header.configuration, second.header.configuration);
  for (std::size_t c = 0; c < kCurves; ++c)
    if (auto curve = curve_change(first, second, static_cast<Component>(c), change.notes))
      change.curves.push_back(std::move(*curve));
  if (change.curves.empty()) change.notes.emplace_back("the maps have no curve in common");
  add_rotary_changes(first.header, second.header, change);
  if (first.header.thermal != second.header.thermal)
    change.notes.emplace_back("the thermal rows of the maps differ; they are not compared");
  return change;
}

MapChange change_between(const laser::MeasurementSet& first, const laser::MeasurementSet& second) {
  MapChange change;
  const auto machine = laser::measured_machine(first.metadata), machine_then = laser::measured_machine(second.metadata);
  note_other(change.notes, "machines", machine.name, machine_then.name);
  note_other(change.notes, "serial numbers", machine.serial_number, machine_then.serial_number);
  const auto before = measured_lines(first, "first", change.notes),
             after = measured_lines(second, "second", change.notes);
  const auto same_in = [](const std::vector<LineOfTables>& lines, const LineOfTables& one) {
    return std::ranges::find_if(lines, [&](const LineOfTables& other) { return other.is_same_as(one); });
  };
  for (const LineOfTables& line : after) {
    const auto found = same_in(before, line);
    if (found == before.end()) {
      change.notes.push_back(fmt::format("{} is not in the first file: not compared", line.name()));
      continue;
    }
    CurveChange curve = change_of(found->shared_with(line), line.shared_with(*found), line.component);
    curve.parked_mm = line.parked_mm;
    if (curve.position_mm.size() < 2)
      change.notes.push_back(fmt::format("{}: the files share no travel and approach: not compared", line.name()));
    else
      change.curves.push_back(std::move(curve));
  }
  for (const LineOfTables& line : before)
    if (same_in(after, line) == after.end())
      change.notes.push_back(fmt::format("{} is not in the second file: not compared", line.name()));
  return change;
}

laser::MeasurementSet measurement_of(const MapChange& change, const std::string& machine,
                                     const std::vector<std::string>& names) {
  laser::MeasurementSet set;
  set.metadata = {{"difference", fmt::format("errors of {} minus errors of {}", names[1], names[0])}};
  if (!machine.empty()) set.metadata.push_back({"machine", machine});
  for (const CurveChange& curve : change.curves)
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      if (approach == Approach::reverse && !curve.by_approach) continue;
      for (std::size_t k = 0; k < curve.position_mm.size(); ++k) {
        const std::size_t i = approach == Approach::reverse ? curve.position_mm.size() - 1 - k : k;
        laser::Reading reading;
        reading.axis = moving_axis(curve.component);
        reading.sense = sense_of(curve.component);
        reading.position_mm = curve.parked_mm;
        reading.position_mm[index_of(reading.axis)] = curve.position_mm[i];
        reading.error = (approach == Approach::reverse ? curve.reverse : curve.forward)[i];
        reading.approach = curve.by_approach ? approach : Approach::unknown;
        set.readings.push_back(std::move(reading));
      }
    }
  return set;
}

Cell change_cell(const MapChange& change) {
  const auto row = [](const CurveChange& curve) {
    const ChangeFigures f = figures_of(curve);
    const bool at_zero = curve.parked_mm == Vector3{};
    const std::string place = at_zero ? "" : "  at " + place_of_line(curve.component, curve.parked_mm);
    return record_cell(
        "{component:<4} {unit:<4} {largest:>8} {at_mm:>9} {approach:<8} {rms:>8} {mean:>8} {slope_per_m:>8} "
        "{reversal:>8} {left_rms:>8}{parked}\n",
        "component"_is(name_of(curve.component)), "unit"_is(unit_of(curve.component)), "largest"_is(f.largest, 2),
        "at_mm"_is(f.at_mm, fmt::format("{:.6g}", f.at_mm)), "approach"_is(word_for(f.approach)), "rms"_is(f.rms, 2),
        "mean"_is(f.mean, 2), "slope_per_m"_is(f.slope_per_m, 2), "reversal"_is(f.reversal, 2),
        "left_rms"_is(f.left_rms, 2), "points"_is(curve.position_mm.size()), "from_mm"_is(curve.position_mm.front()),
        "to_mm"_is(curve.position_mm.back()), "parked"_shown(place));
  };
  return list_cell(change.curves, row,
                   fmt::format("{:<4} {:<4} {:>8} {:>9} {:<8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "", "", "largest",
                               "at [mm]", "approach", "rms", "mean", "slope/m", "reversal", "residual"));
}

Cell rotary_change_cell(const MapChange& change) {
  const auto row = [](const RotaryChange& one) {
    const std::string_view approach = word_for(one.approach);
    return record_cell("{component:<4} {unit:<4} {largest:>8}{place}\n", "component"_is(one.name), "unit"_is(one.unit),
                       "largest"_is(one.largest, 2), "at_deg"_is(one.at_deg),
                       "approach"_is(one.at_deg ? cell_of(approach) : null_cell()),
                       "place"_shown(one.at_deg ? fmt::format(" {:>9.6g} {}", *one.at_deg, approach) : std::string()));
  };
  if (change.rotary.empty()) return {Json::array(), {}};
  return list_cell(change.rotary, row,
                   fmt::format("{:<9} {:>8} {:>9} {}\n", "rotary", "largest", "at [deg]", "approach"));
}

bool is_without_change(const MapChange& change) {
  constexpr double kResolution = 0.0005;  // half of the last digit of a map file
  const auto small = [](double largest) { return std::abs(largest) < kResolution; };
  return std::ranges::all_of(change.curves, [&](const auto& curve) { return small(figures_of(curve).largest); }) &&
         std::ranges::all_of(change.rotary, [&](const RotaryChange& one) { return small(one.largest); });
}

std::string closing_text(const MapChange& change, const std::string& first, const std::string& second) {
  if (is_without_change(change)) return fmt::format("No compared curve of {} differs from {}.\n", second, first);
  return "The files do not show which map is better. Measure with each of them active, and compare the residual errors "
         "with `ecs laser stats`.\n";
}

}  // namespace ecs::commissioning
