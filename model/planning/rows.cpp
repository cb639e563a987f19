// Rows of readings yet to be taken; no method of its own.
#include "model/planning/rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/data/motions.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/statistics.hpp"
#include "model/planning/circles.hpp"

namespace ecs::model {
namespace {

/// The columns that readings along paths have.
void make_room_for_paths(Observations& data) {
  if (data.feed_mm_min.empty()) data.feed_mm_min.assign(data.size(), kNotMeasured);
  if (!data.path.empty()) return;
  data.path.assign(data.size(), 0);
  data.along.assign(data.size(), kNotMeasured);
  data.place.assign(data.size(), kNotMeasured);
}

/// A present reading of the same axis and sense, to take from what a proposal does not say.
std::size_t pattern_of(const Observations& present, const MeasurementProposal& proposal) {
  for (std::size_t k = 0; k < present.size(); ++k)
    if (present.axis[k] == proposal.axis && present.sense[k] == proposal.sense) return k;
  return 0;
}

void set(Column& column, std::size_t k, const std::optional<double>& value) {
  if (!column.empty() && value) column[k] = *value;
}

void fill(Observations& data, std::size_t k, const MeasurementProposal& proposal, const Stop& stop, double start_s) {
  data.axis[k] = proposal.axis;
  data.sense[k] = proposal.sense;
  data.run[k] = stop.run;
  data.approach[k] = stop.approach;
  data.position_mm[k] = proposal.parked_mm;
  data.position_mm[k][index_of(proposal.axis)] = stop.target_mm;
  if (!data.path.empty()) data.path[k] = 0;
  if (proposal.circle) {
    data.position_mm[k] = point_on_circle(*proposal.circle, stop.target_mm);
    data.path[k] = data.paths.size();
    data.along[k] = data.place[k] = stop.target_mm;
  }
  if (proposal.compensated) data.compensated[k] = *proposal.compensated;
  set(data.time_s, k, start_s + stop.after_s);
  set(data.feed_mm_min, k, stop.feed_mm_min);
  set(data.load_kg, k, proposal.load_kg);
  set(data.travel_since_reversal_mm, k, stop.since_reversal_mm);
  set(data.pressure_hPa, k, proposal.pressure_hPa);
  set(data.humidity_pct, k, proposal.humidity_pct);
  for (auto& [sensor, column] : data.sensors_degC)
    if (const auto degC = proposal.temperatures_degC.find(sensor); degC != proposal.temperatures_degC.end())
      set(column, k, degC->second);
  if (const auto set_up = data.extras.find("set_up"); set_up != data.extras.end()) set_up->second[k] = proposal.set_up;
  if (const auto reversed = data.extras.find("reversed"); reversed != data.extras.end() && proposal.reversed)
    reversed->second[k] = *proposal.reversed ? 1.0 : 0.0;
}

/// An extra column as a straight line over another one; over none it is constant.
struct Follows {
  std::string column;
  double at_zero = 0.0;
  double slope = 0.0;
  [[nodiscard]] double at(const Observations& data, std::size_t k) const {
    return column.empty() ? at_zero : at_zero + slope * variable_of(data, k, column);
  }
};

/// The line through the readings with the least and the greatest value of `column`, if all others lie on it. Every
/// `step`-th reading counts.
std::optional<Follows> line_over(const Observations& present, const Column& extra, const std::string& column,
                                 std::size_t step) {
  constexpr double kSame = 1e-5;  // of the range: the last digit of a cell
  double least = kBeyondAll, greatest = -kBeyondAll, low = kBeyondAll, high = -kBeyondAll;
  double at_least = 0.0, at_greatest = 0.0;
  for (std::size_t k = 0; k < present.size(); k += step) {
    const double x = column.empty() ? 0.0 : variable_of(present, k, column);
    if (std::isnan(x) || std::isnan(extra[k])) return std::nullopt;
    if (x < least) at_least = extra[k];
    if (x > greatest) at_greatest = extra[k];
    least = std::min(least, x);
    greatest = std::max(greatest, x);
    low = std::min(low, extra[k]);
    high = std::max(high, extra[k]);
  }
  Follows line{column, at_least, 0.0};
  if (greatest > least) line.slope = (at_greatest - at_least) / (greatest - least);
  line.at_zero -= line.slope * least;
  for (std::size_t k = 0; k < present.size(); k += step)
    if (std::abs(line.at(present, k) - extra[k]) > kSame * (high - low)) return std::nullopt;
  return line;
}

/// What a column without a meaning of its own depends on; places before conditions, since a run chooses them first.
std::optional<Follows> follows(const Observations& present, const Column& extra) {
  std::vector<std::string> columns{"", "x_mm", "y_mm", "z_mm", "approach", "feed_mm_min", "load_kg", "pressure_hPa"};
  columns.insert(columns.end(), {"humidity_pct", "travel_since_reversal_mm"});
  for (const auto& [sensor, degC] : present.sensors_degC) columns.push_back(sensor);
  columns.emplace_back("time_s");
  constexpr std::size_t kFewReadings = 50;  // show of most columns that they are no line
  for (const std::string& column : columns) {
    if (!line_over(present, extra, column, 1 + present.size() / kFewReadings)) continue;
    if (auto line = line_over(present, extra, column, 1)) return line;
  }
  return std::nullopt;
}

/// Marks rows of the present readings by a 1 among zeros.
bool is_mark(const Column& extra) {
  return std::all_of(extra.begin(), extra.end(), [](double value) { return value == 0.0 || value == 1.0; });
}

/// Cells of the extra columns in the new rows, which are otherwise whole.
/// @param zeroed_each_run  marks are the zeros of past runs
void fill_extras(WithProposals& all, const Observations& present, bool zeroed_each_run) {
  for (auto& [name, column] : all.data.extras) {
    if (name == "set_up" || name == "reversed") continue;
    const Column& known = present.extras.find(name)->second;
    const auto line = zeroed_each_run && is_mark(known) ? std::optional(Follows{}) : follows(present, known);
    if (line) all.extras_follow[name] = line->column;
    for (std::size_t k = all.present; k < column.size(); ++k) column[k] = line ? line->at(all.data, k) : kNotMeasured;
  }
}

}  // namespace

Observations present_of(const WithProposals& all) {
  std::vector<std::size_t> rows(all.present);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return subset(all.data, rows);
}

WithProposals with_proposals(const Observations& present, const std::vector<MeasurementProposal>& proposals) {
  WithProposals all;
  all.present = present.size();
  std::vector<std::size_t> rows(present.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::vector<std::vector<Stop>> stops;
  for (MeasurementProposal one : proposals) {
    one.runs = 1;
    stops.push_back(stops_of(one));
    all.first.push_back(rows.size());
    all.count.push_back(stops.back().size());
    rows.insert(rows.end(), stops.back().size(), pattern_of(present, one));
  }
  all.data = subset(present, rows);
  double last_s = 0.0;
  for (const double t : present.time_s)
    if (!std::isnan(t)) last_s = std::max(last_s, t);
  if (std::any_of(proposals.begin(), proposals.end(), [](const MeasurementProposal& p) { return p.set_up != 1; }))
    all.data.extras.try_emplace("set_up", Column(rows.size(), 1.0));
  if (std::any_of(proposals.begin(), proposals.end(), [](const MeasurementProposal& p) { return p.circle; }))
    make_room_for_paths(all.data);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    if (proposals[i].circle) all.data.paths.push_back(*proposals[i].circle);  // a pass of its own, measured or not
    const double start_s = last_s + kSecondsAMinute * (proposals[i].wait_minutes + proposals[i].set_up_minutes);
    for (std::size_t j = 0; j < stops[i].size(); ++j)
      fill(all.data, all.first[i] + j, proposals[i], stops[i][j], start_s);
  }
  fill_extras(all, present, std::any_of(proposals.begin(), proposals.end(), [](const auto& p) { return p.own_zero; }));
  set_motions(all.data);
  return all;
}

}  // namespace ecs::model
