#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "ecs_emulator/workshop/procedures.hpp"

namespace ecs::emulator {
namespace {

constexpr double kTurn_deg = 360.0;
constexpr std::size_t kUsualTargets = 12, kMostTargets = 10'000;

Result<void> check(const params::Machine& machine, const Sweep& sweep) {
  for (std::size_t r = 0; r < kAxes; ++r) {
    const bool moves = r == sweep.axis;
    const auto& axis = machine.rotary[r];
    if (!axis && (moves || sweep.parked_deg[r] != 0.0))
      return problem(ProblemKind::usage, "this machine has no rotary axis {}", "ABC"[r]);
    const auto refused = [&](double angle_deg) -> Result<void> {
      return problem(ProblemKind::usage, "{} {} deg: expected an angle within its travel {} … {} deg", "ABC"[r],
                     angle_deg, axis -> travel_deg[0], axis -> travel_deg[1]);
    };
    const auto within = [&](double angle_deg) {
      return angle_deg >= axis->travel_deg[0] && angle_deg <= axis->travel_deg[1];
    };
    if (moves)
      for (const double angle_deg : sweep.targets_deg)
        if (!within(angle_deg)) return refused(angle_deg);
    if (!moves && axis && !within(sweep.parked_deg[r])) return refused(sweep.parked_deg[r]);
  }
  if (sweep.targets_deg.size() < 2)
    return problem(ProblemKind::usage, "{}: expected two targets or more", "ABC"[sweep.axis]);
  return {};
}

/// Where the linear axes touch a point of the workpiece: the tool point depends on them along straight lines.
Result<Vector3> linear_axes_at(const TurningGeometry& geometry, const params::Machine& machine,
                               const Vector3& workpiece_mm, const Vector3& angle_deg) {
  const Vector3 from = turning_pose(geometry, {}, {}, {}, angle_deg).nominal_mm;
  Vector3 place{};
  for (const Axis axis : kAllAxes) {  // the directions of the axes are at right angles
    Vector3 one{};
    one[index_of(axis)] = 1.0;
    const Vector3 to = turning_pose(geometry, {}, {}, one, angle_deg).nominal_mm;
    for (std::size_t d = 0; d < kAxes; ++d) place[index_of(axis)] += (to[d] - from[d]) * (workpiece_mm[d] - from[d]);
    const auto& travel = machine.axes[index_of(axis)]->travel_mm;
    if (place[index_of(axis)] < travel[0] || place[index_of(axis)] > travel[1])
      return problem(ProblemKind::usage,
                     "at A {:g} B {:g} C {:g} deg the ball is at {} {:.1f} mm, beyond its travel {} … {} "
                     "mm: set it up elsewhere, or turn less",
                     angle_deg[0], angle_deg[1], angle_deg[2], letter_of(axis), place[index_of(axis)], travel[0],
                     travel[1]);
  }
  return place;
}

/// The stops of one sweep in the order of the runs, there and back.
struct TurnStop {
  double angle_deg = 0.0;
  Approach approach = Approach::forward;
  int run = 1;
};
std::vector<TurnStop> stops_of(const Sweep& sweep, int runs) {
  std::vector<TurnStop> stops;
  std::vector<double> targets = sweep.targets_deg;
  for (int run = 1; run <= runs; ++run) {
    std::sort(targets.begin(), targets.end());
    for (const double angle_deg : targets) stops.push_back({angle_deg, Approach::forward, run});
    std::reverse(targets.begin(), targets.end());
    for (const double angle_deg : targets) stops.push_back({angle_deg, Approach::reverse, run});
  }
  return stops;
}

laser::MeasurementSet begun(const params::Machine& machine, std::string instrument) {
  laser::MeasurementSet set;
  set.metadata = {{"machine", machine.name},
                  {"configuration", machine.rotary_configuration},
                  {"instrument", std::move(instrument)}};
  return set;
}

double along(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

std::vector<Sweep> usual_sweeps(const params::Machine& machine) {
  std::vector<Sweep> sweeps;
  for (std::size_t r = 0; r < kAxes; ++r) {
    if (!machine.rotary[r]) continue;
    const auto [low, high] = machine.rotary[r]->travel_deg;
    const bool turns = high - low >= kTurn_deg;
    Sweep sweep;
    sweep.axis = r;
    for (std::size_t i = 0; i < kUsualTargets; ++i)
      sweep.targets_deg.push_back(low + (turns ? kTurn_deg : high - low) * static_cast<double>(i) /
                                            static_cast<double>(turns ? kUsualTargets : kUsualTargets - 1));
    sweeps.push_back(sweep);
    for (std::size_t other = 0; other < kAxes; ++other) {
      if (other == r || !machine.rotary[other]) continue;
      const auto ends = machine.rotary[other]->travel_deg;
      sweep.parked_deg = {};
      sweep.parked_deg[other] =
          ends[1] - ends[0] >= kTurn_deg ? 90.0 : 0.5 * (std::abs(ends[0]) > std::abs(ends[1]) ? ends[0] : ends[1]);
      sweeps.push_back(sweep);
    }
  }
  return sweeps;
}

namespace {

/// The usual sweeps without the targets at which the ball is out of reach.
std::vector<Sweep> reachable_sweeps(const TurningGeometry& geometry, const params::Machine& machine,
                                    const Vector3& workpiece_mm) {
  constexpr std::size_t kFewest = 4;
  std::vector<Sweep> sweeps = usual_sweeps(machine);
  for (Sweep& sweep : sweeps)
    std::erase_if(sweep.targets_deg, [&](double angle_deg) {
      Vector3 angles = sweep.parked_deg;
      angles[sweep.axis] = angle_deg;
      return !linear_axes_at(geometry, machine, workpiece_mm, angles);
    });
  std::erase_if(sweeps, [&](const Sweep& sweep) { return sweep.targets_deg.size() < kFewest; });
  return sweeps;
}

/// The tool at a pose. A machine that drives there has its own approach and clock.
Result<TurningPose> pose_at(Simulation& simulation, const BallPlan& plan, const Vector3& place_mm,
                            RotaryState& rotary) {
  const TurningGeometry geometry = turning_geometry_of(simulation.description().machine, plan.tool_offset_mm);
  if (plan.drives) {
    simulation.machine().turn_to(rotary.angle_deg);
    if (!simulation.move_to(place_mm, 0.0)) return problem(ProblemKind::refused, "stopped before its end");
    rotary = simulation.machine().rotary_state();
    return simulation.turned_tool(plan.tool_offset_mm);
  }
  MachineState state;
  state.position_mm = place_mm;
  state.time_s = rotary.time_s;
  return turning_pose(geometry, simulation.errors().at(state, simulation.heat()), simulation.errors().rotary_at(rotary),
                      place_mm, rotary.angle_deg);
}

}  // namespace

Result<laser::MeasurementSet> ball_readings(Simulation& simulation, const BallPlan& plan) {
  const params::Machine& machine = simulation.description().machine;
  if (machine.rotary_configuration.empty())
    return problem(ProblemKind::usage,
                   "expected a machine file with rotary axes: configuration = \"XYACTZ\", [axis.A], [axis.C]");
  for (const Axis axis : kAllAxes)
    if (!machine.axes[index_of(axis)])
      return problem(ProblemKind::usage, "expected X, Y and Z to follow the ball, the machine has no {}",
                     letter_of(axis));
  const TurningGeometry geometry = turning_geometry_of(machine, plan.tool_offset_mm);
  const Vector3 workpiece_mm = turning_pose(geometry, {}, {}, plan.ball_mm, {}).nominal_mm;
  laser::MeasurementSet set = begun(machine, "ball on the table");
  RotaryState rotary = plan.stand;
  double time_s = 0.0;
  const std::vector<Sweep> sweeps =
      plan.sweeps.empty() ? reachable_sweeps(geometry, machine, workpiece_mm) : plan.sweeps;
  if (sweeps.empty())
    return problem(ProblemKind::usage, "the ball is out of reach while the rotary axes turn: set it up elsewhere");
  for (const Sweep& sweep : sweeps) {
    ECS_DO(check(machine, sweep));
    for (std::size_t r = 0; r < kAxes; ++r)
      if (sweep.parked_deg[r] != rotary.angle_deg[r])
        rotary.approach[r] = sweep.parked_deg[r] > rotary.angle_deg[r] ? Approach::forward : Approach::reverse;
    rotary.angle_deg = sweep.parked_deg;
    for (const TurnStop& stop : stops_of(sweep, plan.runs)) {
      rotary.angle_deg[sweep.axis] = stop.angle_deg;
      rotary.approach[sweep.axis] = stop.approach;
      rotary.time_s = time_s += plan.seconds;
      ECS_TRY(place, linear_axes_at(geometry, machine, workpiece_mm, rotary.angle_deg));
      ECS_TRY(pose, pose_at(simulation, plan, place, rotary));
      Vector3 error_um = pose.error_um;
      for (std::size_t d = 0; d < kAxes; ++d) {
        error_um[d] -= plan.off_um[d];
        for (std::size_t l = 0; l < kAxes; ++l) error_um[d] += pose.tool[l][d] * plan.tool_off_um[l];
      }
      for (std::size_t d = 0; d < kAxes; ++d) {
        laser::Reading reading;
        reading.axis = static_cast<Axis>(sweep.axis);
        reading.rotary = true;
        reading.position_mm = place;
        reading.angle_deg = rotary.angle_deg;
        reading.sense = static_cast<Sense>(d);
        reading.error = (plan.on_workpiece ? error_um[d] : along(error_um, pose.bed[d])) +
                        plan.noise_um * simulation.random().normal();
        reading.approach = rotary.approach[sweep.axis];
        reading.run = stop.run;
        reading.time_s = rotary.time_s;
        if (plan.drives)
          reading.compensated = std::any_of(simulation.drives().begin(), simulation.drives().end(),
                                            [](const AxisDrive& drive) { return drive.relay_closed; });
        if (plan.on_workpiece) reading.extras["on_workpiece"] = 1.0;
        for (std::size_t t = 0; t < kAxes; ++t)
          if (plan.tool_offset_mm[t] != 0.0)
            reading.extras[std::string("tool_") + "xyz"[t] + "_mm"] = plan.tool_offset_mm[t];
        set.readings.push_back(std::move(reading));
      }
    }
  }
  return set;
}

RotaryState stand_after(const laser::MeasurementSet& set, RotaryState before) {
  for (const laser::Reading& r : set.readings) {
    for (std::size_t a = 0; a < kAxes; ++a)
      if (r.angle_deg[a] != before.angle_deg[a])
        before.approach[a] = r.angle_deg[a] > before.angle_deg[a] ? Approach::forward : Approach::reverse;
    before.angle_deg = r.angle_deg;
    before.approach[index_of(r.axis)] = r.approach;
  }
  return before;
}

Result<laser::MeasurementSet> turn_readings(Simulation& simulation, const TurnPlan& plan) {
  const params::Machine& machine = simulation.description().machine;
  ECS_DO(check(machine, plan.sweep));
  laser::MeasurementSet set = begun(machine, "sensor at the axis");
  const auto s = static_cast<std::size_t>(plan.sense);
  RotaryState rotary;
  rotary.angle_deg = plan.sweep.parked_deg;
  std::optional<double> zero;
  for (const TurnStop& stop : stops_of(plan.sweep, plan.runs)) {
    rotary.angle_deg[plan.sweep.axis] = stop.angle_deg;
    rotary.approach[plan.sweep.axis] = stop.approach;
    rotary.time_s += plan.seconds;
    const double value = simulation.errors().rotary_at(rotary).motion[plan.sweep.axis][s];
    if (!zero) zero = value;
    laser::Reading reading;
    reading.axis = static_cast<Axis>(plan.sweep.axis);
    reading.rotary = true;
    reading.angle_deg = rotary.angle_deg;
    reading.sense = plan.sense;
    reading.error = value - *zero + plan.noise * simulation.random().normal();
    reading.approach = stop.approach;
    reading.run = stop.run;
    reading.time_s = rotary.time_s;
    set.readings.push_back(std::move(reading));
  }
  return set;
}

Result<Sweep> sweep_in(std::string_view text) {
  const auto wrong = [&](std::string_view part) {
    return problem(ProblemKind::usage, "sweep: expected such as \"C=0:330:30\" or \"C=0,45,180/A=-60\", found \"{}\"",
                   part);
  };
  Sweep sweep;
  bool first = true;
  for (const std::string_view part : split(text, '/')) {
    const auto sides = split(part, '=');
    const std::size_t axis =
        sides.size() == 2 && sides[0].size() == 1 ? std::string_view("ABC").find(sides[0]) : std::string_view::npos;
    if (axis == std::string_view::npos) return wrong(part);
    std::vector<double> numbers;
    const bool is_list = first && sides[1].find(',') != std::string_view::npos;
    for (const std::string_view word : split(sides[1], is_list ? ',' : ':')) {
      const auto number = number_in(word);
      if (!number) return wrong(part);
      numbers.push_back(*number);
    }
    if (!is_list && numbers.size() != (first ? 3U : 1U)) return wrong(part);
    if (is_list) {
      sweep.axis = axis;
      sweep.targets_deg = numbers;
    } else if (first) {
      const double span = numbers[1] - numbers[0], step = std::abs(numbers[2]);
      if (!(step > 0.0) || std::abs(span) / step > static_cast<double>(kMostTargets)) return wrong(part);
      const auto count = static_cast<std::size_t>(std::floor(std::abs(span) / step + 1e-9));
      sweep.axis = axis;
      for (std::size_t i = 0; i <= count; ++i)
        sweep.targets_deg.push_back(numbers[0] + std::copysign(step, span) * static_cast<double>(i));
    } else {
      if (axis == sweep.axis) return wrong(part);
      sweep.parked_deg[axis] = numbers[0];
    }
    first = false;
  }
  return sweep;
}

}  // namespace ecs::emulator
