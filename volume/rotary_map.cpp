#include "volume/rotary_map.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "laser/groups.hpp"

namespace ecs::volume {
namespace {

kinematics::Joint rotary_joint(Axis about) { return static_cast<kinematics::Joint>(kAxes + index_of(about)); }

void add_means(RotaryErrors& errors, const laser::MeasurementSet& set, const laser::Group& group, Approach approach,
               const std::vector<double> laser::TargetReadings::*readings) {
  RotaryTable table{rotary_joint(group.axis), group.sense, approach, {}, {}, {}};
  double squares = 0.0, freedom = 0.0;
  std::vector<double> share;
  for (const laser::TargetReadings& target : targets_of(set, group, target_tolerance_mm(set, group)))
    if (const auto mean = laser::mean_of(target.*readings)) {
      table.p_deg.push_back(target.position_mm);
      table.error.push_back(*mean);
      const double count = static_cast<double>((target.*readings).size());
      if (const auto deviation = laser::deviation_of(target.*readings)) {
        squares += *deviation * *deviation * (count - 1.0);
        freedom += count - 1.0;
      }
      share.push_back(1.0 / std::sqrt(count));
    }
  if (freedom > 0.0)  // the scatter of all targets together: a few readings at one tell theirs badly
    for (const double one : share) table.u.push_back(one * std::sqrt(squares / freedom));
  if (!table.p_deg.empty()) errors.tables.push_back(std::move(table));
}

}  // namespace

Result<RotaryErrors> measured_rotary_errors(const laser::MeasurementSet& set) {
  for (const laser::Reading& reading : set.readings)
    if (!reading.rotary)
      return problem_at(set.source, std::max(1, reading.line), 0,
                        fmt::format("expected readings of rotary axes as in the rows before, found the linear axis {}: "
                                    "give linear axes to a map of their own",
                                    ecs::letter_of(reading.axis)));
  RotaryErrors errors;
  for (const laser::Group& group : groups_of(set)) {
    const std::string name = rotary_name(rotary_joint(group.axis), group.sense);
    for (const RotaryTable& table : errors.tables)
      if (table.joint == rotary_joint(group.axis) && table.sense == group.sense)
        return problem_at(set.source, std::max(1, set.readings[group.readings.front()].line), 0,
                          fmt::format("expected {} at one place of the other axes, found a second", name));
    if (has_known_approach(set, group)) {
      add_means(errors, set, group, Approach::forward, &laser::TargetReadings::forward);
      add_means(errors, set, group, Approach::reverse, &laser::TargetReadings::reverse);
    } else {
      add_means(errors, set, group, Approach::unknown, &laser::TargetReadings::undirected);
    }
  }
  return errors;
}

std::string rotary_csv(const RotaryErrors& errors, const std::string& machine) {
  std::string text = machine.empty() ? "" : fmt::format("# machine: {}\n", machine);
  text += "component,approach,p_deg,error,u\n";
  const auto u_text = [](const std::optional<double>& u) { return u ? fmt::format("{:.4f}", *u) : std::string(); };
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < kSenseNames.size(); ++s)
      if (errors.location[r][s] != 0.0 || errors.location_given[r][s])
        text += fmt::format("{}O{},,,{:.4f},{}\n", "XYZABC"[s], "ABC"[r], errors.location[r][s],
                            u_text(errors.location_u[r][s]));
  for (const RotaryTable& table : errors.tables)
    for (std::size_t i = 0; i < table.p_deg.size(); ++i)
      text += fmt::format("{},{},{:.6g},{:.4f},{}\n", rotary_name(table.joint, table.sense),
                          static_cast<int>(table.approach), table.p_deg[i], table.error[i],
                          u_text(table.u.empty() ? std::nullopt : std::optional(table.u[i])));
  return text;
}

}  // namespace ecs::volume
