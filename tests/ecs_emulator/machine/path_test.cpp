#include "ecs_emulator/machine/path.hpp"

#include <numbers>

#include <rapidcheck.h>

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

constexpr double kTick_s = 0.001;
const PathLimits kLimits{{150.0, 120.0, 100.0}, {500.0, 400.0, 300.0}};

PathPiece line_to(const Vector3& to_mm, double feed_mm_min) { return {.to_mm = to_mm, .feed_mm_min = feed_mm_min}; }

PathPiece arc_to(const Vector3& to_mm, double feed_mm_min, const ArcWay& way) {
  PathPiece piece = line_to(to_mm, feed_mm_min);
  piece.arc = way;
  return piece;
}

double distance(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// What a path did, tick by tick.
struct Drive {
  std::vector<Vector3> places;
  double length_mm = 0.0;
  double fastest_mm_s = 0.0;
  Vector3 hardest_mm_s2{};  ///< per axis, from the second difference of the command
  [[nodiscard]] double time_s() const { return static_cast<double>(places.size() - 1) * kTick_s; }
};

Drive driven(const Vector3& from_mm, const std::vector<PathPiece>& pieces, const PathLimits& limits = kLimits) {
  Path path(limits);
  path.stand(from_mm);
  path.add(pieces);
  Drive drive;
  drive.places.assign(2, from_mm);
  while (!path.done() && drive.places.size() < 5'000'000) {
    path.step(kTick_s);
    drive.places.push_back(path.command_mm());
    const auto n = drive.places.size();
    drive.length_mm += distance(drive.places[n - 1], drive.places[n - 2]);
    drive.fastest_mm_s = std::max(drive.fastest_mm_s, distance(drive.places[n - 1], drive.places[n - 2]) / kTick_s);
    for (std::size_t a = 0; a < kAxes; ++a)
      drive.hardest_mm_s2[a] = std::max(
          drive.hardest_mm_s2[a],
          std::abs(drive.places[n - 1][a] - 2.0 * drive.places[n - 2][a] + drive.places[n - 3][a]) / kTick_s / kTick_s);
  }
  drive.places.push_back(path.command_mm());
  return drive;
}

rc::Gen<double> between(int low_um, int high_um) {
  return rc::gen::map(rc::gen::inRange(low_um, high_um), [](int um) { return um * 1e-3; });
}

}  // namespace

TEST_CASE("a straight line takes the time of a trapezium and ends exactly on its target") {
  const Vector3 target{-100.1, 0.0, 0.0};
  const auto drive = driven({0.0, 0.0, 0.0}, {line_to(target, 3000.0)});  // 50 mm/s, 500 mm/s²: 0.1 s up, 0.1 s down
  CHECK(drive.places.back() == target);
  CHECK(drive.time_s() == Approx(100.1 / 50.0 + 0.1).epsilon(0.005));
  CHECK(drive.fastest_mm_s == Approx(50.0));
  CHECK(drive.hardest_mm_s2[0] <= 500.0 * 1.000001);
}

TEST_CASE("the weakest axis on a line sets its rapid and its acceleration") {
  const auto drive = driven({0.0, 0.0, 0.0}, {line_to({300.0, 0.0, 300.0}, 0.0)});
  CHECK(drive.fastest_mm_s == Approx(100.0 * std::numbers::sqrt2));
  CHECK(drive.hardest_mm_s2[2] <= 300.0 * 1.000001);
  CHECK(drive.hardest_mm_s2[2] >= 290.0);
}

TEST_CASE("pieces of one line run through without stopping, and cost no time") {
  std::vector<PathPiece> pieces;
  for (int i = 1; i <= 100; ++i) pieces.push_back(line_to({i * 1.0, 0.0, 0.0}, 3000.0));
  const auto many = driven({0.0, 0.0, 0.0}, pieces);
  const auto one = driven({0.0, 0.0, 0.0}, {line_to({100.0, 0.0, 0.0}, 3000.0)});
  CHECK(many.time_s() == Approx(one.time_s()).epsilon(0.002));
  CHECK(many.hardest_mm_s2[0] <= 500.0 * 1.000001);
}

TEST_CASE("a feed is reached before the slower block begins") {
  const auto drive = driven({0.0, 0.0, 0.0}, {line_to({50.0, 0.0, 0.0}, 6000.0), line_to({60.0, 0.0, 0.0}, 600.0)});
  for (std::size_t i = 1; i < drive.places.size(); ++i)
    if (drive.places[i - 1][0] > 50.0) CHECK(drive.places[i][0] - drive.places[i - 1][0] <= 0.01 + 1e-9);
  CHECK(drive.hardest_mm_s2[0] <= 500.0 * 1.000001);
}

TEST_CASE("a right-angled corner is passed no faster than an axis can change its speed in a millisecond") {
  const auto drive = driven({0.0, 0.0, 0.0}, {line_to({50.0, 0.0, 0.0}, 3000.0), line_to({50.0, 50.0, 0.0}, 3000.0)});
  for (const Vector3& p : drive.places) CHECK((p[1] == 0.0 || p[0] == 50.0));  // never cut
  CHECK(drive.hardest_mm_s2[0] <= 2.0 * 500.0);
  CHECK(drive.hardest_mm_s2[1] <= 2.0 * 400.0);
}

TEST_CASE("an arc at any feed stays on its circle, and no axis accelerates more than it can") {
  CHECK(rc::check("full circles, any plane, sense, size and feed", [] {
    const auto plane = static_cast<emulator::Plane>(*rc::gen::inRange(0, 3));
    const double radius = *between(100, 500'000);
    const double feed = *rc::gen::inRange(1, 100) * std::max(10.0, radius);
    ArcWay way{plane, {radius, 0.0}, *rc::gen::arbitrary<bool>()};
    const auto drive = driven({0.0, 0.0, 0.0}, {arc_to({0.0, 0.0, 0.0}, feed, way)});
    const auto axes = axes_of(plane);
    for (const Vector3& p : drive.places) {
      const double off = std::hypot(p[index_of(axes[0])] - radius, p[index_of(axes[1])]) - radius;
      RC_ASSERT(std::abs(off) < 1e-9);
      RC_ASSERT(p[index_of(axes[2])] == 0.0);
    }
    RC_ASSERT(drive.places.back() == (Vector3{0.0, 0.0, 0.0}));
    RC_ASSERT(drive.fastest_mm_s <= feed / 60.0 * 1.000001);
    for (std::size_t a = 0; a < kAxes; ++a) RC_ASSERT(drive.hardest_mm_s2[a] <= kLimits.acceleration_mm_s2[a] * 1.001);
  }));
}

TEST_CASE("a line tangent to an arc goes on into it without slowing down") {
  const ArcWay quarter{emulator::Plane::XY, {50.0, 100.0}, false};
  const auto drive =
      driven({0.0, 0.0, 0.0}, {line_to({50.0, 0.0, 0.0}, 1200.0), arc_to({150.0, 100.0, 0.0}, 1200.0, quarter),
                               line_to({150.0, 150.0, 0.0}, 1200.0)});
  const double length = 100.0 + 50.0 * std::numbers::pi;
  CHECK(drive.time_s() == Approx(length / 20.0 + 0.05).epsilon(0.01));
  CHECK(drive.length_mm == Approx(length).epsilon(1e-5));
}

TEST_CASE("any chain of lines keeps feed, axes and length, and ends where it should") {
  CHECK(rc::check("random polylines", [] {
    const auto count = *rc::gen::inRange<std::size_t>(1, 40);
    const int size_um = *rc::gen::element(2, 20, 1000, 100'000);
    const double feed = *rc::gen::inRange(10, 8000) + size_um * 0.01;  // no run of hours
    std::vector<PathPiece> pieces;
    Vector3 at{};
    double length = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      Vector3 to{at[0] + *between(-size_um, size_um), at[1] + *between(-size_um, size_um),
                 at[2] + *between(-size_um, size_um)};
      length += distance(at, to);
      pieces.push_back(line_to(to, feed));
      at = to;
    }
    const auto drive = driven({0.0, 0.0, 0.0}, pieces);
    RC_ASSERT(drive.places.back() == at);
    RC_ASSERT(drive.fastest_mm_s <= feed / 60.0 * 1.000001);
    RC_ASSERT(drive.length_mm <= length + 1e-9);  // chords of corners are shorter
    for (std::size_t a = 0; a < kAxes; ++a)
      RC_ASSERT(drive.hardest_mm_s2[a] <= kLimits.acceleration_mm_s2[a] * 3.0);  // its own, and a corner at either end
  }));
}

TEST_CASE("ten thousand blocks of a micrometre are all run, none cut, at the feed") {
  std::vector<PathPiece> pieces;
  for (int i = 1; i <= 10'000; ++i) {  // a circle of 10 mm circumference as a polygon
    const double angle = i * 2.0 * std::numbers::pi / 10'000.0;
    pieces.push_back(line_to({1.5915 * std::sin(angle), 1.5915 * (1.0 - std::cos(angle)), 0.0}, 600.0));
    pieces.back().line = i;
  }
  Path path(kLimits);
  path.stand({0.0, 0.0, 0.0});
  path.add(pieces);
  int last = 0;
  int ticks = 0;
  while (!path.done()) {
    path.step(kTick_s);
    ++ticks;
    CHECK(path.line() >= last);
    CHECK(path.line() - last <= 11);  // 10 um a tick
    last = path.line();
    const double off = std::hypot(path.command_mm()[0], path.command_mm()[1] - 1.5915) - 1.5915;
    CHECK(std::abs(off) < 1e-7);  // sagitta of a micrometre on this radius
  }
  CHECK(ticks * kTick_s == Approx(1.0 + 0.025).epsilon(0.02));
  CHECK(path.command_mm() == pieces.back().to_mm);
}

TEST_CASE("pieces that are added in time are run into without stopping") {
  Path path(kLimits);
  path.stand({0.0, 0.0, 0.0});
  const auto one = line_to({10.0, 0.0, 0.0}, 3000.0);
  path.add({&one, 1});
  double slowest_mm_s = 1e9;
  bool added = false;
  while (!path.done()) {
    path.step(kTick_s);
    if (path.command_mm()[0] > 4.0 && !added) {
      const auto two = line_to({100.0, 0.0, 0.0}, 3000.0);
      path.add({&two, 1});
      added = true;
    }
    if (added && path.command_mm()[0] < 90.0) slowest_mm_s = std::min(slowest_mm_s, path.speed_mm_s());
  }
  CHECK(slowest_mm_s > 49.0);
}
