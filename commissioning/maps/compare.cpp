#include "commissioning/maps/compare.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/maps/view.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kSame = 1e-6;

const laser::MapTable* same_table(const laser::ErrorMap& map, const laser::MapTable& table) {
  const auto found = std::find_if(map.tables.begin(), map.tables.end(), [&](const laser::MapTable& t) {
    return t.component == table.component && t.approach == table.approach;
  });
  return found == map.tables.end() ? nullptr : &*found;
}

std::string name_of_table(const laser::MapTable& table) {
  return fmt::format("{} {}", name_of(table.component), word_for(table.approach));
}

MapDifference of_table(const laser::MapTable& table, const std::string& what) {
  return {table.component, table.approach, {}, {}, {}, fmt::format("{}: {}", name_of_table(table), what)};
}

void compare_headers(const laser::MapHeader& expected, const laser::MapHeader& found, std::vector<MapDifference>& out) {
  const std::string a = laser::header_text(expected), b = laser::header_text(found);
  const auto lines_a = lines_of(a), lines_b = lines_of(b);
  const auto take = [&](const auto& lines, const auto& other, const char* where) {
    for (const std::string_view line : lines)
      if (std::find(other.begin(), other.end(), line) == other.end())
        out.push_back({{}, {}, {}, {}, {}, fmt::format("header: only {} says \"{}\"", where, line)});
  };
  take(lines_a, lines_b, "the file");
  take(lines_b, lines_a, "the unit");
}

void compare_values(const laser::MapTable& expected, const laser::MapTable& found, std::vector<MapDifference>& out) {
  if (expected.position_mm.size() != found.position_mm.size()) {
    out.push_back(of_table(expected, fmt::format("the file has {} points, the unit {}", expected.position_mm.size(),
                                                 found.position_mm.size())));
    return;
  }
  for (std::size_t i = 0; i < expected.position_mm.size(); ++i) {
    const double p = expected.position_mm[i], want = expected.compensation[i], got = found.compensation[i];
    if (std::abs(p - found.position_mm[i]) > kSame)
      out.push_back({expected.component,
                     expected.approach,
                     p,
                     {},
                     {},
                     fmt::format("{}: the file has a point at {:.6g} mm, the unit at {:.6g} mm",
                                 name_of_table(expected), p, found.position_mm[i])});
    else if (std::abs(want - got) > kSame)
      out.push_back({expected.component, expected.approach, p, want, got,
                     fmt::format("{} at {:.6g} mm: file {:.2f} {}, unit {:.2f}", name_of_table(expected), p, want,
                                 unit_of(expected.component), got)});
  }
}

/// At the points of either. @pre both have points
LargestDifference largest_between(const laser::MapTable& file, const laser::MapTable& unit) {
  LargestDifference largest;
  bool any = false;
  for (const auto* points : {&file.position_mm, &unit.position_mm})
    for (const double p : *points) {
      const LargestDifference here{file.component, file.approach, p, laser::compensation_at(file, p),
                                   laser::compensation_at(unit, p)};
      if (!any || here.difference() > largest.difference()) largest = here;
      any = true;
    }
  return largest;
}

}  // namespace

std::vector<MapDifference> differences_between(const laser::ErrorMap& expected, const laser::ErrorMap& found) {
  std::vector<MapDifference> out;
  compare_headers(expected.header, found.header, out);
  for (const laser::MapTable& table : found.tables)
    if (same_table(expected, table) == nullptr) out.push_back(of_table(table, "only in the unit"));
  for (const laser::MapTable& table : expected.tables) {
    const laser::MapTable* other = same_table(found, table);
    if (other == nullptr)
      out.push_back(of_table(table, "only in the file"));
    else
      compare_values(table, *other, out);
  }
  return out;
}

std::optional<LargestDifference> largest_difference(const laser::ErrorMap& file, const laser::ErrorMap& unit) {
  std::optional<LargestDifference> largest;
  for (const laser::MapTable& table : file.tables)
    if (const laser::MapTable* other = same_table(unit, table); other != nullptr)
      if (const auto one = largest_between(table, *other); !largest || one.difference() > largest->difference())
        largest = one;
  return largest;
}

std::vector<MapDifference> beyond_resolution(const laser::ErrorMap& file, const laser::ErrorMap& unit) {
  std::vector<MapDifference> out;
  for (const laser::MapTable& table : file.tables) {
    const laser::MapTable* other = same_table(unit, table);
    if (other == nullptr || other->position_mm == table.position_mm) continue;
    const LargestDifference at = largest_between(table, *other);
    if (at.difference() <= laser::resolution_for(other->compensation)) continue;
    out.push_back({at.component, at.approach, at.position_mm, at.expected, at.found,
                   fmt::format("{} at {:.6g} mm: the file's curve {:.2f} {}, unit {:.2f}", name_of_table(table),
                               at.position_mm, at.expected, unit_of(at.component), at.found)});
  }
  return out;
}

}  // namespace ecs::commissioning
