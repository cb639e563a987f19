#include "model/data/path_sets.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/text.hpp"
#include "model/data/path.hpp"

namespace ecs::model {
namespace {

using laser::MeasurementSet;
using laser::Reading;

constexpr double kRad_of_deg = std::numbers::pi / 180.0;

char small_letter(Axis axis) { return static_cast<char>(std::tolower(letter_of(axis))); }

/// What a file says of machine and instrument; the rest is about the test alone.
std::vector<laser::MetadataEntry> about_machine(const std::vector<laser::MetadataEntry>& all) {
  constexpr std::string_view kAbout[] = {"machine",    "serial_number", "Machine", "Serial No",
                                         "instrument", "date",          "operator"};
  std::vector<laser::MetadataEntry> kept;
  for (const laser::MetadataEntry& entry : all)
    if (std::find(std::begin(kAbout), std::end(kAbout), entry.key) != std::end(kAbout)) kept.push_back(entry);
  return kept;
}

std::optional<double> number_named(const std::vector<laser::MetadataEntry>& metadata, const std::string& key) {
  for (const laser::MetadataEntry& entry : metadata)
    if (entry.key == key) return number_in(entry.value);
  return std::nullopt;
}

}  // namespace

MeasurementSet set_of_circle(const laser::CircleTest& test) {
  MeasurementSet set;
  set.source = test.source;
  set.metadata = about_machine(test.metadata);
  Path path;
  path.kind = PathKind::circle;
  path.name = laser::plane_name(test.plane);
  path.plane = test.plane;
  path.radius_mm = test.radius_mm;
  std::string unknown;
  for (std::size_t i = 0; i < test.plane.size(); ++i) {
    path.from_mm[index_of(test.plane[i])] = test.centre_mm[i].value_or(0.0);
    if (!test.centre_mm[i])
      unknown += fmt::format("{}centre_{}_mm", unknown.empty() ? "" : " and ", small_letter(test.plane[i]));
  }
  for (const Axis axis : kAllAxes)
    if (axis != test.plane[0] && axis != test.plane[1])
      path.from_mm[index_of(axis)] =
          number_named(test.metadata, fmt::format("centre_{}_mm", small_letter(axis))).value_or(0.0);
  if (!unknown.empty())
    set.notes.push_back(fmt::format("no {}: positions count from the centre of the circle", unknown));
  const std::string text = to_text(path);
  const std::size_t u = index_of(test.plane[0]), v = index_of(test.plane[1]);
  for (const laser::CircleReading& one : test.readings) {
    Reading reading;
    reading.line = one.line;
    reading.axis = test.plane[0];
    reading.sense = static_cast<Sense>(u);
    reading.position_mm = path.from_mm;
    reading.position_mm[u] += test.radius_mm * std::cos(one.angle_deg * kRad_of_deg);
    reading.position_mm[v] += test.radius_mm * std::sin(one.angle_deg * kRad_of_deg);
    reading.error = one.deviation_um;
    reading.approach = one.clockwise ? Approach::reverse : Approach::forward;
    reading.run = one.run;
    reading.feed_mm_min = test.feed_mm_min;
    reading.text_extras[std::string(kPathColumn)] = text;
    set.readings.push_back(std::move(reading));
  }
  return set;
}

Result<MeasurementSet> set_of_diagonals(const laser::DiagonalTest& test) {
  if (test.steps)
    return tl::unexpected(Problem{ProblemKind::bad_input,
                                  "kind: expected diagonal, found step: readings between the steps lie beside the "
                                  "diagonal and are not told apart from a tilted beam (docs/standards_tests.md)",
                                  test.source,
                                  0,
                                  0,
                                  {}});
  MeasurementSet set;
  set.source = test.source;
  set.metadata = about_machine(test.metadata);
  Vector3 least_mm{};
  std::string unknown;
  for (const Axis axis : kAllAxes) {
    const std::string key = fmt::format("from_{}_mm", small_letter(axis));
    const auto from_mm = number_named(test.metadata, key);
    least_mm[index_of(axis)] = from_mm.value_or(0.0);
    if (!from_mm && test.span_mm[index_of(axis)] > 0.0) unknown += (unknown.empty() ? "" : ", ") + key;
  }
  if (!unknown.empty())
    set.notes.push_back(
        fmt::format("no {}: the corner of the volume with the least coordinates is taken to be at 0 "
                    "there",
                    unknown));
  for (const laser::DiagonalReadings& diagonal : test.diagonals) {
    Path path;
    path.kind = PathKind::line;
    path.name = diagonal.name;
    path.from_mm = path.to_mm = least_mm;
    double square = 0.0;
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (diagonal.direction[i] == 0) continue;
      (diagonal.direction[i] > 0 ? path.to_mm : path.from_mm)[i] += test.span_mm[i];
      square += test.span_mm[i] * test.span_mm[i];
    }
    const std::string text = to_text(path);
    const auto first = static_cast<std::size_t>(
        std::find_if(diagonal.direction.begin(), diagonal.direction.end(), [](int sign) { return sign != 0; }) -
        diagonal.direction.begin());
    for (Reading reading : diagonal.readings.readings) {
      const double share = reading.position_mm[0] / std::sqrt(square);
      for (std::size_t i = 0; i < kAxes; ++i) reading.position_mm[i] = std::lerp(path.from_mm[i], path.to_mm[i], share);
      reading.axis = kAllAxes[first];
      reading.sense = static_cast<Sense>(first);
      reading.text_extras[std::string(kPathColumn)] = text;
      set.readings.push_back(std::move(reading));
    }
  }
  return set;
}

}  // namespace ecs::model
