#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/units.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "ecs_emulator/workshop/procedures.hpp"

namespace ecs::emulator {
namespace {

constexpr double kRad_per_deg = std::numbers::pi / 180.0;
/// Lines of the program before the first motion, and of each run: counter-clockwise and back.
constexpr int kHeadLines = 2;
constexpr int kRunLines = 8;

/// The point of the circle at an angle.
Vector3 circle_point(const CirclePlan& plan, double angle_deg) {
  Vector3 point = plan.centre_mm;
  point[index_of(plan.plane[0])] += plan.radius_mm * std::cos(angle_deg * kRad_per_deg);
  point[index_of(plan.plane[1])] += plan.radius_mm * std::sin(angle_deg * kRad_per_deg);
  return point;
}

std::string place_words(const CirclePlan& plan, double angle_deg) {
  const Vector3 point = circle_point(plan, angle_deg);
  return fmt::format("{}{:.9f}{}{:.9f}", letter_of(plan.plane[0]), point[index_of(plan.plane[0])],
                     letter_of(plan.plane[1]), point[index_of(plan.plane[1])]);
}

/// The centre from the start of an arc, as I, J, K.
std::string centre_words(const CirclePlan& plan, double from_deg) {
  constexpr char kLetters[] = {'I', 'J', 'K'};
  const Vector3 from = circle_point(plan, from_deg);
  std::string words;
  for (const Axis axis : plan.plane)
    words += fmt::format("{}{:.9f}", kLetters[index_of(axis)], plan.centre_mm[index_of(axis)] - from[index_of(axis)]);
  return words;
}

/// G17 XY, G18 ZX, G19 YZ; in the other order of the axes the angle falls where the control turns counter-clockwise.
struct ProgramPlane {
  int word = 17;
  bool turned = false;
};
ProgramPlane program_plane(const std::array<Axis, 2>& plane) {
  const std::size_t first = index_of(plane[0]), second = index_of(plane[1]), third = 3 - first - second;
  constexpr int kWords[] = {19, 18, 17};  // by the axis that the plane lacks
  return {kWords[third], (first + 1) % 3 != second};
}

std::string arc(const CirclePlan& plan, double from_deg, double to_deg) {
  const bool rises = to_deg > from_deg;
  return fmt::format("G0{}{}{}\n", rises != program_plane(plan.plane).turned ? 3 : 2, place_words(plan, to_deg),
                     centre_words(plan, from_deg));
}

Result<void> checked_plan(const CirclePlan& plan) {
  const auto wrong = [](const char* what) { return problem(ProblemKind::usage, what); };
  if (plan.plane[0] == plan.plane[1]) return wrong("plane: expected two axes");
  if (!(plan.radius_mm > 0.0)) return wrong("radius: expected above 0 mm");
  if (!(plan.feed_mm_min >= kSlowestFeed_mm_min)) return wrong("feed: expected 1 mm/min or more");
  if (!(plan.step_deg > 0.0 && plan.step_deg <= 15.0)) return wrong("step: expected above 0 and at most 15 degrees");
  if (!(plan.overlap_deg > 0.0 && plan.overlap_deg <= 180.0)) return wrong("overlap: expected 1 to 180 degrees");
  if (plan.runs < 1) return wrong("runs: expected 1 or more");
  if (!(plan.noise_um >= 0.0)) return wrong("noise: expected 0 um or more");
  return {};
}

/// Reads the bar whenever the commanded angle has gone a step further.
class BallBar {
 public:
  BallBar(Simulation& simulation, const CirclePlan& plan, laser::CircleTest& test)
      : simulation_(simulation), plan_(plan), test_(test) {}

  /// After every tick.
  void watch() {
    const int line = simulation_.machine().path().line() - kHeadLines - 1;
    const int block = line < 0 ? -1 : line % kRunLines;
    const bool turning = block == kCounterClockwise || block == kClockwise;
    if (turning && line != line_) travelled_deg_ = next_deg_ = 0.0;
    const Vector3& command_mm = simulation_.machine().command_mm();
    const double angle_deg = angle_of(command_mm);
    if (turning) {
      travelled_deg_ += line == line_ ? std::abs(std::remainder(angle_deg - angle_deg_, 360.0)) : 0.0;
      if (travelled_deg_ >= next_deg_ && next_deg_ < 360.0) {
        next_deg_ += plan_.step_deg;
        read(command_mm, block == kClockwise, line / kRunLines + 1);
      }
    }
    line_ = line;
    angle_deg_ = angle_deg;
  }

 private:
  static constexpr int kCounterClockwise = 2, kClockwise = 5;  ///< blocks of a run

  [[nodiscard]] double angle_of(const Vector3& point_mm) const {
    const std::size_t u = index_of(plan_.plane[0]), v = index_of(plan_.plane[1]);
    return std::atan2(point_mm[v] - plan_.centre_mm[v], point_mm[u] - plan_.centre_mm[u]) / kRad_per_deg;
  }

  void read(const Vector3& command_mm, bool clockwise, int run) {
    const ToolPose pose = simulation_.tool_at(simulation_.machine().state(), command_mm, false);
    Vector3 point_mm = command_mm;
    for (std::size_t i = 0; i < point_mm.size(); ++i) point_mm[i] += pose.error_um[i] / kUmPerMm;
    const std::size_t u = index_of(plan_.plane[0]), v = index_of(plan_.plane[1]);
    const double distance_mm = std::hypot(point_mm[u] - plan_.centre_mm[u], point_mm[v] - plan_.centre_mm[v]);
    const double angle_deg = std::fmod(angle_of(point_mm) + 360.0, 360.0);
    test_.readings.push_back(
        {0, angle_deg, (distance_mm - plan_.radius_mm) * kUmPerMm + plan_.noise_um * simulation_.random().normal(),
         clockwise, run});
  }

  Simulation& simulation_;
  const CirclePlan& plan_;
  laser::CircleTest& test_;
  int line_ = -1;
  double angle_deg_ = 0.0;
  double travelled_deg_ = 0.0;
  double next_deg_ = 0.0;
};

}  // namespace

std::string circle_program(const CirclePlan& plan) {
  const double a = plan.start_angle_deg, over = plan.overlap_deg;
  std::string text = fmt::format("G90G{}\n", program_plane(plan.plane).word);
  const std::size_t third = 3 - index_of(plan.plane[0]) - index_of(plan.plane[1]);
  const Axis aside = kAllAxes[third];
  text += fmt::format("F{:.6f}\n", plan.feed_mm_min);
  for (int run = 0; run < plan.runs; ++run) {
    text +=
        fmt::format("G00{}{}\n", place_words(plan, a - over),
                    plan.centre_mm[third] == 0.0 ? std::string()
                                                 : fmt::format("{}{:.9f}", letter_of(aside), plan.centre_mm[third]));
    text += arc(plan, a - over, a) + arc(plan, a, a + 360.0) + arc(plan, a, a + over);
    text += arc(plan, a + over, a) + arc(plan, a, a - 360.0) + arc(plan, a, a - over);
    text += "G04H0.5\n";
  }
  return text + "M30\n";
}

Result<laser::CircleTest> contour_circle(Simulation& simulation, const CirclePlan& plan,
                                         const std::function<void()>& report) {
  ECS_DO(checked_plan(plan));
  ECS_TRY(program, parse_program(circle_program(plan), "circle"));
  laser::CircleTest test;
  test.plane = plan.plane;
  test.radius_mm = plan.radius_mm;
  test.feed_mm_min = plan.feed_mm_min;
  test.start_angle_deg = plan.start_angle_deg;
  for (std::size_t i = 0; i < 2; ++i) test.centre_mm[i] = plan.centre_mm[index_of(plan.plane[i])];
  BallBar bar(simulation, plan, test);
  ProgramHooks hooks;
  hooks.each = [&bar] { bar.watch(); };
  if (report) hooks.report = [&report](const ProgramProgress&) { report(); };
  const auto ran = run_program(simulation, program, {}, hooks);
  if (!ran) {
    Problem problem = ran.error();
    problem.kind = ProblemKind::usage;  // the program is the plan's, no file is to blame
    problem.file.clear();
    return tl::unexpected(std::move(problem));
  }
  return test;
}

}  // namespace ecs::emulator
