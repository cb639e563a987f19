// Where each effect can be a candidate, and the limits inside which it is still itself (physics.md 5).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "bench/foreign/effects.hpp"

namespace foreign {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

bool is(const Term& term, std::initializer_list<const char*> ids) {
  return std::any_of(ids.begin(), ids.end(), [&](const char* id) { return term.id == id; });
}

bool has_sensor(const Setup& setup, const std::string& name) {
  return std::find(setup.sensors.begin(), setup.sensors.end(), name) != setup.sensors.end();
}

// Targets of the moving axis, each once, in rising order.
std::vector<double> targets_of(const Setup& setup, char axis) {
  std::set<double> targets;
  for (const Reading& reading : setup.readings)
    if (reading.axis == axis) targets.insert(reading.at_mm[index_of(axis)]);
  return {targets.begin(), targets.end()};
}

std::vector<double> geometric(double low, double high, int count) {
  std::vector<double> values;
  if (!(low > 0.0) || !(high > low)) return values;
  for (int k = 0; k < count; ++k) values.push_back(low * std::pow(high / low, k / (count - 1.0)));
  return values;
}

// At least two periods in the travel and two targets a period; shorter ones on moved targets, and the pitches.
std::vector<double> period_grid(const Setup& setup, char axis) {
  const std::vector<double> targets = targets_of(setup, axis);
  std::vector<double> periods;
  if (targets.size() < 6) return periods;
  const double span = targets.back() - targets.front();
  const double step = span / static_cast<double>(targets.size() - 1);
  const double shortest = (setup.moved_targets ? 1.0 : 2.0) * step;
  for (double waves = 2.0; span / waves >= shortest; waves += 0.2) periods.push_back(span / waves);
  const AxisFacts& facts = setup.machine.axes[index_of(axis)];
  for (const auto& pitch : {facts.screw_pitch_mm, facts.scale_pitch_mm})
    if (pitch)
      for (const double part : {0.5, 1.0, 2.0})
        if (2.0 * *pitch * part <= span) periods.push_back(*pitch * part);
  return periods;
}

bool varies_inside_runs(const Setup& setup, const Column& column) {
  std::map<int, std::pair<double, double>> range;
  std::set<long long> states;
  double largest = 0.0;
  for (const double value : column) largest = std::max(largest, std::abs(value));
  if (!(largest > 0.0)) return false;
  for (std::size_t i = 0; i < column.size(); ++i) {
    auto& [least, greatest] = range.try_emplace(setup.readings[i].run, column[i], column[i]).first->second;
    least = std::min(least, column[i]);
    greatest = std::max(greatest, column[i]);
    states.insert(std::llround(column[i] / largest * 1e6));
  }
  const bool inside = std::any_of(range.begin(), range.end(), [&](const auto& run) {
    return run.second.second - run.second.first > 1e-6 * largest;
  });
  return inside || states.size() >= 4;
}

}  // namespace

std::vector<double> nonlinear_grid(const Setup& setup, const Term& term) {
  if (term.id == "cyclic") return period_grid(setup, term.axis);
  if (term.id == "step") {
    const std::vector<double> targets = targets_of(setup, term.axis);
    std::vector<double> places;
    for (std::size_t k = 3; k + 3 <= targets.size(); ++k) places.push_back(0.5 * (targets[k - 1] + targets[k]));
    return places;
  }
  if (term.id == "warm_up") {
    const double session = setup.readings.back().time_s - setup.readings.front().time_s;
    return geometric(session / 50.0, session, 14);
  }
  if (term.id == "reversal_spike") {
    double shortest = kUnlimited;
    double longest = 0.0;
    for (const Reading& reading : setup.readings) {
      shortest = std::min(shortest, reading.travel_mm);
      longest = std::max(longest, reading.travel_mm);
    }
    return geometric(std::max(0.01, shortest / 3.0), longest / 2.0, 14);
  }
  if (term.id == "map_shift") {
    std::vector<double> shifts;
    for (int k = -30; k <= 30; ++k)
      if (k != 0) shifts.push_back(2.0 * k);
    return shifts;
  }
  return {0.0};
}

bool may_be_candidate(const Setup& setup, const Term& term) {
  const bool needs_states = is(term, {"dead_path", "thermal_drift", "air_refraction"});
  const std::vector<Column> columns = needs_states ? columns_of(setup, term) : std::vector<Column>{};
  return !needs_states || varies_inside_runs(setup, columns.front());
}

std::pair<double, double> coefficient_limits(const std::string& id) {
  if (id == "cosine") return {0.0, kUnlimited};
  if (id == "air_refraction") return {0.0, 2.0};
  if (id == "dead_path") return {-10.0, 10.0};
  return {-kUnlimited, kUnlimited};
}

std::vector<Term> library_of(const Setup& setup) {
  std::set<std::string> senses;
  std::set<char> axes;
  bool both = false;
  for (const Reading& reading : setup.readings) {
    senses.insert(reading.sense);
    axes.insert(reading.axis);
    both = both || reading.approach < 0;
  }
  std::vector<Term> library;
  const auto add = [&](const char* id, char axis, const std::string& sense, const std::string& code = "") -> Term& {
    Term term;
    term.id = id;
    term.axis = axis;
    term.sense = sense;
    term.code = code;
    library.push_back(term);
    return library.back();
  };
  for (const char axis : axes) {
    for (const std::string& sense : senses) {
      const bool along = sense[1] == axis;
      for (const char* id : {"offset", "scale", "progressive", "step", "sag", "warm_up", "time_drift"}) {
        const bool once = id != std::string("offset") && id != std::string("time_drift");
        if (once || axis == *axes.begin()) add(id, axis, sense);
      }
      for (const int approach : {0, 1, -1})
        if (approach == 0 || both) add("cyclic", axis, sense).approach = approach;
      if (both)
        for (const char* id : {"backlash", "reversal_curve"}) add(id, axis, sense);
      if (both && setup.travel) add("reversal_spike", axis, sense);
      if (both && setup.feed) add("servo_lag", axis, sense);
      if (setup.load) add("load", axis, sense);
      if (setup.known && setup.known->code[2] == axis) add("measurement_line", axis, sense, setup.known->code);
      for (const std::string& sensor : setup.sensors) add("thermal_drift", axis, sense).sensor = sensor;
      if (along) {
        add("cosine", axis, sense);
        if (has_sensor(setup, "t_material_degC")) add("thermal_scale", axis, sense);
        if (setup.air) add("air_refraction", axis, sense);
        if (setup.air) add("dead_path", axis, sense);
      } else {
        for (std::size_t a = 0; a < setup.sensors.size(); ++a)
          for (std::size_t b = a + 1; b < setup.sensors.size(); ++b) {
            Term& bend = add("thermal_bend", axis, sense);
            bend.sensor = setup.sensors[a];
            bend.sensor2 = setup.sensors[b];
          }
      }
      if (!setup.map.empty())
        for (const char* id : {"map_polarity", "map_gain", "map_shift", "map_direction_swap"}) add(id, axis, sense);
    }
    for (const char* rotation : {"EA", "EB", "EC"}) add("set_up_rotation", axis, "", rotation);
  }
  for (const char axis : {'X', 'Y', 'Z'}) {
    const auto [low, high] = span_of(setup, axis);
    if (axes.contains(axis) || !(high > low)) continue;
    for (const std::string& sense : senses) add("scale", axis, sense);  // by the coordinate, whichever axis moved
  }
  for (const char axis : {'X', 'Y', 'Z'})
    for (const char* rotation : {"A", "B", "C"}) add("angular", axis, "", std::string("E") + rotation + axis);
  for (const char* code : {"C0Y", "B0Z", "A0Z"}) add("squareness", code[2], "", code);
  return library;
}

}  // namespace foreign
