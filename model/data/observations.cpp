#include "model/data/observations.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/random.hpp"
#include "kinematics/machine_pose.hpp"
#include "laser/import/time.hpp"
#include "model/data/motions.hpp"
#include "model/data/sensor_history.hpp"
#include "model/data/zeros.hpp"
#include "params/machine.hpp"

namespace ecs::model {
namespace {

using laser::MeasurementSet;
using laser::Reading;

/// A ball has three unknowns in the directions of one angle.
constexpr std::size_t kFewestPoses = 3;
/// Less of an error in a reading is the rounding of sines.
constexpr double kLeastShare = 1e-9;

/// The path of each reading of a set.
struct Paths {
  std::vector<Path> all;
  std::vector<std::size_t> of;  ///< per reading, from 1; 0: none
  std::vector<double> along;    ///< per reading
};

Paths paths_of(const MeasurementSet& set) {
  Paths paths;
  paths.of.assign(set.readings.size(), 0);
  paths.along.assign(set.readings.size(), kNotMeasured);
  std::map<std::string, std::size_t, std::less<>> known;
  for (std::size_t k = 0; k < set.readings.size(); ++k) {
    const Reading& r = set.readings[k];
    const auto text = r.text_extras.find(kPathColumn);
    if (text == r.text_extras.end() || r.rotary) continue;
    const auto [found, is_new] = known.try_emplace(text->second, 0);
    if (is_new)
      if (auto path = path_in(text->second)) {
        paths.all.push_back(std::move(*path));
        found->second = paths.all.size();
      }
    paths.of[k] = found->second;
    if (paths.of[k] > 0) paths.along[k] = place_on(paths.all[paths.of[k] - 1], r.position_mm, 0).along;
  }
  return paths;
}

/// The line that a reading is of: its path, axis, sense and where the other axes stood.
auto line_of(const MeasurementSet& set, const Paths& paths, std::size_t k) {
  const Reading& r = set.readings[k];
  Vector3 parked = r.rotary ? r.angle_deg : r.position_mm;
  parked[index_of(r.axis)] = 0.0;
  if (paths.of[k] > 0) parked = {};
  return std::make_tuple(paths.of[k], r.axis, r.sense, parked);
}

/// By run the number of the clock that its times are of. One instrument cannot measure two runs of a line at once:
/// where passes of a line and approach overlap in time the clock restarts, with every run that begins before the one
/// before it has ended. Empty: one clock for all.
std::map<int, int> clocks_of(const MeasurementSet& set, const Paths& paths) {
  struct Stretch {
    double begin_s = 0.0, end_s = 0.0;
  };
  using Runs = std::map<int, Stretch>;
  std::map<decltype(line_of(set, paths, 0)), std::map<Approach, Runs>> lines;
  std::map<int, int> clock;
  for (std::size_t k = 0; k < set.readings.size(); ++k) {
    const Reading& r = set.readings[k];
    clock[r.run] = 0;
    if (!r.time_s) continue;
    Runs& runs = lines[line_of(set, paths, k)][r.approach];
    Stretch& pass = runs.try_emplace(r.run, Stretch{*r.time_s, *r.time_s}).first->second;
    pass = {std::min(pass.begin_s, *r.time_s), std::max(pass.end_s, *r.time_s)};
  }
  const auto overlaps = [](const Stretch& earlier, const Stretch& later) {
    return later.begin_s < earlier.end_s || later.begin_s == earlier.begin_s;
  };
  bool any_overlap = false;
  std::set<int> restarts;
  for (const auto& [line, by_approach] : lines) {
    Runs runs;  // of both approaches
    for (const auto& [approach, passes] : by_approach) {
      std::vector<Stretch> in_time;
      for (const auto& [run, pass] : passes) {
        in_time.push_back(pass);
        Stretch& all = runs.try_emplace(run, pass).first->second;
        all = {std::min(all.begin_s, pass.begin_s), std::max(all.end_s, pass.end_s)};
      }
      std::ranges::sort(in_time, {}, [](const Stretch& one) { return std::pair(one.begin_s, one.end_s); });
      any_overlap = any_overlap || std::ranges::adjacent_find(in_time, overlaps) != in_time.end();
    }
    for (auto run = runs.begin(); run != runs.end(); ++run)
      if (run != runs.begin() && overlaps(std::prev(run)->second, run->second)) restarts.insert(run->first);
  }
  if (!any_overlap) return {};
  int number = 0;
  for (auto& [run, own] : clock) own = number += restarts.contains(run) ? 1 : 0;
  return clock;
}

/// Everything a reading is, in an order of its own: two readings that compare equal are interchangeable. Readings at
/// one place of a pass stay as they follow each other in the file: in order of size, neighbours would differ too
/// little.
/// @param clocks  as clocks_of(); null: some reading has no time
auto key_of(const MeasurementSet& set, const Paths& paths, std::size_t k, const std::map<int, int>* clocks) {
  const Reading& r = set.readings[k];
  const double along = paths.of[k] > 0 ? paths.along[k] : laser::target_of(r);
  const double travelled = along * (r.approach == Approach::reverse ? -1.0 : 1.0);
  const Vector3 place = r.rotary ? r.position_mm : Vector3{};
  return std::make_tuple(clocks && !clocks->empty() ? clocks->at(r.run) : 0, clocks ? *r.time_s : 0.0,
                         line_of(set, paths, k), r.run, -static_cast<int>(r.approach), travelled, place, r.feed_mm_min,
                         r.load_kg, r.row, r.error);
}

std::vector<std::size_t> canonical_order(const MeasurementSet& set, const Paths& paths,
                                         const std::map<int, int>& clocks) {
  const bool all_timed = std::ranges::all_of(set.readings, [](const Reading& r) { return r.time_s.has_value(); });
  const std::map<int, int>* const in_time = all_timed ? &clocks : nullptr;
  std::vector<std::size_t> order(set.readings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return key_of(set, paths, a, in_time) < key_of(set, paths, b, in_time);
  });
  return order;
}

/// A column of optional cells; empty if no reading has one.
template <class Get>
Column column_of(const MeasurementSet& set, const std::vector<std::size_t>& order, Get get) {
  Column column;
  bool any = false;
  column.reserve(order.size());
  for (const std::size_t k : order) {
    const std::optional<double> value = get(set.readings[k]);
    any = any || value.has_value();
    column.push_back(value.value_or(kNotMeasured));
  }
  if (!any) column.clear();
  return column;
}

template <class Map>
std::optional<double> found_in(const Map& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? std::nullopt : std::optional(found->second);
}

/// Times count from the first reading from here on; what they were is kept as the origin.
void from_first(Observations& data, const MeasurementSet& set) {
  if (data.time_s.empty()) return;
  double first = std::numeric_limits<double>::infinity();
  for (const double t : data.time_s)
    if (t < first) first = t;
  for (double& t : data.time_s) t -= first;
  data.origin.time_s = first;
  const auto begun = laser::metadata_value(set, laser::kBegun);
  if (const auto begun_s = begun ? laser::seconds_in(*begun) : std::nullopt)
    data.origin.date = laser::date_time_text(*begun_s + first);
}

void take_first_conditions(Observations& data) {
  for (const auto& [sensor, column] : data.sensors_degC) {
    const auto first = std::ranges::find_if(column, [](double degC) { return !std::isnan(degC); });
    if (first != column.end()) data.origin.sensors_degC[sensor] = *first;
  }
  if (!data.pressure_hPa.empty() && !data.humidity_pct.empty() && data.sensors_degC.contains("t_air_degC"))
    data.origin.air = Origin::Air{};
}

/// Effects count from the origin of a model instead of the first of these readings; what the model does not say stays.
void take_origin(Observations& data, const Origin& of_model) {
  const Origin own = std::exchange(data.origin, of_model);
  data.origin.sensors_degC.insert(own.sensors_degC.begin(), own.sensors_degC.end());
  if (!data.origin.air) data.origin.air = own.air;
  if (!own.time_s) return;
  if (!of_model.time_s) {
    data.origin.time_s = own.time_s;
    data.origin.date = own.date;
    return;
  }
  data.first_since_s = *own.time_s - *of_model.time_s;
  if (!own.date.empty() && !of_model.date.empty()) {
    data.first_since_s = *laser::seconds_in(own.date) - *laser::seconds_in(of_model.date);
    return;
  }
  const std::string_view without = !own.date.empty()        ? "the readings of the fit have no date"
                                   : !of_model.date.empty() ? "these readings have no date"
                                                            : "neither these readings nor those of the fit have a date";
  data.clock_note = fmt::format(
      "no common clock: {}. time_s is assumed to have the same origin as in the readings of the fit, which begin at "
      "{:g} s; these begin at {:g} s. A line \"# {}: 2026-01-31 08:00:00\" in a measurement file gives the date of "
      "time_s = 0",
      without, *of_model.time_s, *own.time_s, laser::kBegun);
}

void take_machine(Observations& data, const std::optional<params::Machine>& machine) {
  if (!machine) {
    data.notes.emplace_back("no machine file: positions are measured from 0, and no lever arms are known");
    return;
  }
  data.machine = *machine;
  data.lines = params::measurement_lines_of(*machine);
  for (const Axis a : kAllAxes)
    if (machine->axes[index_of(a)]) data.datum_mm[index_of(a)] = machine->axes[index_of(a)]->datum_mm;
  if (const auto chain = params::chain_of(*machine))
    if (const auto terms = terms_of(*chain, Convention::iso, CurveKind::carriage)) data.terms = *terms;
}

void take_columns(Observations& data, const MeasurementSet& set, const std::vector<std::size_t>& order) {
  data.reading = column_of(set, order, [](const Reading& r) { return std::optional(r.error); });
  data.time_s = column_of(set, order, [](const Reading& r) { return r.time_s; });
  from_first(data, set);
  data.feed_mm_min = column_of(set, order, [](const Reading& r) { return r.feed_mm_min; });
  data.load_kg = column_of(set, order, [](const Reading& r) { return r.load_kg; });
  data.travel_since_reversal_mm = column_of(set, order, [](const Reading& r) { return r.travel_since_reversal_mm; });
  data.pressure_hPa = column_of(set, order, [](const Reading& r) { return r.pressure_hPa; });
  data.humidity_pct = column_of(set, order, [](const Reading& r) { return r.humidity_pct; });
  for (const std::string& sensor : laser::sensor_names_of(set))
    data.sensors_degC[sensor] =
        column_of(set, order, [&](const Reading& r) { return found_in(r.sensors_degC, sensor); });
  std::vector<std::string> extras;
  for (const Reading& r : set.readings)
    for (const auto& [name, value] : r.extras)
      if (std::ranges::find(extras, name) == extras.end()) extras.push_back(name);
  for (const std::string& extra : extras)
    data.extras[extra] = column_of(set, order, [&](const Reading& r) { return found_in(r.extras, extra); });
  take_first_conditions(data);
}

/// Readings of a circle at nearly the same angle are at one place: its passes have about equal steps, each direction
/// with a phase of its own.
void take_places(Observations& data) {
  constexpr double kTurn_deg = 360.0;
  data.place = data.along;
  std::map<std::tuple<std::size_t, int, int>, double> readings;  // of a pass
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.on_path(k)) readings[{data.path[k], data.run[k], data.approach[k]}] += 1.0;
  std::map<std::size_t, double> steps;  // in a turn, by path
  for (const auto& [pass, count] : readings) steps[std::get<0>(pass)] = std::max(steps[std::get<0>(pass)], count);
  const auto on_circle = [&](std::size_t k) { return data.on_path(k) && data.path_of(k).kind == PathKind::circle; };
  const auto in_steps = [&](std::size_t k) { return data.along[k] / kTurn_deg * steps[data.path[k]]; };
  std::map<std::pair<std::size_t, int>, std::complex<double>> phase;  // by path and direction
  for (std::size_t k = 0; k < data.size(); ++k)
    if (on_circle(k)) phase[{data.path[k], data.approach[k]}] += std::polar(1.0, 2.0 * std::numbers::pi * in_steps(k));
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (!on_circle(k)) continue;
    const double off = std::arg(phase[{data.path[k], data.approach[k]}]) / (2.0 * std::numbers::pi);
    const double count = steps[data.path[k]], number = std::round(in_steps(k) - off);
    data.place[k] = std::fmod(number + count, count) * kTurn_deg / count;
  }
}

double apart_mm(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

void put_on_paths(Observations& data, Paths paths, const std::vector<std::size_t>& order) {
  data.paths = std::move(paths.all);
  for (const std::size_t k : order) {
    data.path.push_back(paths.of[k]);
    data.along.push_back(paths.along[k]);
  }
  take_places(data);
  set_motions(data);
}

/// The file says where the linear axes stood: writers fill the columns of what was not given with 0.
bool has_places(const MeasurementSet& set) {
  return std::ranges::any_of(set.readings, [](const Reading& r) { return r.position_mm != Vector3{}; });
}

double number_or_0(const Reading& r, std::string_view column) {
  const auto found = r.extras.find(column);
  return found == r.extras.end() ? 0.0 : found->second;
}

double unless_rounding(double share) { return std::abs(share) < kLeastShare ? 0.0 : share; }

double share_along(const Vector3& a, const Vector3& b) {
  return unless_rounding(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

/// The tool point moves by this under 1 um or 1 um/m of an error [um].
Vector3 moved_by(const kinematics::Gain& gain, const Vector3& place_mm) {
  Vector3 moved = gain.at_0;
  for (std::size_t l = 0; l < kAxes; ++l)
    for (std::size_t d = 0; d < kAxes; ++d) moved[d] += gain.slope[l][d] * place_mm[l];
  return moved;
}

/// How the errors of the machine's axes reach a reading, in the directions of the bed, or of the workpiece where the
/// sensor turns with it.
/// @param place_mm  of the linear axes
ThroughChain through_chain_of(const Reading& r, const Vector3& place_mm, const kinematics::JointMachine& machine,
                              const kinematics::MachinePose& pose) {
  const bool turns_along = number_or_0(r, kOnWorkpiece) != 0.0;
  Vector3 direction{};
  direction[index_of(direction_of(r.sense))] = 1.0;
  if (!turns_along) direction = pose.bed[index_of(direction_of(r.sense))];
  ThroughChain chain;
  for (const kinematics::ChainJoint& one : machine.chain) {
    if (!kinematics::is_rotary(one.joint)) continue;
    const std::size_t j = index_of(one.joint);
    for (std::size_t s = 0; s < 2 * kAxes; ++s) {
      Vector3 moved = moved_by(pose.gain[j][s], place_mm);
      if (is_rotation(r.sense)) moved = s < kAxes ? Vector3{} : pose.about[j][s - kAxes];
      chain.of_axis[j - kAxes][s] = share_along(moved, direction);
    }
  }
  if (is_rotation(r.sense)) return chain;
  for (std::size_t l = 0; l < kAxes; ++l) {
    constexpr double kMmPerM = 1000.0;
    chain.of_linear[l] = place_mm[l] / kMmPerM * share_along(moved_by(pose.gain[l][l], place_mm), direction);
    chain.of_linear[kAxes + l] = share_along(moved_by(pose.squareness[l], place_mm), direction);
  }
  for (std::size_t d = 0; d < kAxes; ++d) {
    chain.of_workpiece[d] = unless_rounding(-direction[d]);
    chain.of_tool[d] = share_along(pose.tool[d], direction);
  }
  return chain;
}

/// Where the linear axes stand while the tool is at a point of the workpiece (Cramer's rule); nothing if they cannot
/// reach every point at these angles.
std::optional<Vector3> linear_axes_at(const kinematics::MachinePose& pose, const Vector3& point_mm) {
  constexpr double kLeastVolume = 1e-6;  // of directions of length 1
  const auto volume = [](const Vector3& a, const Vector3& b, const Vector3& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  const std::array<Vector3, kAxes>& along = pose.tool_mm.slope;
  const double whole = volume(along[0], along[1], along[2]);
  if (std::abs(whole) < kLeastVolume) return std::nullopt;
  Vector3 place_mm{}, rest{};
  for (std::size_t d = 0; d < kAxes; ++d) rest[d] = point_mm[d] - pose.tool_mm.at_0[d];
  for (std::size_t l = 0; l < kAxes; ++l) {
    std::array<Vector3, kAxes> columns = along;
    columns[l] = rest;
    place_mm[l] = volume(columns[0], columns[1], columns[2]) / whole;
  }
  return place_mm;
}

/// Angles that the machine does not have.
void take_travels(Observations& data) {
  constexpr double kRounding_deg = 0.01;
  for (const Axis a : kAllAxes) {
    const auto& axis = data.machine.rotary[index_of(a)];
    if (axis && axis->travel_deg[1] - axis->travel_deg[0] >= 360.0) continue;  // counted from anywhere
    for (std::size_t k = 0; k < data.size(); ++k) {
      const double angle_deg = data.position_mm[k][index_of(a)];
      const bool beyond =
          axis ? angle_deg < axis->travel_deg[0] - kRounding_deg || angle_deg > axis->travel_deg[1] + kRounding_deg
               : angle_deg != 0.0;
      if (!beyond) continue;
      data.not_followed = axis ? fmt::format("{} at {:g} deg is beyond its travel, {:g} … {:g} deg in the machine file",
                                             data.letter(a), angle_deg, axis->travel_deg[0], axis->travel_deg[1])
                               : fmt::format("{} at {:g} deg: the machine has no such axis", data.letter(a), angle_deg);
      return;
    }
  }
}

/// Numbers of the readings, in the order of the file.
std::vector<std::size_t> in_file_order(const Observations& data) {
  std::vector<std::size_t> order(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) order[data.file_order[k]] = k;
  return order;
}

/// The ball changes while an axis goes from one angle to the next, and no set of several balls does. With several balls
/// the axis goes through the same angles with each; with wrong pivots the point moves on from angle to angle.
/// @param angles  of each ball  @param set_up  of each reading
bool ball_changes_in_sweep(const Observations& data, const std::vector<std::set<Vector3>>& angles,
                           const std::vector<double>& set_up) {
  const auto parked = [](Vector3 angle, Axis moved) {
    angle[index_of(moved)] = 0.0;
    return angle;
  };
  const auto sweep = [&](std::size_t k) {
    return std::make_tuple(data.axis[k], data.run[k], data.approach[k], set_up[k],
                           parked(data.position_mm[k], data.axis[k]));
  };
  const auto in_sweep = [&](std::size_t ball_of, std::size_t k) {  // angles of that ball, of the axis that moves in k
    std::vector<double> own;
    for (const Vector3& angle : angles[static_cast<std::size_t>(data.through_chain[ball_of].ball) - 1])
      if (parked(angle, data.axis[k]) == parked(data.position_mm[k], data.axis[k]))
        own.push_back(angle[index_of(data.axis[k])]);
    return own;
  };
  const auto pass_through = [](const std::vector<double>& one, const std::vector<double>& other) {
    if (other.empty()) return false;
    const auto ends = std::minmax_element(other.begin(), other.end());
    const auto is_among = [&](double angle) { return angle >= *ends.first && angle <= *ends.second; };
    return std::ranges::count_if(one, is_among) >= static_cast<std::ptrdiff_t>(kFewestPoses);
  };
  const std::vector<std::size_t> order = in_file_order(data);
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::size_t before = order[i - 1], now = order[i];
    if (data.through_chain[now].ball == data.through_chain[before].ball || sweep(now) != sweep(before)) continue;
    const std::vector<double> last = in_sweep(before, now), next = in_sweep(now, now);
    if (!pass_through(last, next) || !pass_through(next, last)) return true;
  }
  return false;
}

/// By reading the number of its set-up, in which the ball or the reference is elsewhere; all 0 unless each set-up has
/// the poses that a ball needs.
std::vector<double> set_ups_of(const Observations& data) {
  const auto column = data.extras.find("set_up");
  if (column == data.extras.end()) return std::vector<double>(data.size(), 0.0);
  std::map<double, std::set<Vector3>> poses;
  for (std::size_t k = 0; k < data.size(); ++k) poses[column->second[k]].insert(data.position_mm[k]);
  const bool few = std::ranges::any_of(poses, [](const auto& of) { return of.second.size() < kFewestPoses; });
  return few || std::ranges::any_of(column->second, [](double number) { return std::isnan(number); })
             ? std::vector<double>(data.size(), 0.0)
             : column->second;
}

/// Which ball each reading is of: the tool stands at its place in the frame of the workpiece, in each set-up at
/// another. Where that is another at nearly every pose, pivots or tool offset are not those that the linear axes
/// followed.
void take_balls(Observations& data, const std::vector<Vector3>& point_mm) {
  std::vector<std::set<Vector3>> angles;
  const std::vector<double> set_up = set_ups_of(data);
  std::vector<double> of_ball;  // set-up
  for (std::size_t k = 0; k < data.size(); ++k) {
    std::size_t ball = 0;
    while (ball < of_ball.size() &&
           (of_ball[ball] != set_up[k] || apart_mm(data.balls_mm[ball], point_mm[k]) >= kSameBall_mm))
      ++ball;
    if (ball == of_ball.size()) {
      data.balls_mm.push_back(point_mm[k]);
      of_ball.push_back(set_up[k]);
      angles.emplace_back();
    }
    angles[ball].insert(data.position_mm[k]);
    data.through_chain[k].ball = static_cast<int>(ball) + 1;
  }
  double farthest_mm = 0.0;
  for (const Vector3& one : data.balls_mm) farthest_mm = std::max(farthest_mm, apart_mm(one, data.balls_mm.front()));
  const bool few = std::ranges::any_of(angles, [](const auto& poses) { return poses.size() < kFewestPoses; });
  if (few || ball_changes_in_sweep(data, angles, set_up))
    data.not_followed = fmt::format(
        "with the given pivots, directions and tool offset, the tool is at {} points of the workpiece, up to {:.1f} mm "
        "apart, while an axis turns: the linear axes did not follow a ball. Give the signs of the angles (ISO 841), "
        "the pivots of the control (pivot_mm) and the position of the ball in the spindle (tool_x_mm, tool_y_mm, "
        "tool_z_mm)",
        data.balls_mm.size(), farthest_mm);
}

/// From which side every rotary axis came to its angle, in the order of the file: a standing axis keeps the lost motion
/// with which it arrived. One that has not moved yet is taken as referenced, that is as come forward.
void take_sides(Observations& data, const MeasurementSet& set) {
  PerAxis<int> side{1, 1, 1};
  Vector3 last = set.readings.front().angle_deg;
  for (const std::size_t k : in_file_order(data)) {
    const Reading& r = set.readings[data.file_order[k]];
    for (std::size_t a = 0; a < kAxes; ++a)
      if (r.angle_deg[a] != last[a]) side[a] = r.angle_deg[a] > last[a] ? 1 : -1;
    last = r.angle_deg;
    data.through_chain[k].approach = side;
    side[index_of(r.axis)] = data.through_chain[k].approach[index_of(r.axis)] = static_cast<int>(r.approach);
  }
}

/// Where the linear axes stood, and what follows from it on a machine whose pivots are known.
void take_chain(Observations& data, const MeasurementSet& set, const std::optional<params::Machine>& machine) {
  const bool any_translation = std::ranges::any_of(data.sense, [](Sense sense) { return !is_rotation(sense); });
  if (machine) {
    data.machine.rotary_configuration = machine->rotary_configuration;
    data.machine.rotary = machine->rotary;
  }
  if (!has_places(set) || !any_translation) return;
  for (const std::size_t k : data.file_order) data.place_mm.push_back(set.readings[k].position_mm);
  const bool at_tip = std::ranges::any_of(set.readings, [](const Reading& r) { return number_or_0(r, kAtTip) != 0.0; });
  auto joints = machine ? params::joint_machine_of(*machine) : std::nullopt;
  if (!joints) {
    data.notes.emplace_back(
        "no machine file with rotary axes: readings are interpreted as errors of the axis itself, and location errors "
        "cannot be tried");
    return;
  }
  data.ball_machine = std::make_shared<const params::Machine>(*machine);
  data.notes.emplace_back(
      "of the errors of X, Y and Z only scale and squareness can be tried (effect linear_axes): uncompensated "
      "straightness appears as waves of the rotary axes");
  std::map<std::pair<Vector3, Vector3>, kinematics::MachinePose> poses;  // by angles and tool offset
  std::vector<Vector3> point_mm;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const Reading& r = set.readings[data.file_order[k]];
    for (std::size_t d = 0; d < kAxes; ++d) joints->tool_offset_mm[d] = number_or_0(r, kToolColumns[d]);
    const auto [found, is_new] = poses.try_emplace({r.angle_deg, joints->tool_offset_mm});
    if (is_new) found->second = kinematics::pose_at(*joints, r.angle_deg);
    if (at_tip) data.place_mm[k] = linear_axes_at(found->second, r.position_mm).value_or(r.position_mm);
    data.through_chain.push_back(through_chain_of(r, data.place_mm[k], *joints, found->second));
    data.through_chain.back().tool = numbered_place(data.tools_mm, joints->tool_offset_mm, kSameTool_mm);
    point_mm.push_back(found->second.tool_mm.at(data.place_mm[k]));
  }
  take_balls(data, point_mm);
  take_travels(data);
  take_sides(data, set);
  for (const bool moved : {true, false})
    for (const Axis a : kAllAxes)
      if (joints->chain.has(static_cast<kinematics::Joint>(kAxes + index_of(a))) &&
          (std::ranges::find(data.axis, a) != data.axis.end()) == moved)
        data.rotary_axes.push_back(a);
}

}  // namespace

int numbered_place(std::vector<Vector3>& seen_mm, const Vector3& place_mm, double same_mm) {
  for (std::size_t i = seen_mm.size(); i-- > 0;)
    if (apart_mm(seen_mm[i], place_mm) < same_mm) return static_cast<int>(i) + 1;
  seen_mm.push_back(place_mm);
  return static_cast<int>(seen_mm.size());
}

std::string_view Observations::reading_unit() const {
  const auto rotations = std::ranges::count_if(sense, [](Sense s) { return is_rotation(s); });
  if (rotations == 0) return "um";
  return static_cast<std::size_t>(rotations) == sense.size() ? "um/m" : kBothUnits;
}

Observations observations_of(const MeasurementSet& set, const KnownTables& tables,
                             const std::optional<params::Machine>& machine) {
  Observations data;
  Paths paths = paths_of(set);
  const std::map<int, int> clocks = clocks_of(set, paths);
  const std::vector<std::size_t> order = canonical_order(set, paths, clocks);
  data.file_order = order;
  data.rotary = !set.readings.empty() && set.readings.front().rotary;
  for (const std::size_t k : order) {
    const Reading& r = set.readings[k];
    data.row.push_back(r.row > 0 ? r.row : static_cast<int>(k) + 1);
    data.axis.push_back(r.axis);
    data.sense.push_back(r.sense);
    data.run.push_back(r.run);
    data.approach.push_back(static_cast<int>(r.approach));
    data.position_mm.push_back(data.rotary ? r.angle_deg : r.position_mm);
    data.has_compensated_column = data.has_compensated_column || r.compensated.has_value();
    data.compensated.push_back(r.compensated.value_or(tables.map.has_value()));
  }
  take_columns(data, set, order);
  if (tables.origin) take_origin(data, *tables.origin);
  const bool turned = std::ranges::any_of(
      set.readings, [&](const Reading& r) { return r.angle_deg != set.readings.front().angle_deg; });
  if (!data.rotary && turned)
    for (const std::size_t k : order) data.pose_deg.push_back(set.readings[k].angle_deg);
  if (!data.rotary) take_machine(data, machine);
  if (data.rotary) take_chain(data, set, machine);
  data.map = tables.map;
  data.known = tables.components;
  data.history = sensor_history_of(data);
  if (data.history) {
    data.in_history.resize(data.size());
    std::iota(data.in_history.begin(), data.in_history.end(), std::size_t{0});
  }
  set_natural_axes(data);
  if (paths.all.empty() && (!data.rotary || data.extras.contains("set_up"))) set_lines(data);
  if (paths.all.empty() && !data.rotary) set_sessions(data, set, clocks);
  if (!paths.all.empty()) put_on_paths(data, std::move(paths), order);
  return data;
}

void set_natural_axes(Observations& data) {
  for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
    const Axis own = direction_of(static_cast<Sense>(s));
    std::optional<Axis> first;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (static_cast<std::size_t>(data.sense[k]) == s && first != own &&
          (!first || data.axis[k] < *first || data.axis[k] == own))
        first = data.axis[k];
    data.natural_axes[s] = first.value_or(own);
  }
}

const Observations& Observations::motions() const { return moved ? moved->rows : *this; }

namespace {

template <class T>
std::vector<T> taken(const std::vector<T>& from, const std::vector<std::size_t>& chosen) {
  std::vector<T> part;
  if (from.empty()) return part;
  part.reserve(chosen.size());
  for (const std::size_t k : chosen) part.push_back(from[k]);
  return part;
}

}  // namespace

std::vector<std::size_t> even_choice(std::size_t readings, std::size_t wanted) {
  constexpr std::uint64_t kSeed = 20261120;  // any number
  std::vector<std::size_t> chosen;
  std::mt19937_64 random(kSeed);
  const double step = static_cast<double>(readings) / static_cast<double>(wanted);
  for (std::size_t i = 0; i < wanted; ++i) {
    const double place = (static_cast<double>(i) + uniform(random)) * step;
    const auto k = std::min(static_cast<std::size_t>(place), readings - 1);
    if (chosen.empty() || k > chosen.back()) chosen.push_back(k);
  }
  return chosen;
}

Observations subset(const Observations& all, const std::vector<std::size_t>& chosen) {
  Observations part = all;
  const auto keep = [&](auto&... columns) { ((columns = taken(columns, chosen)), ...); };
  keep(part.row, part.file_order, part.axis, part.sense, part.run, part.approach, part.position_mm, part.place_mm,
       part.pose_deg, part.through_chain, part.compensated, part.path, part.along, part.place, part.of_moved,
       part.aside, part.in_history, part.line);
  keep(part.reading, part.of_map, part.time_s, part.feed_mm_min, part.load_kg, part.travel_since_reversal_mm,
       part.pressure_hPa, part.humidity_pct);
  for (auto* columns : {&part.sensors_degC, &part.extras})
    for (auto& each : *columns) keep(each.second);
  return part;
}

Observations counted_once(Observations data, const MeasurementSet& set) {
  const auto same = [&](std::size_t a, std::size_t b) {  // but for the place in the file
    const Reading &one = set.readings[data.file_order[a]], &other = set.readings[data.file_order[b]];
    if (one.error != other.error || one.position_mm != other.position_mm || one.time_s != other.time_s) return false;
    Reading moved = one;
    moved.row = other.row;
    moved.line = other.line;
    return moved == other;
  };
  std::vector<std::size_t> by_value(data.size());
  std::iota(by_value.begin(), by_value.end(), std::size_t{0});
  std::ranges::stable_sort(by_value, {}, [&](std::size_t k) {
    const Reading& r = set.readings[data.file_order[k]];
    return std::make_tuple(r.error, r.position_mm, r.angle_deg, r.time_s, r.axis, r.sense, r.run, r.approach);
  });
  std::vector<std::size_t> first;   // of rows that are equal
  std::vector<std::size_t> counts;  // how many there are
  for (const std::size_t k : by_value) {
    if (!first.empty() && same(first.back(), k)) {
      ++counts.back();
    } else {
      first.push_back(k);
      counts.push_back(1);
    }
  }
  std::ranges::sort(first);
  const bool has_times =
      std::ranges::none_of(data.time_s, [](double t) { return std::isnan(t); }) && !data.time_s.empty();
  const bool evenly = std::ranges::all_of(counts, [&](std::size_t n) { return n == counts.front(); });
  const bool a_plan =
      std::ranges::all_of(data.reading, [&](double reading) { return reading == data.reading.front(); });
  if (first.size() == data.size() || a_plan || !(has_times || evenly)) return data;
  const std::size_t dropped = data.size() - first.size();
  data = subset(data, first);
  data.notes.push_back(fmt::format("{} rows are identical to another row: each counts once", dropped));
  return data;
}

}  // namespace ecs::model
