#include "model/data/path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"

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

}  // namespace ecs::model
