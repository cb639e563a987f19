#include "modules/controllers/tables.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "laser/map/rotary_map.hpp"

namespace ecs::controllers {
namespace {

using Key = std::pair<Component, Approach>;

bool acts_for(const laser::MapTable& table, Approach approach) {
  return table.approach == Approach::unknown || table.approach == approach;
}

/// How much of a table counts: half of a one-direction table where the axis is parked.
double part_of(const laser::MapTable& table, Approach approach) {
  if (acts_for(table, approach)) return 1.0;
  return approach == Approach::unknown ? 0.5 : 0.0;
}

/// A line of two points, for both approaches, across a pair of axes that has a squareness.
bool is_square_line(const ControllerTables& all, const laser::MapTable& table) {
  return all.lines_are_squareness && table.position_mm.size() == 2 && table.approach == Approach::unknown &&
         square_of(table.component);
}

/// All tables of a component that act for an approach, added up on the positions of all of them.
laser::MapTable sum_of(const ControllerTables& all, Component component, Approach approach) {
  std::set<double> positions;
  for (const laser::MapTable& table : all.tables)
    if (table.component == component && !is_square_line(all, table))
      positions.insert(table.position_mm.begin(), table.position_mm.end());
  laser::MapTable sum{component, approach, {positions.begin(), positions.end()}, {}};
  for (const double p : sum.position_mm) {
    double value = 0.0;
    for (const laser::MapTable& table : all.tables)
      if (table.component == component && !is_square_line(all, table) && acts_for(table, approach))
        value += compensation_at(table, p);
    sum.compensation.push_back(value);
  }
  return sum;
}

}  // namespace

std::optional<Square> square_of(Component straightness) {
  if (straightness == Component::EXY) return Square{Component::C0Y, -1.0};
  if (straightness == Component::EXZ) return Square{Component::B0Z, 1.0};
  if (straightness == Component::EYZ) return Square{Component::A0Z, -1.0};
  return std::nullopt;
}

Result<TermTable> iso_terms(const UnitParameters& parameters, std::string_view format) {
  if (parameters.convention != Convention::iso)
    return problem(ProblemKind::refused,
                   "the parameters use the printed signs of the thesis (compensation.convention = "
                   "\"as_printed\"); {} ISO 230-1: convert map and squareness first",
                   format);
  const auto chain = chain_of(parameters);
  if (!chain) return problem(ProblemKind::refused, "the configuration in the parameters is not a kinematic chain");
  return *terms_of(*chain, Convention::iso, CurveKind::measured);
}

Result<void> append(ControllerTables& all, ControllerTables more, bool alone) {
  if (alone)
    for (const laser::MapTable& table : more.tables)
      for (const laser::MapTable& other : all.tables)
        if (table.component == other.component)
          return problem(ProblemKind::bad_input, "{} occurs in two of the files", name_of(table.component));
  if (!all.sources.empty() && all.levers_from_lines != more.levers_from_lines)
    return problem(ProblemKind::bad_input, "the files state different origins of the lever arms: read them one by one");
  all.levers_from_lines = more.levers_from_lines;
  all.lines_are_squareness = all.lines_are_squareness || more.lines_are_squareness;
  const auto move_all = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move_all(all.tables, more.tables);
  move_all(all.sources, more.sources);
  for (std::string& note : more.notes)  // what holds for every file is said once
    if (std::ranges::find(all.notes, note) == all.notes.end()) all.notes.push_back(std::move(note));
  move_all(all.warnings, more.warnings);
  for (std::size_t c = 0; c < kComponents; ++c) all.squareness[c] += more.squareness[c];
  return {};
}

ReadMap map_of(const ControllerTables& tables) {
  ReadMap read;
  read.squareness = tables.squareness;
  std::set<Component> curves;
  for (const laser::MapTable& table : tables.tables) {
    if (!is_square_line(tables, table)) {
      curves.insert(table.component);
      continue;
    }
    const Square square = *square_of(table.component);
    const double rise_um = table.compensation[1] - table.compensation[0];
    const double run_m = (table.position_mm[1] - table.position_mm[0]) / 1000.0;
    const double value = -square.sign * rise_um / run_m;
    read.squareness[index_of(square.component)] += value;
    read.notes.push_back(
        fmt::format("a straight line of two points from {} to {} was read as squareness {} ({:.2f} um/m), not as {}; "
                    "its constant part is a zero shift and is ignored",
                    letter_of(moving_axis(table.component)), letter_of(direction_of(sense_of(table.component))),
                    name_of(square.component), value, name_of(table.component)));
  }
  for (const Component component : curves) {
    laser::MapTable forward = sum_of(tables, component, Approach::forward);
    laser::MapTable reverse = sum_of(tables, component, Approach::reverse);
    if (forward.compensation == reverse.compensation) {
      forward.approach = Approach::unknown;
      read.map.tables.push_back(std::move(forward));
    } else {
      read.map.tables.push_back(std::move(forward));
      read.map.tables.push_back(std::move(reverse));
    }
  }
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
    if (read.squareness[index_of(square)] != 0.0) read.squareness_found.push_back(square);
  read.map.header.sources = tables.sources;
  return read;
}

Vector3 compensation_by(const ControllerTables& tables, const TermTable& terms, const MachinePlace& place,
                        const MeasurementLines& lines, const Vector3& tool_offset_mm) {
  ComponentValues values{};
  for (const laser::MapTable& table : tables.tables) {
    const std::size_t axis = index_of(moving_axis(table.component));
    const double part = part_of(table, place.approach[axis]);
    if (part > 0.0) values[index_of(table.component)] += part * compensation_at(table, place.position_mm[axis]);
  }
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
    values[index_of(square)] = -tables.squareness[index_of(square)];
  return tool_error_um(terms, values, place.position_mm, lines, tool_offset_mm);
}

namespace {

const char* approach_text(Approach approach) {
  return approach == Approach::forward ? " forward" : approach == Approach::reverse ? " reverse" : "";
}

/// The first point of a table that no machine has; empty: none.
std::string beyond_any_machine(const laser::MapTable& table) {
  for (std::size_t i = 0; i < table.position_mm.size(); ++i) {
    const bool place = !(std::abs(table.position_mm[i]) <= kLargestPosition_mm);
    if (!place && std::abs(table.compensation[i]) <= kLargestValue_um) continue;
    return fmt::format("{}{}, point {} at {:.6g} mm: {} is no {} of a machine (at most {:.6g} {})",
                       name_of(table.component), approach_text(table.approach), i + 1, table.position_mm[i],
                       fmt::format("{:.6g}", place ? table.position_mm[i] : table.compensation[i]),
                       place ? "position" : "compensation", place ? kLargestPosition_mm : kLargestValue_um,
                       place ? "mm" : unit_of(table.component));
  }
  return {};
}

}  // namespace

tl::unexpected<Problem> unwritable(const Problem& why) {
  return tl::unexpected(Problem{
      ProblemKind::refused, "this part of the map cannot be written for this control: " + why.message, {}, 0, 0, {}});
}

Result<void> check_exportable(const laser::ErrorMap& map) {
  std::vector<Problem> problems;
  const auto refuse = [&](std::string why) {
    problems.push_back({ProblemKind::refused, std::move(why), {}, 0, 0, {}});
  };
  std::map<Component, int> approaches;
  for (const laser::MapTable& table : map.tables) {
    approaches[table.component] += table.approach == Approach::unknown ? 2 : 1;
    if (table.position_mm.size() < 2)
      refuse(fmt::format("{} has a table of {}: it needs two points at least", name_of(table.component),
                         table.position_mm.empty() ? "none" : "one point"));
    if (std::string beyond = beyond_any_machine(table); !beyond.empty()) refuse(std::move(beyond));
  }
  if (map.tables.empty()) refuse("the map has no tables");
  for (const auto& [component, count] : approaches)
    if (count < 2)
      refuse(fmt::format("{} has values for one approach only: the other direction would be uncorrected",
                         name_of(component)));
  if (problems.empty()) return {};
  return tl::unexpected(folded(std::move(problems)));
}

void leave_behind(ControllerExport& made, const ExportSource& source, const std::vector<Component>& carried,
                  const std::string& why_rotations, const std::string& why_others) {
  const auto is_carried = [&](Component c) { return std::ranges::find(carried, c) != carried.end(); };
  const auto squareness = squareness_of(source.parameters);
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto component = static_cast<Component>(i);
    const double largest =
        is_squareness(component) ? std::abs(squareness[i]) : largest_in(source.map.tables, component);
    if (largest == 0.0 || is_carried(component)) continue;
    const bool rotation = !is_squareness(component) && is_angular(component);
    made.not_carried.push_back({std::string(name_of(component)), largest, std::string(unit_of(component)),
                                rotation ? why_rotations : why_others});
  }
  for (const laser::MapRotaryAxis& axis : source.map.header.rotary)
    for (const laser::RotaryPart& part : laser::parts_of(axis))
      made.not_carried.push_back(
          {part.name, part.largest, part.unit, "a table follows X, Y or Z, not the angle of a rotary axis"});
  for (const laser::RotaryPart& part : laser::parts_of(source.map.header.bending))
    if (part.largest != 0.0)
      made.not_carried.push_back(
          {part.name, std::abs(part.largest), part.unit, "a table follows X, Y or Z, not the tilt of a head"});
}

}  // namespace ecs::controllers
