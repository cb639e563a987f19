#include "laser/map/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace ecs::laser {
namespace {

constexpr std::size_t kFewestPoints = 3;  ///< two show a straight line, whatever the curve does between them
constexpr double kUsualMargin = 0.05;     ///< of the travel: optics and overrun need room at either end
constexpr double kApart = 0.75;           ///< of a spacing: ends further apart differ by a point
constexpr double kApartAndRefused = 1.5;  ///< of a spacing: from here findings_for() objects
constexpr std::string_view kBeyondTheEnds = "beyond its ends a table holds its last value";

struct Span {
  double first_mm = 0.0;
  double last_mm = 0.0;
  [[nodiscard]] double length_mm() const { return last_mm - first_mm; }
};

Span span_of(const MapTable& table) { return {table.position_mm.front(), table.position_mm.back()}; }

Span around(const Span& a, const Span& b) { return {std::min(a.first_mm, b.first_mm), std::max(a.last_mm, b.last_mm)}; }

double spacing_mm(const MapTable& table) {
  return span_of(table).length_mm() / static_cast<double>(table.position_mm.size() - 1);
}

/// The two tables of a component, the same one twice where it serves both approaches.
struct Pair {
  const MapTable* forward;
  const MapTable* reverse;
  [[nodiscard]] bool one() const { return forward == reverse; }
  [[nodiscard]] Span span() const { return around(span_of(*forward), span_of(*reverse)); }
  [[nodiscard]] double spacing() const { return std::max(spacing_mm(*forward), spacing_mm(*reverse)); }
};

/// Nothing where a table is missing or a single point: findings_for() objects to both.
std::optional<Pair> tables_of(const ErrorMap& map, Component c) {
  const Pair pair{table_of(map, c, Approach::forward), table_of(map, c, Approach::reverse)};
  if (pair.forward == nullptr || pair.reverse == nullptr) return std::nullopt;
  if (pair.forward->position_mm.size() < 2 || pair.reverse->position_mm.size() < 2) return std::nullopt;
  return pair;
}

/// What all tables of an axis that are used cover together.
std::optional<Span> covered_along(const ErrorMap& map, const ComponentSet& needed, Axis axis) {
  std::optional<Span> all;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto c = static_cast<Component>(i);
    if (!needed.contains(c) || moving_axis(c) != axis) continue;
    if (const auto pair = tables_of(map, c)) all = all ? around(*all, pair->span()) : pair->span();
  }
  return all;
}

void warn_of_travel(Component c, const Pair& pair, const Span& travel, bool of_machine,
                    std::vector<MapFinding>& findings) {
  const Span span = pair.span();
  const double beyond_mm = std::max(travel.first_mm - span.first_mm, span.last_mm - travel.last_mm);
  if (of_machine && beyond_mm > kUsualMargin * travel.length_mm()) {
    findings.push_back({false, fmt::format("{} was measured from {:.6g} to {:.6g} mm, but {} travels from {:.6g} to "
                                           "{:.6g} mm: are file and machine of the same machine?",
                                           name_of(c), span.first_mm, span.last_mm, letter_of(moving_axis(c)),
                                           travel.first_mm, travel.last_mm)});
    return;
  }
  const double margin_mm = std::max(pair.spacing(), kUsualMargin * travel.length_mm()) * (1.0 + 1e-9);
  if (span.first_mm - travel.first_mm <= margin_mm && travel.last_mm - span.last_mm <= margin_mm) return;
  const double covered_mm =
      std::max(0.0, std::min(span.last_mm, travel.last_mm) - std::max(span.first_mm, travel.first_mm));
  const char axis = letter_of(moving_axis(c));
  findings.push_back({false, fmt::format("{} covers {:.6g} of {:.6g} mm of {} ({:.6g} to {:.6g}): {}", name_of(c),
                                         covered_mm, travel.length_mm(),
                                         of_machine ? fmt::format("the travel of {}", axis)
                                                    : fmt::format("what the tables of {} cover together", axis),
                                         travel.first_mm, travel.last_mm, kBeyondTheEnds)});
}

void warn_of_uneven_ends(Component c, const Pair& pair, std::vector<MapFinding>& findings) {
  if (pair.one()) return;
  const Span forward = span_of(*pair.forward);
  const Span reverse = span_of(*pair.reverse);
  const double apart_mm =
      std::max(std::abs(forward.first_mm - reverse.first_mm), std::abs(forward.last_mm - reverse.last_mm));
  const double spacing = std::min(spacing_mm(*pair.forward), spacing_mm(*pair.reverse));
  const double refused_mm = kApartAndRefused * (pair.forward->position_mm[1] - pair.forward->position_mm[0]);
  if (apart_mm <= kApart * spacing || apart_mm > refused_mm) return;
  findings.push_back({false, fmt::format("{}: forward is measured from {:.6g} to {:.6g} mm only, reverse from {:.6g} "
                                         "to {:.6g} mm: {}",
                                         name_of(c), forward.first_mm, forward.last_mm, reverse.first_mm,
                                         reverse.last_mm, kBeyondTheEnds)});
}

void warn_of_few_points(Component c, const Pair& pair, std::vector<MapFinding>& findings) {
  const std::size_t forward = pair.forward->position_mm.size();
  const std::size_t reverse = pair.reverse->position_mm.size();
  if (std::min(forward, reverse) >= kFewestPoints) return;
  const std::string points = pair.one() ? fmt::format("{} points", forward)
                                        : fmt::format("{} points forward, {} in reverse", forward, reverse);
  findings.push_back(
      {false, fmt::format("{} has {}: fewer than {} do not show how the error runs; measure more targets", name_of(c),
                          points, kFewestPoints)});
}

}  // namespace

std::vector<MapFinding> coverage_warnings(const ErrorMap& map, const UnitParameters& parameters,
                                          const Travels& travels) {
  std::vector<MapFinding> findings;
  const ComponentSet needed = components_needed(parameters);
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto c = static_cast<Component>(i);
    if (!needed.contains(c)) continue;
    const auto pair = tables_of(map, c);
    if (!pair) continue;
    const auto& travel = travels[index_of(moving_axis(c))];
    const auto all = travel ? Span{(*travel)[0], (*travel)[1]} : covered_along(map, needed, moving_axis(c)).value();
    warn_of_travel(c, *pair, all, travel.has_value(), findings);
    warn_of_uneven_ends(c, *pair, findings);
    warn_of_few_points(c, *pair, findings);
  }
  return findings;
}

std::vector<std::string> missing_in(const MapHeader& header) {
  std::vector<std::string> missing;
  const std::array<std::pair<const char*, const std::string*>, 5> fields{{{"customer", &header.customer},
                                                                          {"machine", &header.machine},
                                                                          {"serial number", &header.serial_number},
                                                                          {"engineer", &header.engineer},
                                                                          {"date", &header.date}}};
  for (const auto& [name, value] : fields)
    if (value->empty()) missing.emplace_back(name);
  return missing;
}

}  // namespace ecs::laser
