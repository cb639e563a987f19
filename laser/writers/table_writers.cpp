#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/groups.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

/// Readings at each target, ascending; what is no positioning of one axis is refused.
Result<std::vector<TargetReadings>> positioning_curve(const MeasurementSet& set) {
  const auto groups = groups_of(set);
  if (groups.size() != 1)
    return problem(ProblemKind::refused, groups.empty() ? "expected readings, found none"
                                                        : "expected one axis, one sense and one parked position");
  const Group& group = groups.front();
  if (group.sense != static_cast<Sense>(index_of(group.axis)))
    return problem(ProblemKind::refused, "expected errors along the axis: this file contains positioning only");
  return targets_of(set, group, target_tolerance_mm(set, group));
}

/// Of everything that was read at the target.
double mean_um(const TargetReadings& target) {
  std::vector<double> all = target.forward;
  all.insert(all.end(), target.reverse.begin(), target.reverse.end());
  all.insert(all.end(), target.undirected.begin(), target.undirected.end());
  return mean_of(all).value_or(0.0);
}

/// Between both directions where both were measured.
double middle_um(const TargetReadings& target) {
  const auto forward = mean_of(target.forward);
  const auto reverse = mean_of(target.reverse);
  return forward && reverse ? 0.5 * (*forward + *reverse) : mean_um(target);
}

/// The block of one direction; empty where nothing was measured in it.
std::string block(std::string_view name, const std::vector<TargetReadings>& targets,
                  std::vector<double> TargetReadings::*readings) {
  std::string rows;
  for (const TargetReadings& target : targets)
    if (const auto mean = mean_of(target.*readings))
      rows += fmt::format("{:.6f}\t{:.9f}\r\n", target.position_mm, *mean / kUmPerMm);
  return rows.empty() ? rows : fmt::format("Position   \t{} Directional Avg Error\r\n{}\r\n", name, rows);
}

/// Complete cycles: every target once in each run and direction that occurs.
std::string cycles_fault(const MeasurementSet& set, std::size_t targets) {
  std::map<std::pair<int, Approach>, std::size_t> counts;
  std::set<int> runs;
  std::set<Approach> approaches;
  for (const Reading& reading : set.readings) {
    if (reading.approach == Approach::unknown) return "expected an approach with every reading, found one without";
    ++counts[{reading.run, reading.approach}];
    runs.insert(reading.run);
    approaches.insert(reading.approach);
  }
  if (*runs.begin() != 1 || *runs.rbegin() != static_cast<int>(runs.size()))
    return "expected runs numbered from 1 without a gap";
  for (const int run : runs)
    for (const Approach approach : approaches)
      if (counts[{run, approach}] != targets)
        return fmt::format("expected {} readings in run {} and each direction, found {}", targets, run,
                           counts[{run, approach}]);
  return {};
}

}  // namespace

Result<std::string> to_renishaw_table(const MeasurementSet& set) {
  ECS_TRY(targets, positioning_curve(set));
  if (targets.size() < 2) return problem(ProblemKind::refused, "expected at least two targets");
  const double first_mm = targets.front().position_mm;
  const double last_mm = targets.back().position_mm;
  const double step_mm = (last_mm - first_mm) / static_cast<double>(targets.size() - 1);
  std::string rows;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double position_mm = targets[i].position_mm;
    if (std::abs(position_mm - first_mm - static_cast<double>(i) * step_mm) > 1e-3)
      return problem(ProblemKind::refused, "expected targets a constant step apart, {} mm is not",
                     shortest(position_mm));
    rows += fmt::format("{:<4}{:15.6f}{:15.9f}\r\n", i + 1, position_mm, -mean_um(targets[i]) / kUmPerMm);
  }
  return fmt::format(
      "Compensation start   : {:.6f}\r\nCompensation end     : {:.6f}\r\nCompensation spacing : {:.6f}\r\n"
      "No.     Axis position        Combined\r\n{}",
      first_mm, last_mm, step_mm, rows);
}

Result<std::string> to_api_pos(const MeasurementSet& set) {
  ECS_TRY(targets, positioning_curve(set));
  std::string text = "Position   \tBidirectional Avg Error\r\n";
  for (const TargetReadings& target : targets)
    text += fmt::format("{:.6f}\t{:.9f}\r\n", target.position_mm, middle_um(target) / kUmPerMm);
  return text + "\r\n" + block("Forward", targets, &TargetReadings::forward) +
         block("Reverse", targets, &TargetReadings::reverse);
}

Result<std::string> to_iso230_assignments(const MeasurementSet& set) {
  ECS_TRY(targets, positioning_curve(set));
  if (const std::string fault = cycles_fault(set, targets.size()); !fault.empty())
    return problem(ProblemKind::refused, fault);
  int cycles = 0;
  for (const Reading& reading : set.readings) cycles = std::max(cycles, reading.run);
  std::string text = fmt::format("UNIT=mm\nCYCLES={}\nPOSITIONS={}\n", cycles, targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i)
    text += fmt::format("TGT_DATA[{}]={}\n", i + 1, shortest(targets[i].position_mm));
  for (const Reading& reading : set.readings) {
    std::size_t i = 0;
    while (i + 1 < targets.size() && std::abs(targets[i + 1].position_mm - target_mm(reading)) <
                                         std::abs(targets[i].position_mm - target_mm(reading)))
      ++i;
    text += fmt::format("REF_DATA_{}[{},{}]={:.12f}\n", reading.approach == Approach::forward ? "FWD" : "BWD", i + 1,
                        reading.run, target_mm(reading) + reading.error / kUmPerMm);
  }
  return text;
}

Result<std::string> to_sios_environment(const std::vector<EnvironmentRecord>& records) {
  if (records.empty())
    return problem(ProblemKind::refused,
                   "expected readings with air temperature, pressure, humidity and material temperature, found none");
  std::string text;
  const auto add = [&](double value) {
    const std::string plain = fmt::format("{:.14E}", value);  // the exponent has two digits, these files have four
    const std::size_t sign = plain.find('E') + 1;
    text += fmt::format("{}{}{}{:0>4} ", value < 0.0 ? "" : " ", plain.substr(0, sign), plain.substr(sign, 1),
                        plain.substr(sign + 1));
  };
  for (const EnvironmentRecord& record : records) {
    for (const double mm : record.stage_mm) add(mm / kMmPerM);
    for (const double degC : record.air_degC) add(degC);
    add(record.pressure_hPa * kPaPerHPa);
    add(record.humidity_pct);
    add(record.sample_degC);
    text.back() = '\r';
    text += '\n';
  }
  return text;
}

std::vector<EnvironmentRecord> environment_of(const MeasurementSet& set) {
  std::vector<EnvironmentRecord> records;
  for (const Reading& reading : set.readings) {
    const auto air = reading.sensors_degC.find("t_air_degC");
    const auto material = reading.sensors_degC.find("t_material_degC");
    const bool whole = air != reading.sensors_degC.end() && material != reading.sensors_degC.end() &&
                       reading.pressure_hPa && reading.humidity_pct;
    if (whole)
      records.push_back({reading.position_mm,
                         {air->second, air->second, air->second},
                         *reading.pressure_hPa,
                         *reading.humidity_pct,
                         material->second});
  }
  return records;
}

}  // namespace ecs::laser
