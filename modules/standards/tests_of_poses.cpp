// `ecs test poses`: repeatability of the points of a body at one pose (ISO 9283), and whether the way in which the pose
// is reached moves the body. `ecs test joints`: the axis of each joint, from points around it.

#include <cmath>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/writers/writers.hpp"
#include "modules/standards/joints.hpp"
#include "modules/standards/poses.hpp"

namespace ecs::app {
namespace {

struct PosesRequest {
  std::vector<std::string> files;
  ImportArguments import;
  std::string output;
  static Fields<PosesRequest> fields() {
    using R = PosesRequest;
    return {{"FILES", &R::files,
             "measurements of one pose, one file for each way of reaching it: EX, EY, EZ of every point at every visit "
             "(run)",
             Need::required},
            &R::import,
            {"-o,--output", &R::output,
             "CSV file for the readings of a single FILE without the rigid motion of each visit", Is::output}};
  }
};

Cell accuracy_cell(const Vector3& off_mm) {
  return record_cell(
      "  AP {accuracy_mm:>9} mm: {parts}", "accuracy_mm"_is(std::hypot(off_mm[0], off_mm[1], off_mm[2]), 4),
      "parts"_shown(fmt::format("{:+.4f} {:+.4f} {:+.4f}", off_mm[0], off_mm[1], off_mm[2])), "off_mm"_is(off_mm));
}

Cell point_cell(const laser::PosePoint& point) {
  return record_cell("  {place}  RP {repeatability_mm:>9} mm{accuracy}\n",
                     "place"_shown(fmt::format("{:>12.4f} {:>12.4f} {:>12.4f} mm", point.mean_mm[0], point.mean_mm[1],
                                               point.mean_mm[2])),
                     "x_mm"_is(point.mean_mm[0]), "y_mm"_is(point.mean_mm[1]), "z_mm"_is(point.mean_mm[2]),
                     "repeatability_mm"_is(point.repeatability_mm, 4),
                     "accuracy"_is(point.off_mm ? accuracy_cell(*point.off_mm) : Cell{Json(), ""}));
}

std::string motion_words(const laser::PoseTest& test) {
  return test.moves_as_a_whole()
             ? "The points move together from visit to visit, as one rigid body"
             : "This decrease is no larger than for independent scatter: the points have no motion in common";
}

Cell test_cell(const laser::PoseTest& test) {
  return record_cell(
      "{file}: {visits} visits of {count} points (visit: all points read once at the pose)\n{points}"
      "  in each row: mean X, Y and Z of the point; RP: its pose repeatability, AP: its pose accuracy, with the parts "
      "along X, Y and Z (ISO 9283)\n"
      "  rms of a coordinate {rms_um} um; {rms_after_um} um after a rigid motion (common shift and rotation) of each "
      "visit is removed. {words}\n"
      "  rigid motion of a visit, rms for each coordinate axis: shift {shift_um} um along it, rotation "
      "{turn_um_per_m} um/m about it\n",
      "file"_is(test.file), "visits"_is(test.visits), "count"_shown(test.points.size()),
      "points"_is(list_cell(test.points, point_cell)), "rms_um"_is(test.rms_um, 2),
      "rms_after_um"_is(test.rms_after_um, 2), "words"_shown(motion_words(test)), "shift_um"_is(test.shift_um, 2),
      "turn_um_per_m"_is(test.turn_um_per_m, 1), "variance_ratio"_is(test.ratio), "p_value"_is(test.probability),
      "moves_as_a_whole"_is(test.moves_as_a_whole()));
}

struct Compared {
  std::string first, second;
  laser::PoseComparison comparison;
};

std::string cause_words(const laser::PoseComparison& comparison) {
  if (comparison.is_way_of_approach())
    return "Cause: the way of approach (play or friction of the axes). The motions differ, the scatter of the points "
           "after them does not, so it is not the instrument.";
  if (comparison.rest_probability < comparison.probability)
    return "The scatter of the points differs as well: check instrument and targets before the axes.";
  return "No difference between the two ways of approach shows.";
}

Cell comparison_cell(const Compared& compared) {
  const laser::PoseComparison& c = compared.comparison;
  return record_cell(
      "{second} compared with {first}: variance of the motions {ratio} times as large (chance {p})\n"
      "{shifted}{cause}\n",
      "first"_is(compared.first), "second"_is(compared.second), "variance_ratio"_is(c.ratio),
      "ratio"_shown(fmt::format("{:.3g}", c.ratio)), "p"_shown(fmt::format("{:.2g}", c.probability)),
      "p_value"_is(c.probability), "rest_p_value"_is(c.rest_probability), "largest_shift_mm"_is(c.largest_shift_mm),
      "shifted"_shown(c.largest_shift_mm ? fmt::format("mean positions up to {:.4f} mm apart\n", *c.largest_shift_mm)
                                         : std::string()),
      "cause"_shown(cause_words(c)), "is_way_of_approach"_is(c.is_way_of_approach()));
}

Result<Outcome> poses(VerbContext& context, const PosesRequest& request) {
  if (!request.output.empty() && request.files.size() > 1)
    return problem(ProblemKind::bad_input, "--output: expected one FILE, found {}", request.files.size());
  std::vector<laser::PoseTest> tests;
  for (const std::string& file : request.files) {
    ECS_TRY(imported, read_with_notes(context.console, file, request.import));
    ECS_TRY(test, laser::pose_test_of(imported.set));
    if (!request.output.empty()) {
      ECS_DO(laser::write_measurement_set(request.output, laser::without_motions(imported.set, test)));
      context.console.note("readings without the rigid motion of each visit written to " + request.output);
    }
    tests.push_back(std::move(test));
  }
  std::vector<Compared> compared;
  for (std::size_t i = 1; i < tests.size(); ++i)
    compared.push_back({tests.front().file, tests[i].file, laser::comparison_of(tests.front(), tests[i])});
  return outcome_of(record_cell("{tests}{comparisons}", "tests"_is(list_cell(tests, test_cell)),
                                "comparisons"_is(list_cell(compared, comparison_cell))));
}

struct JointsRequest {
  std::string file;
  static Fields<JointsRequest> fields() {
    using R = JointsRequest;
    return {{"FILE", &R::file, "points read at angles of each joint (CSV): joint, angle_deg, x_mm, y_mm, z_mm",
             Need::required}};
  }
};

Cell joint_cell(const laser::JointAxis& axis) {
  const auto triple = [](const Vector3& v, int digits) {
    return fmt::format("{:.{}f} {:.{}f} {:.{}f}", v[0], digits, v[1], digits, v[2], digits);
  };
  const auto optional_text = [](std::string_view words, const std::optional<double>& value, std::string_view unit) {
    return value ? fmt::format("  {} {:.2f} {}\n", words, *value, unit) : std::string();
  };
  return record_cell(
      "joint {joint}: {points} points from {from_deg} to {to_deg} deg\n"
      "  axis through {through} mm (u = {centre_u_mm} mm)\n"
      "  direction {along} (u = {direction_u_um_per_m} um/m)\n"
      "  radius {radius_mm} mm (u = {radius_u_mm} mm); residual: radial {radial_rms_um} um rms, axial {axial_rms_um} "
      "um "
      "rms\n"
      "  error of the angle {angle_rms_um_per_m} um/m rms, largest {largest_angle_um_per_m} um/m at {largest_at_deg} "
      "deg\n{reversal}{closure}",
      "joint"_is(axis.joint), "points"_is(axis.points), "from_deg"_is(axis.from_deg), "to_deg"_is(axis.to_deg),
      "through"_shown(triple(axis.centre_mm, 4)), "centre_mm"_is(axis.centre_mm), "centre_u_mm"_is(axis.centre_u_mm, 4),
      "along"_shown(triple(axis.direction, 7)), "direction"_is(axis.direction),
      "direction_u_um_per_m"_is(axis.direction_u_um_per_m, 1), "radius_mm"_is(axis.radius_mm, 4),
      "radius_u_mm"_is(axis.radius_u_mm, 4), "radial_rms_um"_is(axis.radial_rms_um, 2),
      "axial_rms_um"_is(axis.axial_rms_um, 2), "angle_rms_um_per_m"_is(axis.angle_rms_um_per_m, 1),
      "largest_angle_um_per_m"_is(axis.largest_angle_um_per_m, 1), "largest_at_deg"_is(axis.largest_at_deg),
      "reversal"_shown(optional_text(
          "reversal error of the angle, approached upwards minus downwards:", axis.reversal_um_per_m, "um/m")),
      "reversal_um_per_m"_is(axis.reversal_um_per_m),
      "closure"_shown(optional_text("largest distance between two points a whole turn apart:", axis.closure_um, "um")),
      "closure_um"_is(axis.closure_um));
}

Cell axes_cell(const laser::AxesOfJoints& axes) {
  return record_cell("axes {first} and {second}: {angle_deg} deg between them, {distance_mm} mm apart{parallel}\n",
                     "first"_is(axes.first), "second"_is(axes.second), "angle_deg"_is(axes.angle_deg, 4),
                     "distance_mm"_is(axes.distance_mm, 4), "is_parallel"_is(axes.is_parallel),
                     "parallel"_shown(axes.is_parallel ? " (nearly parallel: at the circle of the second)" : ""));
}

Result<Outcome> joints(VerbContext&, const JointsRequest& request) {
  ECS_TRY(text, read_file(request.file));
  ECS_TRY(sweeps, laser::parse_joints(text, request.file));
  std::vector<laser::JointAxis> axes;
  std::vector<laser::AxesOfJoints> pairs;
  for (const laser::JointSweep& sweep : sweeps) {
    ECS_TRY(axis, laser::joint_axis_of(sweep, request.file));
    if (!axes.empty()) pairs.push_back(laser::between(axes.back(), axis));
    axes.push_back(std::move(axis));
  }
  return outcome_of(record_cell("{joints}{pairs}", "joints"_is(list_cell(axes, joint_cell)),
                                "pairs"_is(list_cell(pairs, axes_cell))));
}

}  // namespace

extern const std::vector<Action> kTestsOfPoses{
    action("test poses", "ISO 9283: repeatability of a pose, and the effect of the approach",
           "ecs test poses same_way.csv any_way.csv", poses, {.logged = Logged::always, .kind = "test"}),
    action("test joints", "axis, angle error, reversal and closure of each joint, from x, y, z of a point around it",
           "ecs test joints arm.csv", joints, {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
