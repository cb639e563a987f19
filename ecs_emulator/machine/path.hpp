// The path of the tool as a control interpolates it: straight lines and arcs, run through without stopping where
// corners and accelerations allow. Pure kinematics. Does not live here: the drives that follow (machine_tool.hpp),
// the words of a part program (ecs_emulator/part_programs/reader.hpp).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/axis.hpp"

namespace ecs::emulator {

/// Plane of an arc. Its first and second axis: X Y, Z X, Y Z; counter-clockwise turns the first towards the second
/// (ISO 6983: seen from the positive end of the third axis).
enum class Plane : std::uint8_t { XY, ZX, YZ };

[[nodiscard]] constexpr std::array<Axis, 3> axes_of(Plane plane) {
  if (plane == Plane::ZX) return {Axis::Z, Axis::X, Axis::Y};
  if (plane == Plane::YZ) return {Axis::Y, Axis::Z, Axis::X};
  return {Axis::X, Axis::Y, Axis::Z};
}

/// How to go round, from one point of the plane to another.
struct ArcWay {
  Plane plane = Plane::XY;
  std::array<double, 2> centre_mm{};  ///< along the first and the second axis of the plane
  bool clockwise = false;
};

/// An arc of which everything is known. Where the two radii differ, it winds evenly from the one to the other.
struct Arc {
  ArcWay way{};
  double start_radius_mm = 0.0;
  double end_radius_mm = 0.0;
  double start_rad = 0.0;  ///< from the first axis of the plane towards the second
  double sweep_rad = 0.0;  ///< positive: counter-clockwise; never 0

  [[nodiscard]] double length_mm() const;
  /// Puts the point at `part` of the sweep (0 to 1) into the two coordinates of the plane.
  void place(double part, Vector3& point_mm) const;
  /// Unit vector along the arc.
  [[nodiscard]] Vector3 direction(double part) const;
  /// Lowest and highest coordinate along one axis of the plane (0: its first, 1: its second).
  [[nodiscard]] std::array<double, 2> range_mm(std::size_t of_plane) const;
};

/// Ends less than a nanometre apart make a full circle.
/// @pre  neither end lies on the centre
[[nodiscard]] Arc arc_between(const Vector3& from_mm, const Vector3& to_mm, const ArcWay& way);

/// What each axis can do.
struct PathLimits {
  Vector3 rapid_mm_s{};
  Vector3 acceleration_mm_s2{};
};

/// One piece of a path; it begins where the one before it ends.
struct PathPiece {
  Vector3 to_mm{};
  double feed_mm_min = 0.0;   ///< along the path; 0: rapid
  std::optional<ArcWay> arc;  ///< absent: a straight line
  int line = 0;               ///< of the part program that asked for it
};

/// An axis may change its speed at a corner by what its acceleration does in this time (the period of an
/// interpolator); where pieces are shorter than that, by what it does in the time that the shorter one takes.
inline constexpr double kCorner_s = 0.001;

/// Every axis stays below its own rapid and acceleration. On an arc the centripetal acceleration gets 0.8 of what the
/// weaker axis can, the one along the path 0.6, so that together they are never more. The path ends standing, exactly
/// on its last target; whoever wants it to go on through adds the next pieces in time.
class Path {
 public:
  explicit Path(const PathLimits& limits) : limits_(limits) {}

  /// Forgets everything that is left and stands at `place_mm`.
  void stand(const Vector3& place_mm);
  /// Appends pieces (those without length are left out) and plans the speeds again.
  void add(std::span<const PathPiece> pieces);
  /// One period further.
  void step(double period_s);

  [[nodiscard]] bool done() const { return head_ == pieces_.size(); }
  [[nodiscard]] std::size_t pieces_left() const { return pieces_.size() - head_; }
  [[nodiscard]] const Vector3& command_mm() const { return command_mm_; }
  /// The speed that the present piece aims at: its feed, less where the axes or the radius forbid it. 0: done.
  [[nodiscard]] double feed_mm_min() const { return done() ? 0.0 : pieces_[head_].speed_mm_s * 60.0; }
  [[nodiscard]] double speed_mm_s() const { return speed_mm_s_; }
  [[nodiscard]] int line() const { return line_; }

 private:
  struct Planned {
    Vector3 from_mm{};
    Vector3 to_mm{};
    std::optional<Arc> arc;
    Vector3 enters{};  ///< unit vector along the path at its start
    Vector3 leaves{};
    double length_mm = 0.0;
    double speed_mm_s = 0.0;
    double acceleration_mm_s2 = 0.0;
    double end_speed_mm_s = 0.0;  ///< at most, so that all that follows can be braked for
    int line = 0;
  };

  [[nodiscard]] Planned planned(const PathPiece& piece, const Vector3& from_mm) const;
  void limit_line(Planned& piece) const;
  void limit_arc(Planned& piece) const;
  [[nodiscard]] double corner_mm_s(const Planned& before, const Planned& after) const;
  void plan();
  [[nodiscard]] double next_speed_mm_s(double period_s) const;

  PathLimits limits_;
  std::vector<Planned> pieces_;
  std::size_t head_ = 0;
  double done_mm_ = 0.0;  ///< of the piece at the head
  double speed_mm_s_ = 0.0;
  Vector3 command_mm_{};
  int line_ = 0;
};

}  // namespace ecs::emulator
