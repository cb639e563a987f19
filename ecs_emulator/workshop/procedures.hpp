// What is done at the machine beside measuring lines: the reference sequence of its own control, a circular test
// (ISO 230-4: a ball bar between tool and table, contoured both ways), lengths to the tool, a ball on the table, and
// the survey of its true errors, which no instrument can measure at once. One source each. Does not live here: the
// requests (workshop.cpp), what readings say of the machine (the host).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "laser/circle_test.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

// The reference sequence of the machine's own control: what it does on its switch and marker, axis after axis.
// Does not live here: the unit that watches (ecs_emulator/unit/datum_watch.hpp).

/// The operator brings each axis in rapid to the approach side of its switch; the control then seeks the switch at
/// reference speed, creeps on or back to the marker as its family does (core/datum.hpp names them), takes that place as
/// its reference and goes to the reference position. An axis ends on `datum_mm`.
/// Problems (refused): given up; an alarm of the control, which leaves the axis where it is: switch not met before the
/// end of travel, switch not left, no marker.
[[nodiscard]] Result<void> reference(Simulation& simulation, const std::vector<Axis>& axes);

// A circular test on the machine (ISO 230-4): a ball bar between tool and table, contoured both ways. Does not live
// here: what the readings mean, the request (workshop.cpp).

struct CirclePlan {
  std::array<Axis, 2> plane{Axis::X, Axis::Y};  ///< the angle rises from the first to the second
  Vector3 centre_mm{};                          ///< machine coordinates
  double radius_mm = 100.0;
  double feed_mm_min = 1000.0;
  double start_angle_deg = 0.0;
  double overlap_deg = 45.0;  ///< before and after each full turn, on the circle, not read
  double step_deg = 1.0;      ///< between readings
  int runs = 2;               ///< each of one turn counter-clockwise and one clockwise
  double noise_um = 0.1;      ///< standard deviation of the ball bar
};

/// The part program that is run: rapid to the circle, arcs in G02 and G03.
[[nodiscard]] std::string circle_program(const CirclePlan& plan);

/// Deviation = distance of the true tool point from the centre − radius, at the angle at which it truly is.
/// Problems: a plan that does not fit, a circle outside the travel (both `usage`), given up (`refused`).
/// @param report  after each block
[[nodiscard]] Result<laser::CircleTest> contour_circle(Simulation& simulation, const CirclePlan& plan,
                                                       const std::function<void()>& report = {});

// Lengths from stations or along lines to the tool of the true machine, pose by pose as a plan says
// (modules/lengths/README.md). The poses are taken as reached: cold, unloaded, standing, without a unit; what the
// drives do on the way is not in it. Does not live here: what the lengths say of the machine: host and emulator share
// no code but the file format's words.

/// How good instrument and set-up are; standard deviations.
struct LengthInstrumentSettings {
  double noise_um = 0.2;        ///< of each reading
  double scale_um_per_m = 0.1;  ///< of each set-up: air, wavelength
  double station_mm = 0.2;      ///< of each coordinate of a station, from what the plan says
  double tool_mm = 0.05;        ///< of each coordinate of a tool, from what the plan says
  double zero_um = 100.0;       ///< of each run
  double bar_um = 1.0;          ///< of a ball bar's length, in place of the zeros, where the plan says `bar_um`
  bool scatter = true;          ///< of the machine
};

struct MeasuredLengths {
  std::string csv;
  std::size_t readings = 0;
};

/// The plan with a column deviation_um. Refused, all faults at once: a plan that lacks a column, names no tool or
/// set-up of its head, or goes beyond the travel.
[[nodiscard]] Result<MeasuredLengths> measured_lengths(Simulation& simulation, std::string_view plan,
                                                       const std::string& file,
                                                       const LengthInstrumentSettings& settings);

// What a ball on the table and the spindle show of a machine with rotary axes: the linear axes follow the ball while a
// rotary axis turns (R-test, or a probe that measures a ball; ISO 10791-6, BK1 to BK4), and readings of an error motion
// on its own. The poses are taken as reached: cold, unloaded, standing; no unit is there: it would know three axes.
// Does not live here: what the readings say of the machine (the host).

/// One rotary axis moves, there and back; the others stand.
struct Sweep {
  std::size_t axis = 0;  ///< A, B, C
  std::vector<double> targets_deg;
  Vector3 parked_deg{};
};

struct BallPlan {
  Vector3 ball_mm{};          ///< where the linear axes touch it, all angles 0
  Vector3 tool_offset_mm{};   ///< from the point at which the curves count to the ball in the spindle
  Vector3 off_um{};           ///< by which the ball on the table is off that place, along X, Y, Z of the table
  Vector3 tool_off_um{};      ///< by which that in the spindle is off
  std::vector<Sweep> sweeps;  ///< none: usual_sweeps(), as far as the ball is in reach
  int runs = 2;
  double noise_um = 0.3;      ///< standard deviation of a reading
  double seconds = 5.0;       ///< from one pose to the next
  bool on_workpiece = false;  ///< sensors turn with the table: readings along its X, Y, Z
  bool drives = false;        ///< to every pose, with the unit at the machine; else it reaches them exactly, cold
  RotaryState stand;          ///< of the rotary axes before the first pose: referenced, if nothing else is said
};

/// Every rotary axis over its travel with the other at 0, and again with the other half way to the farther end: 12
/// targets, a turn without its end.
[[nodiscard]] std::vector<Sweep> usual_sweeps(const params::Machine& machine);

/// EX, EY, EZ at every pose. Refused: a machine without X, Y, Z or without rotary axes, an angle or a place beyond the
/// travels.
[[nodiscard]] Result<laser::MeasurementSet> ball_readings(Simulation& simulation, const BallPlan& plan);

/// The rotary axes after these readings: where they are, and from which side each came there.
[[nodiscard]] RotaryState stand_after(const laser::MeasurementSet& set, RotaryState before);

struct TurnPlan {
  Sweep sweep;
  Sense sense = Sense::EC;
  int runs = 3;
  double noise = 0.3;  ///< um, um/m
  double seconds = 5.0;
};

/// Readings of an error motion on its own, counted from the first target.
[[nodiscard]] Result<laser::MeasurementSet> turn_readings(Simulation& simulation, const TurnPlan& plan);

/// "C=0:330:30" or "C=0,45,180" the axis that moves, "/A=-60" where another stands. A `usage` problem says what is
/// wrong.
[[nodiscard]] Result<Sweep> sweep_in(std::string_view text);

// The true errors of the machine: its components along its axes, what a volume is computed from, and the volumetric
// accuracy as it stands, unit included: what no instrument can measure at once.
// Does not live here: where the errors come from (ecs_emulator/errors/true_errors.hpp).

/// Systematic part at the coordinates asked for [um, um/m]; empty for an axis that does not exist.
struct AxisComponents {
  std::array<std::vector<double>, kCurves> forward;
  std::array<std::vector<double>, kCurves> reverse;
  ComponentValues squareness{};
};

/// The other axes stand at the datum. Refused: a component that depends on where another axis stands, by its name.
/// @param places_mm  coordinates of each axis
[[nodiscard]] Result<AxisComponents> components_along(const Simulation& simulation,
                                                      const PerAxis<std::vector<double>>& places_mm);

/// A cause that the components above leave out: they are those of a machine at rest, as it was switched on.
struct LeftOut {
  std::string cause;  ///< "scatter", "load", …
  std::vector<Component> components;
};
/// Those that the errors file has: found by changing one condition after the other.
[[nodiscard]] std::vector<LeftOut> left_out(const Simulation& simulation);

/// The same of the rotary axes: by A, B, C and sense, at the angles asked for; location errors.
struct RotaryComponents {
  PerAxis<std::array<std::vector<double>, 6>> forward;
  PerAxis<std::array<std::vector<double>, 6>> reverse;
  PerAxis<SixOfAxis> location{};
};
[[nodiscard]] RotaryComponents rotary_components(const Simulation& simulation,
                                                 const PerAxis<std::vector<double>>& angles_deg);

struct SurveyPlan {
  double step_mm = 250.0;                 ///< of the grid; both ends of every travel belong to it
  Approach approach = Approach::forward;  ///< of every axis at every point
  bool scatter = false;
  double overrun_mm = 5.0;  ///< before every row
};

/// One place of the working volume.
struct SurveyPoint {
  Vector3 position_mm{};
  Vector3 error_um{};  ///< actual − target, less that at the datum
  [[nodiscard]] double length_um() const;
};

struct Survey {
  std::vector<SurveyPoint> grid;
  std::vector<SurveyPoint> corners;  ///< those of the grid that are corners of the working volume
};

/// Drives to every point of the grid. @return nothing if given up
[[nodiscard]] Result<Survey> survey(Simulation& simulation, const SurveyPlan& plan);

/// The point with the longest error vector. @pre !points.empty()
[[nodiscard]] const SurveyPoint& worst(const std::vector<SurveyPoint>& points);
/// √(mean length²)
[[nodiscard]] double rms_um(const std::vector<SurveyPoint>& points);

}  // namespace ecs::emulator
