// Sets of a ball that a person could measure next, after readings of a ball: pairs of + and - of the tilting axis, a
// tool of another length, the ball at a place that differs along one axis (as the candidate set of a designed
// experiment: Fedorov 1972; poses as BK1 to BK4 of ISO 10791-6). Does not live here: their worth (separation.cpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "model/planning/run.hpp"

namespace ecs::model {
namespace {

/// Angles to either side of 0, at most that wide: a head lies flat at 90 degrees. Choices, like the steps: nine angles
/// separate sine, cosine and a line of the angle.
constexpr double kWidest_deg = 90.0;
constexpr int kSteps = 4;
/// Steps of the other axis while the first tilts, and in a sweep of its own.
constexpr double kQuarter_deg = 90.0, kEighth_deg = 45.0;
constexpr std::size_t kFewestTargets = 3;
/// How far the ball is moved, the farthest first, and how much a tool is longer or shorter: choices.
constexpr std::array kMoves_mm{400.0, -400.0, 200.0, -200.0, 100.0, -100.0};
constexpr double kOtherLength_mm = 100.0, kShortestTool_mm = 50.0;
/// A place is used where at least this share of the poses is within reach, of those at the present place.
constexpr double kMostPoses = 0.75;

/// Where the ball and what touches it are.
struct BallPlace {
  Vector3 point_mm{};  ///< of the ball, in the frame of the workpiece
  Vector3 tool_mm{};
};

/// The row that was measured last, in the order of the file.
std::size_t last_row(const Observations& data) {
  return static_cast<std::size_t>(std::ranges::max_element(data.file_order) - data.file_order.begin());
}

double number_or_0(const Observations& data, const char* column, std::size_t k) {
  const auto found = data.extras.find(column);
  return found == data.extras.end() || std::isnan(found->second[k]) ? 0.0 : found->second[k];
}

BallPlace present_place(const Observations& data) {
  const std::size_t k = last_row(data);
  BallPlace now{data.balls_mm[static_cast<std::size_t>(data.through_chain[k].ball) - 1], {}};
  for (std::size_t d = 0; d < kAxes; ++d) now.tool_mm[d] = number_or_0(data, kToolColumns[d], k);
  return now;
}

bool turns_fully(const params::MachineRotaryAxis& axis) {
  constexpr double kTurn = 360.0;
  return axis.travel_deg[1] - axis.travel_deg[0] >= kTurn;
}

/// Multiples of a step within the travel, of a whole turn each angle once.
std::vector<double> multiples_of(double step_deg, double most_deg, const params::MachineRotaryAxis& axis) {
  std::vector<double> angles;
  const double from = turns_fully(axis) ? 0.0 : -most_deg, to = turns_fully(axis) ? kTurn_deg - step_deg : most_deg;
  for (int k = 0; from + k * step_deg <= to; ++k) {
    const double angle_deg = from + k * step_deg;
    if (angle_deg >= axis.travel_deg[0] && angle_deg <= axis.travel_deg[1]) angles.push_back(angle_deg);
  }
  return angles;
}

double widest_of(const params::MachineRotaryAxis& axis) {
  return std::min(kWidest_deg, std::max(std::abs(axis.travel_deg[0]), std::abs(axis.travel_deg[1])));
}

/// The axis that tilts: the one that does not turn fully, of two the one next to the tool or the table's inner one.
Axis tilting_axis(const Observations& data) {
  const std::string& letters = data.machine.rotary_configuration;
  Axis tilting = data.rotary_axes.front();
  for (const char letter : letters) {
    if (letter < 'A' || letter > 'C') continue;
    const auto axis = static_cast<Axis>(letter - 'A');
    const auto& facts = data.machine.rotary[index_of(axis)];
    const auto& chosen = data.machine.rotary[index_of(tilting)];
    if (facts && chosen && (!turns_fully(*facts) || turns_fully(*chosen))) tilting = axis;
  }
  return tilting;
}

/// The tilting axis at pairs of + and - angles with the other one at several, then the other one at a pair.
std::vector<BallSet::Sweep> wanted_sweeps(const Observations& data, Axis tilting) {
  const params::MachineRotaryAxis& tilts = *data.machine.rotary[index_of(tilting)];
  const double widest_deg = widest_of(tilts);
  BallSet::Sweep sweep{tilting, multiples_of(widest_deg / kSteps, widest_deg, tilts), {}};
  std::vector<BallSet::Sweep> sweeps;
  const auto other = std::ranges::find_if(data.rotary_axes, [&](Axis axis) { return axis != tilting; });
  if (other == data.rotary_axes.end()) return {sweep};
  const params::MachineRotaryAxis& turns = *data.machine.rotary[index_of(*other)];
  for (const double parked_deg : multiples_of(kQuarter_deg, widest_of(turns), turns)) {
    sweep.parked_deg[index_of(*other)] = parked_deg;
    sweeps.push_back(sweep);
  }
  for (const double parked_deg : {0.5 * widest_deg, -0.5 * widest_deg}) {
    if (parked_deg < tilts.travel_deg[0] || parked_deg > tilts.travel_deg[1]) continue;
    BallSet::Sweep turn{*other, multiples_of(kEighth_deg, widest_of(turns), turns), {}};
    turn.parked_deg[index_of(tilting)] = parked_deg;
    sweeps.push_back(std::move(turn));
  }
  return sweeps;
}

/// Angles of a sweep with its own axis at a target.
Vector3 angles_at(const BallSet::Sweep& sweep, double target_deg) {
  Vector3 angles = sweep.parked_deg;
  angles[index_of(sweep.axis)] = target_deg;
  return angles;
}

laser::Reading reading_at(const Observations& data, const BallPlace& at, Axis axis, const Vector3& angle_deg) {
  laser::Reading reading;
  reading.axis = axis;
  reading.rotary = true;
  reading.angle_deg = angle_deg;
  reading.position_mm = at.point_mm;
  for (std::size_t d = 0; d < kAxes; ++d)
    if (at.tool_mm[d] != 0.0) reading.extras[kToolColumns[d]] = at.tool_mm[d];
  if (number_or_0(data, kOnWorkpiece, last_row(data)) != 0.0) reading.extras[kOnWorkpiece] = 1.0;
  return reading;
}

/// Where X, Y, Z stand at each pose, at 0 too; empty: they cannot follow.
std::map<Vector3, Vector3> places_of(const Observations& data, const BallPlace& at,
                                     const std::vector<BallSet::Sweep>& sweeps) {
  laser::MeasurementSet poses;
  const auto add = [&](Axis axis, const Vector3& angle_deg) {
    poses.readings.push_back(reading_at(data, at, axis, angle_deg));
    poses.readings.back().extras[kAtTip] = 1.0;
  };
  add(sweeps.front().axis, {});
  for (const BallSet::Sweep& sweep : sweeps)
    for (const double target_deg : sweep.targets_deg) add(sweep.axis, angles_at(sweep, target_deg));
  const Observations rows = observations_of(poses, KnownTables{}, *data.ball_machine);
  std::map<Vector3, Vector3> places;
  for (std::size_t k = 0; k < rows.place_mm.size(); ++k) places[rows.position_mm[k]] = rows.place_mm[k];
  return places;
}

bool is_within_travel(const params::Machine& machine, const Vector3& place_mm) {
  return std::ranges::all_of(kAllAxes, [&](Axis axis) {
    const auto& facts = machine.axes[index_of(axis)];
    const double mm = place_mm[index_of(axis)];
    return facts && mm >= facts->travel_mm[0] && mm <= facts->travel_mm[1];
  });
}

/// Without the targets out of reach; of an angle out of reach its opposite goes too, so that pairs are left.
std::vector<BallSet::Sweep> within_reach(const Observations& data, std::vector<BallSet::Sweep> sweeps,
                                         const std::map<Vector3, Vector3>& places) {
  for (BallSet::Sweep& sweep : sweeps) {
    const auto reached = [&](double target_deg) {
      const auto found = places.find(angles_at(sweep, target_deg));
      return found == places.end() || is_within_travel(*data.ball_machine, found->second);
    };
    std::erase_if(sweep.targets_deg, [&](double target_deg) { return !reached(target_deg) || !reached(-target_deg); });
  }
  std::erase_if(sweeps, [](const BallSet::Sweep& sweep) { return sweep.targets_deg.size() < kFewestTargets; });
  return sweeps;
}

std::size_t poses_in(const std::vector<BallSet::Sweep>& sweeps) {
  return std::accumulate(sweeps.begin(), sweeps.end(), std::size_t{0},
                         [](std::size_t sum, const BallSet::Sweep& one) { return sum + one.targets_deg.size(); });
}

std::vector<Sense> senses_of(const Observations& data) {
  std::vector<Sense> senses;
  for (std::size_t s = 0; s < kSenseNames.size(); ++s)
    if (const auto sense = static_cast<Sense>(s); std::ranges::find(data.sense, sense) != data.sense.end())
      senses.push_back(sense);
  return senses;
}

/// From which side the rotary axes come to the first pose of a set that is measured behind the readings.
PerAxis<int> sides_at_start(const Observations& data, const laser::Reading& first) {
  const std::size_t last = last_row(data);
  PerAxis<int> side = data.through_chain[last].approach;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (first.angle_deg[a] != data.position_mm[last][a])
      side[a] = first.angle_deg[a] > data.position_mm[last][a] ? 1 : -1;
  side[index_of(first.axis)] = static_cast<int>(first.approach);
  return side;
}

/// The set at that place, as far as it is within reach.
BallSet set_at(const Observations& data, const BallPlace& at, const std::vector<BallSet::Sweep>& wanted, int run,
               double pose_s) {
  const std::map<Vector3, Vector3> places = places_of(data, at, wanted);
  BallSet set;
  set.sweeps = within_reach(data, wanted, places);
  set.tool_mm = at.tool_mm;
  if (const auto zero = places.find(Vector3{}); zero != places.end()) set.place_mm = zero->second;
  double time_s = 0.0;
  for (const BallSet::Sweep& sweep : set.sweeps)
    for (const int approach : {1, -1})
      for (std::size_t i = 0; i < sweep.targets_deg.size(); ++i) {
        const double target_deg = sweep.targets_deg[approach > 0 ? i : sweep.targets_deg.size() - 1 - i];
        laser::Reading reading = reading_at(data, at, sweep.axis, angles_at(sweep, target_deg));
        reading.position_mm = places.at(reading.angle_deg);
        for (double& mm : reading.position_mm) mm = to_micrometre(mm);
        reading.approach = static_cast<Approach>(approach);
        reading.run = run;
        reading.time_s = time_s += pose_s;
        for (const Sense sense : senses_of(data)) {
          reading.sense = sense;
          set.readings.push_back(reading);
        }
      }
  if (!set.readings.empty()) set.side = sides_at_start(data, set.readings.front());
  return set;
}

/// ", here up to +-22.5 deg," where the travel of the axis ends before the opposite of a target.
std::string widest_pair_text(const BallSet::Sweep& sweep) {
  const double widest_deg = std::min(-sweep.targets_deg.front(), sweep.targets_deg.back());
  return sweep.targets_deg.front() == -sweep.targets_deg.back() ? ""
                                                                : fmt::format(", here up to +-{:g} deg,", widest_deg);
}

bool head_turns(const Observations& data) {
  const std::string& letters = data.machine.rotary_configuration;
  return letters.find_first_of("ABC", letters.find('T')) != std::string::npos;
}

/// A tool that is longer by so much along itself, by default along -Z; nothing where it would be too short.
std::optional<Vector3> lengthened(const Vector3& tool_mm, double by_mm) {
  const double length_mm = std::hypot(tool_mm[0], tool_mm[1], tool_mm[2]);
  if (length_mm + by_mm < kShortestTool_mm) return std::nullopt;
  if (length_mm == 0.0) return Vector3{0.0, 0.0, -by_mm};
  Vector3 longer = tool_mm;
  for (double& mm : longer) mm *= (length_mm + by_mm) / length_mm;
  return longer;
}

class Options {
 public:
  Options(const Observations& data, const MeasuringTimes& times)
      : data_(data), times_(times), tilting_(tilting_axis(data)), wanted_(wanted_sweeps(data, tilting_)) {}

  std::vector<MeasurementProposal> all() {
    const BallPlace now = present_place(data_);
    add(now, times_.start_minutes, "at the same place with the same tool",
        fmt::format("Pairs of + and - angles of {}{} separate the odd part of an error in that angle, such as a sine, "
                    "from its even part.",
                    letter_of_tilting(), widest_pair_text(wanted_.front())));
    if (head_turns(data_)) other_tool(now);
    for (const Axis along : kAllAxes) other_place(now, along);
    return std::move(options_);
  }

 private:
  [[nodiscard]] char letter_of_tilting() const { return data_.letter(tilting_); }

  /// Whether enough of it is within reach.
  bool add(const BallPlace& at, double set_up_minutes, std::string condition, std::string why) {
    MeasurementProposal one;
    one.first_run = 1 + *std::ranges::max_element(data_.run);
    BallSet set = set_at(data_, at, wanted_, one.first_run, times_.pose_s);
    const std::size_t poses = poses_in(set.sweeps);
    if (set.readings.empty() || static_cast<double>(poses) < kMostPoses * static_cast<double>(poses_now_)) return false;
    if (options_.empty()) poses_now_ = poses;
    set.why = std::move(why);
    one.ball = std::move(set);
    one.axis = tilting_;
    one.sense = data_.sense.front();
    one.condition = std::move(condition);
    one.set_up_minutes = set_up_minutes;
    options_.push_back(std::move(one));
    return true;
  }

  void other_tool(const BallPlace& now) {
    for (const double by_mm : {kOtherLength_mm, -kOtherLength_mm})
      if (const auto tool_mm = lengthened(now.tool_mm, by_mm);
          tool_mm && add({now.point_mm, *tool_mm}, times_.tool_minutes,
                         fmt::format("at the same place with a tool that is {:g} mm {}", std::abs(by_mm),
                                     by_mm > 0.0 ? "longer" : "shorter"),
                         "Bending in proportion to the length of the tool and the angles of the axes next to it change "
                         "with that length; a shift of an axis line does not."))
        return;
  }

  void other_place(const BallPlace& now, Axis along) {
    for (const double by_mm : kMoves_mm) {
      BallPlace at = now;
      at.point_mm[index_of(along)] += by_mm;
      if (add(at, times_.ball_minutes,
              fmt::format("at a second place, moved by {:+g} mm along {} only, with the same tool", by_mm,
                          letter_of(along)),
              fmt::format("Scale, squareness and all else that grows with the position of {} change with the place; "
                          "errors of rotary "
                          "axes that carry the tool do not.",
                          letter_of(along))))
        return;
    }
  }

  const Observations& data_;
  const MeasuringTimes& times_;
  Axis tilting_;
  std::vector<BallSet::Sweep> wanted_;
  std::size_t poses_now_ = 0;
  std::vector<MeasurementProposal> options_;
};

}  // namespace

std::vector<MeasurementProposal> ball_options(const Observations& data, const MeasuringTimes& times) {
  if (data.balls_mm.empty() || data.rotary_axes.empty()) return {};
  return Options(data, times).all();
}

}  // namespace ecs::model
