#include "ecs_emulator/machine/path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ecs::emulator {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kSamePoint_mm = 1e-6;

}  // namespace

double Arc::length_mm() const { return 0.5 * (start_radius_mm + end_radius_mm) * std::abs(sweep_rad); }

void Arc::place(double part, Vector3& point_mm) const {
  const auto axes = axes_of(way.plane);
  const double angle_rad = start_rad + sweep_rad * part;
  const double radius_mm = start_radius_mm + (end_radius_mm - start_radius_mm) * part;
  point_mm[index_of(axes[0])] = way.centre_mm[0] + radius_mm * std::cos(angle_rad);
  point_mm[index_of(axes[1])] = way.centre_mm[1] + radius_mm * std::sin(angle_rad);
}

Vector3 Arc::direction(double part) const {
  const auto axes = axes_of(way.plane);
  const double angle_rad = start_rad + sweep_rad * part;
  const double onward = sweep_rad > 0.0 ? 1.0 : -1.0;
  Vector3 unit{};
  unit[index_of(axes[0])] = -onward * std::sin(angle_rad);
  unit[index_of(axes[1])] = onward * std::cos(angle_rad);
  return unit;
}

std::array<double, 2> Arc::range_mm(std::size_t of_plane) const {
  const std::size_t axis = index_of(axes_of(way.plane)[of_plane]);
  Vector3 start{}, end{};
  place(0.0, start);
  place(1.0, end);
  std::array<double, 2> range{std::min(start[axis], end[axis]), std::max(start[axis], end[axis])};
  const double radius_mm = std::max(start_radius_mm, end_radius_mm);
  const double low_rad = std::min(start_rad, start_rad + sweep_rad);
  const double high_rad = std::max(start_rad, start_rad + sweep_rad);
  const auto passes = [&](double angle_rad) {
    return angle_rad + kTurn_rad * std::ceil((low_rad - angle_rad) / kTurn_rad) <= high_rad;
  };
  const double top_rad = of_plane == 0 ? 0.0 : 0.5 * std::numbers::pi;
  if (passes(top_rad)) range[1] = std::max(range[1], way.centre_mm[of_plane] + radius_mm);
  if (passes(top_rad + std::numbers::pi)) range[0] = std::min(range[0], way.centre_mm[of_plane] - radius_mm);
  return range;
}

Arc arc_between(const Vector3& from_mm, const Vector3& to_mm, const ArcWay& way) {
  const auto axes = axes_of(way.plane);
  const std::size_t u = index_of(axes[0]);
  const std::size_t v = index_of(axes[1]);
  const std::array<double, 2> start{from_mm[u] - way.centre_mm[0], from_mm[v] - way.centre_mm[1]};
  const std::array<double, 2> end{to_mm[u] - way.centre_mm[0], to_mm[v] - way.centre_mm[1]};
  Arc arc{way, std::hypot(start[0], start[1]), std::hypot(end[0], end[1]), std::atan2(start[1], start[0]), 0.0};
  const double onward = way.clockwise ? -1.0 : 1.0;
  double sweep_rad = onward * (std::atan2(end[1], end[0]) - arc.start_rad);
  if (sweep_rad < 0.0) sweep_rad += kTurn_rad;
  if (std::hypot(to_mm[u] - from_mm[u], to_mm[v] - from_mm[v]) < kSamePoint_mm) sweep_rad = kTurn_rad;
  arc.sweep_rad = onward * sweep_rad;
  return arc;
}

namespace {

constexpr double kThere_mm = 1e-6;  ///< what is left of a path below this is no distance
constexpr double kCentripetal = 0.8;
constexpr double kAlongArc = 0.6;  ///< 0.8² + 0.6² = 1

/// The fastest that still can be braked for: after one period at this speed, constant braking at `a` reaches `end` at
/// the end of `left_mm`. v² + 2aTv = end² + 2a·left, solved without loss of digits.
double braking_mm_s(double left_mm, double end_mm_s, double a, double period_s) {
  const double square = end_mm_s * end_mm_s + 2.0 * a * left_mm;
  const double step = a * period_s;
  return square / (step + std::sqrt(step * step + square));
}

}  // namespace

void Path::stand(const Vector3& place_mm) {
  pieces_.clear();
  head_ = 0;
  done_mm_ = speed_mm_s_ = 0.0;
  command_mm_ = place_mm;
}

void Path::limit_line(Planned& piece) const {
  double square = 0.0;
  for (std::size_t a = 0; a < kAxes; ++a) {
    piece.enters[a] = piece.to_mm[a] - piece.from_mm[a];
    square += piece.enters[a] * piece.enters[a];
  }
  piece.length_mm = std::sqrt(square);
  if (piece.length_mm == 0.0) return;
  piece.speed_mm_s = piece.acceleration_mm_s2 = std::numeric_limits<double>::max();
  for (std::size_t a = 0; a < kAxes; ++a) {
    piece.enters[a] /= piece.length_mm;
    const double part = std::abs(piece.enters[a]);
    if (part == 0.0) continue;
    piece.speed_mm_s = std::min(piece.speed_mm_s, limits_.rapid_mm_s[a] / part);
    piece.acceleration_mm_s2 = std::min(piece.acceleration_mm_s2, limits_.acceleration_mm_s2[a] / part);
  }
  piece.leaves = piece.enters;
}

void Path::limit_arc(Planned& piece) const {
  const Arc& arc = *piece.arc;
  const auto axes = axes_of(arc.way.plane);
  const std::size_t u = index_of(axes[0]);
  const std::size_t v = index_of(axes[1]);
  const double most_mm_s2 = std::min(limits_.acceleration_mm_s2[u], limits_.acceleration_mm_s2[v]);
  const double radius_mm = std::min(arc.start_radius_mm, arc.end_radius_mm);
  piece.length_mm = arc.length_mm();
  piece.enters = arc.direction(0.0);
  piece.leaves = arc.direction(1.0);
  piece.acceleration_mm_s2 = kAlongArc * most_mm_s2;
  piece.speed_mm_s =
      std::min({limits_.rapid_mm_s[u], limits_.rapid_mm_s[v], std::sqrt(kCentripetal * most_mm_s2 * radius_mm)});
}

Path::Planned Path::planned(const PathPiece& piece, const Vector3& from_mm) const {
  Planned planned;
  planned.from_mm = from_mm;
  planned.to_mm = piece.to_mm;
  planned.line = piece.line;
  if (piece.arc) {
    planned.arc = arc_between(from_mm, piece.to_mm, *piece.arc);
    limit_arc(planned);
  } else {
    limit_line(planned);
  }
  if (piece.feed_mm_min > 0.0) planned.speed_mm_s = std::min(planned.speed_mm_s, piece.feed_mm_min / 60.0);
  return planned;
}

double Path::corner_mm_s(const Planned& before, const Planned& after) const {
  double speed = std::min(before.speed_mm_s, after.speed_mm_s);
  const double shorter_mm = std::min(before.length_mm, after.length_mm);
  for (std::size_t a = 0; a < kAxes; ++a) {
    const double turn = std::abs(after.enters[a] - before.leaves[a]);
    const double most = limits_.acceleration_mm_s2[a];
    if (turn * speed > most * kCorner_s) speed = most * kCorner_s / turn;
    if (turn * speed * speed > most * shorter_mm) speed = std::sqrt(most * shorter_mm / turn);
  }
  return speed;
}

void Path::plan() {
  double end_mm_s = 0.0;
  for (std::size_t i = pieces_.size(); i-- > head_;) {
    Planned& piece = pieces_[i];
    piece.end_speed_mm_s = i + 1 == pieces_.size() ? 0.0 : std::min(end_mm_s, corner_mm_s(piece, pieces_[i + 1]));
    end_mm_s =
        std::sqrt(piece.end_speed_mm_s * piece.end_speed_mm_s + 2.0 * piece.acceleration_mm_s2 * piece.length_mm);
  }
}

void Path::add(std::span<const PathPiece> pieces) {
  pieces_.erase(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(head_));
  head_ = 0;
  for (const PathPiece& piece : pieces) {
    Planned next = planned(piece, pieces_.empty() ? command_mm_ : pieces_.back().to_mm);
    if (next.length_mm > 0.0) pieces_.push_back(next);
  }
  plan();
}

double Path::next_speed_mm_s(double period_s) const {
  double speed = speed_mm_s_ + pieces_[head_].acceleration_mm_s2 * period_s;
  double ahead_mm = -done_mm_;
  for (std::size_t i = head_; i < pieces_.size(); ++i) {
    const Planned& piece = pieces_[i];
    ahead_mm += piece.length_mm;
    speed = std::min(speed, piece.speed_mm_s);
    const double end = piece.end_speed_mm_s;
    if (end < speed)
      speed = std::min(speed, std::max(end, braking_mm_s(ahead_mm, end, piece.acceleration_mm_s2, period_s)));
    if (speed * period_s <= ahead_mm) break;
  }
  return speed;
}

void Path::step(double period_s) {
  if (done()) return;
  speed_mm_s_ = next_speed_mm_s(period_s);
  done_mm_ += speed_mm_s_ * period_s;
  while (!done() && done_mm_ >= pieces_[head_].length_mm) done_mm_ -= pieces_[head_++].length_mm;
  if (pieces_left() == 1 && pieces_[head_].length_mm - done_mm_ < kThere_mm) ++head_;
  line_ = pieces_[done() ? head_ - 1 : head_].line;
  if (done()) {
    stand(Vector3(pieces_.back().to_mm));
    return;
  }
  const Planned& piece = pieces_[head_];
  const double part = done_mm_ / piece.length_mm;
  if (piece.arc) {
    command_mm_ = piece.from_mm;
    piece.arc->place(part, command_mm_);
  } else {
    for (std::size_t a = 0; a < kAxes; ++a) command_mm_[a] = std::lerp(piece.from_mm[a], piece.to_mm[a], part);
  }
}

}  // namespace ecs::emulator
