#include "model/data/path.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/circle_test.hpp"
#include "laser/measurement_set.hpp"
#include "laser/standards/diagonals.hpp"
#include "laser/standards/gauge_blocks.hpp"

namespace ecs::model {
namespace {

constexpr double kFullCircle_deg = 360.0, kDeg_per_rad = 180.0 / std::numbers::pi;
/// An axis slower than this share of the speed along the path stands still: it is at its reversal, or parked.
constexpr double kStill = 1e-9;
/// Travel since a reversal, in radii, up to which it is given.
constexpr double kNearReversal = 0.1;
constexpr std::size_t kWordsOfCircle = 8, kWordsOfLine = 10;

/// The words from `first` on as a point; nothing where one is no number.
std::optional<Vector3> point_in(const std::vector<std::string_view>& words, std::size_t first) {
  Vector3 point{};
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto value = number_in(words[first + i]);
    if (!value) return std::nullopt;
    point[i] = *value;
  }
  return point;
}

std::optional<Path> circle_in(const std::vector<std::string_view>& words) {
  if (words.size() != kWordsOfCircle || words[1].size() != 2 || words[2] != "radius" || words[4] != "centre")
    return std::nullopt;
  const auto first = axis_of(words[1][0]), second = axis_of(words[1][1]);
  const auto radius_mm = number_in(words[3]);
  const auto centre_mm = point_in(words, 5);
  if (!first || !second || *first == *second || !radius_mm || *radius_mm <= 0.0 || !centre_mm) return std::nullopt;
  return Path{PathKind::circle, std::string(words[1]), {*first, *second}, *radius_mm, *centre_mm, {}};
}

std::optional<Path> line_in(const std::vector<std::string_view>& words) {
  if (words.size() != kWordsOfLine || words[2] != "from" || words[6] != "to") return std::nullopt;
  const auto from_mm = point_in(words, 3), to_mm = point_in(words, 7);
  if (!from_mm || !to_mm || *from_mm == *to_mm) return std::nullopt;
  return Path{PathKind::line, std::string(words[1]), {}, 0.0, *from_mm, *to_mm};
}

PlaceOnPath place_on_circle(const Path& path, const Vector3& position_mm, int approach) {
  PlaceOnPath place;
  const std::size_t u = index_of(path.plane[0]), v = index_of(path.plane[1]);
  const double angle = std::atan2(position_mm[v] - path.from_mm[v], position_mm[u] - path.from_mm[u]);
  const double cosine = std::cos(angle), sine = std::sin(angle);
  place.along = angle * kDeg_per_rad;
  if (place.along < 0.0) place.along += kFullCircle_deg;
  place.direction[u] = cosine;
  place.direction[v] = sine;
  if (approach == 0) return place;
  const auto take = [&](std::size_t axis, double speed, double acceleration, double along_axis) {
    // at its reversal an axis still has the approach with which it arrived there
    const double moving = std::abs(speed) > kStill ? speed : -acceleration;
    place.approach[axis] = moving > 0.0 ? 1 : -1;
    place.share_of_feed[axis] = std::abs(speed);
    // it turned round at the end from which it comes
    const double turned = std::abs(speed) > kStill ? 1.0 + place.approach[axis] * along_axis : 2.0;
    if (turned > kNearReversal) return;
    place.since_reversal_mm[axis] = path.radius_mm * turned;
    place.path_since_reversal_mm[axis] = path.radius_mm * std::acos(1.0 - std::max(turned, 0.0));
  };
  take(u, -approach * sine, -cosine, cosine);
  take(v, approach * cosine, -sine, sine);
  return place;
}

PlaceOnPath place_on_line(const Path& path, const Vector3& position_mm, int approach) {
  PlaceOnPath place;
  double square = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i) square += std::pow(path.to_mm[i] - path.from_mm[i], 2);
  for (std::size_t i = 0; i < kAxes; ++i) {
    place.direction[i] = (path.to_mm[i] - path.from_mm[i]) / std::sqrt(square);
    place.along += place.direction[i] * (position_mm[i] - path.from_mm[i]);
    place.share_of_feed[i] = std::abs(place.direction[i]);
    if (place.share_of_feed[i] > kStill) place.approach[i] = place.direction[i] > 0.0 ? approach : -approach;
  }
  return place;
}

}  // namespace

std::optional<Path> path_in(std::string_view text) {
  std::vector<std::string_view> words;
  for (const std::string_view word : split(text, ' '))
    if (!word.empty()) words.push_back(word);
  if (words.empty()) return std::nullopt;
  if (words.front() == "circle") return circle_in(words);
  if (words.front() == "diagonal") return line_in(words);
  return std::nullopt;
}

std::string to_text(const Path& path) {
  const auto point = [](const Vector3& p) {
    return fmt::format("{} {} {}", shortest(p[0]), shortest(p[1]), shortest(p[2]));
  };
  if (path.kind == PathKind::circle)
    return fmt::format("{} radius {} centre {}", name_of(path), shortest(path.radius_mm), point(path.from_mm));
  return fmt::format("{} from {} to {}", name_of(path), point(path.from_mm), point(path.to_mm));
}

std::string name_of(const Path& path) { return (path.kind == PathKind::circle ? "circle " : "diagonal ") + path.name; }

PlaceOnPath place_on(const Path& path, const Vector3& position_mm, int approach) {
  return path.kind == PathKind::circle ? place_on_circle(path, position_mm, approach)
                                       : place_on_line(path, position_mm, approach);
}

std::string_view variable_along(const Path& path) {
  return path.kind == PathKind::circle ? "angle_deg" : "position_mm";
}

std::string axes_of(const Path& path) {
  if (path.kind == PathKind::circle) return path.name;
  std::string axes;
  for (const Axis a : kAllAxes)
    if (path.from_mm[index_of(a)] != path.to_mm[index_of(a)]) axes += letter_of(a);
  return axes;
}

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
  const bool in_parts = std::ranges::any_of(test.readings, [](const auto& one) { return one.part != 1; });
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
    if (in_parts) reading.extras[std::string(kPartColumn)] = one.part;
    set.readings.push_back(std::move(reading));
  }
  return set;
}

Result<MeasurementSet> set_of_diagonals(const laser::DiagonalTest& test) {
  if (test.steps)
    return problem_at(test.source, 0, 0,
                      "kind: expected diagonal, found step: readings between the steps lie off the diagonal and cannot "
                      "be distinguished from a tilted beam (modules/standards/README.md)");
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
    set.notes.push_back(fmt::format(
        "no {}: the corner of the volume with the smallest coordinates is assumed to be at 0 there", unknown));
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
        std::ranges::find_if(diagonal.direction, [](int sign) { return sign != 0; }) - diagonal.direction.begin());
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

MeasurementSet set_of_blocks(const laser::BlockTest& test) {
  MeasurementSet set;
  set.source = test.source;
  set.metadata = about_machine(test.metadata);
  const std::size_t i = index_of(test.axis);
  bool unknown = false;
  for (const laser::BlockReading& one : test.readings) {
    Path path{PathKind::line, fmt::format("{:g}", one.nominal_mm), {}, 0.0, {}, {}};
    path.from_mm[i] = one.from_mm.value_or(0.0);
    path.to_mm[i] = path.from_mm[i] + one.nominal_mm;
    unknown = unknown || !one.from_mm;
    Reading face;
    face.line = one.line;
    face.axis = test.axis;
    face.sense = static_cast<Sense>(i);
    face.run = static_cast<int>(set.readings.size() / 2) + 1;
    face.text_extras[std::string(kPathColumn)] = to_text(path);
    const auto add = [&](const Vector3& position_mm, double error_um, bool forward) {
      face.position_mm = position_mm;
      face.error = error_um;
      face.approach = forward ? Approach::forward : Approach::reverse;
      face.extras[std::string(kTouchColumn)] = forward ? 1.0 : -1.0;
      set.readings.push_back(face);
    };
    add(path.from_mm, 0.0, one.touch != laser::Touch::inside);
    add(path.to_mm, laser::error_um_of(test, one), one.touch != laser::Touch::outside);
  }
  set.notes.emplace_back(
      "lost motion of these lengths contains the size error of the tool or probe: a map needs it from a line "
      "(modules/standards/README.md)");
  if (unknown) set.notes.emplace_back("no from_mm: the blocks are assumed to begin at 0");
  return set;
}

}  // namespace ecs::model
