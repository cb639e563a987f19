#include "model/data/zeros.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ecs::model {
namespace {

/// More lines of a sense along one linear axis are the rows of a grid, which is read without a new zero.
constexpr std::size_t kMostLines = 8;
constexpr double kSameParked_mm = 1e-3;

/// One run is no session: runs with pauses between all of them are one measurement.
constexpr int kFewestRuns = 2;

}  // namespace

void set_lines(Observations& data) {
  const auto set_up = data.extras.find("set_up");
  std::map<std::pair<Axis, Sense>, std::vector<std::pair<Vector3, double>>> seen;
  const std::size_t most = data.rotary ? data.size() : kMostLines;
  data.line.assign(data.size(), 1);
  for (std::size_t k = 0; k < data.size(); ++k) {
    Vector3 parked_mm = data.position_mm[k];
    parked_mm[index_of(data.axis[k])] = 0.0;
    const double number = set_up == data.extras.end() || std::isnan(set_up->second[k]) ? 1.0 : set_up->second[k];
    auto& lines = seen[{data.axis[k], data.sense[k]}];
    if (lines.size() > most) continue;
    const auto found = std::ranges::find_if(lines, [&](const auto& one) {
      return one.second == number && std::hypot(one.first[0] - parked_mm[0], one.first[1] - parked_mm[1],
                                                one.first[2] - parked_mm[2]) < kSameParked_mm;
    });
    data.line[k] = static_cast<int>(found - lines.begin()) + 1;
    if (found == lines.end()) lines.emplace_back(parked_mm, number);
  }
  for (std::size_t k = 0; k < data.size(); ++k)
    if (seen[{data.axis[k], data.sense[k]}].size() > most) data.line[k] = 1;
}

void set_sessions(Observations& data, const laser::MeasurementSet& set, const std::map<int, int>& clocks) {
  struct Run {
    int file = 0, clock = 0;
    double begin_s = 0.0, end_s = 0.0;
  };
  std::map<std::pair<Axis, Sense>, std::map<int, Run>> lines;
  int file = 0, line_before = 0;
  for (const laser::Reading& r : set.readings) {
    file += r.line < line_before ? 1 : 0;
    line_before = r.line;
    const double time_s = r.time_s.value_or(0.0);
    const auto clock = clocks.find(r.run);
    const Run fresh{file, clock == clocks.end() ? 0 : clock->second, time_s, time_s};
    Run& run = lines[{r.axis, r.sense}].try_emplace(r.run, fresh).first->second;
    run.begin_s = std::min(run.begin_s, time_s);
    run.end_s = std::max(run.end_s, time_s);
  }
  for (const auto& [place, runs] : lines) {
    std::vector<int> starts;
    bool each_has_runs = true;
    int count = 0;
    double begin_s = runs.begin()->second.begin_s;
    for (auto run = runs.begin(); run != runs.end(); ++run, ++count) {
      if (run == runs.begin()) continue;
      const Run &before = std::prev(run)->second, &now = run->second;
      if (now.file == before.file && now.clock == before.clock && now.begin_s - before.end_s <= before.end_s - begin_s)
        continue;
      each_has_runs = each_has_runs && count >= kFewestRuns;
      starts.push_back(run->first);
      begin_s = now.begin_s;
      count = 0;
    }
    if (!starts.empty() && each_has_runs && count >= kFewestRuns) data.sessions[place] = std::move(starts);
  }
}

}  // namespace ecs::model
