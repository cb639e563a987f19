#include "model/data/sensor_history.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "model/data/observations.hpp"

namespace ecs::model {
namespace {

/// One step of the low-pass. @param degC  of the sensor before and after it
double stepped(double followed, double before_degC, double after_degC, double step_s, double lag_s) {
  const double steps = step_s / lag_s;
  if (!(steps > 0.0)) return followed;
  const double kept = std::exp(-steps), mean = -std::expm1(-steps) / steps;
  return kept * followed + (mean - kept) * before_degC + (1.0 - mean) * after_degC;
}

/// @param lag_s  below 0: there and back again, so that nothing is late
std::vector<double> low_pass(const SensorHistory& history, const std::vector<double>& degC, double lag_s) {
  std::vector<std::size_t> order;
  for (const std::size_t k : history.in_time)
    if (!std::isnan(degC[k])) order.push_back(k);
  const auto passed = [&](const std::vector<double>& input) {
    std::vector<double> followed = input;
    for (std::size_t i = 1; i < order.size(); ++i) {
      const std::size_t before = order[i - 1], now = order[i];
      if (history.clock[before] == history.clock[now])
        followed[now] = stepped(followed[before], input[before], input[now],
                                std::abs(history.time_s[now] - history.time_s[before]), std::abs(lag_s));
    }
    return followed;
  };
  std::vector<double> late = passed(degC);
  if (lag_s > 0.0) return late;
  std::ranges::reverse(order);
  return passed(late);
}

/// The readings are a part of what is in their history: a plan has conditions of its own.
bool is_part_of_history(const Observations& data, std::string_view sensor) {
  if (!data.history || data.in_history.size() != data.size()) return false;
  const auto of_all = data.history->sensors_degC.find(sensor);
  if (of_all == data.history->sensors_degC.end()) return false;
  const std::vector<double>& of_readings = data.sensors_degC.find(sensor)->second;
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t k = 0; k < data.size(); ++k) {
    const std::size_t in = data.in_history[k];
    if (!same(data.time_s[k], data.history->time_s[in]) || !same(of_readings[k], of_all->second[in])) return false;
  }
  return true;
}

SensorHistory history_of(const Observations& data) {
  SensorHistory history;
  history.clock.assign(data.size(), 0);
  for (std::size_t k = 1; k < data.size(); ++k)
    history.clock[k] = history.clock[k - 1] + (data.time_s[k] < data.time_s[k - 1] ? 1 : 0);
  if (std::ranges::any_of(data.time_s, [](double t) { return std::isnan(t); })) history.clock = data.run;
  history.time_s = data.time_s;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!std::isnan(data.time_s[k])) history.in_time.push_back(k);
  std::ranges::stable_sort(history.in_time, {},
                           [&](std::size_t k) { return std::make_tuple(history.clock[k], history.time_s[k]); });
  history.sensors_degC = data.sensors_degC;
  return history;
}

std::vector<double> in_readings(const Observations& data, const std::vector<double>& of_all) {
  std::vector<double> values;
  for (const std::size_t in : data.in_history) values.push_back(of_all[in]);
  return values;
}

}  // namespace

std::shared_ptr<const SensorHistory> sensor_history_of(const Observations& data) {
  if (data.time_s.empty() || data.sensors_degC.empty()) return nullptr;
  SensorHistory history = history_of(data);
  for (const auto& [sensor, degC] : history.sensors_degC)
    if (auto course = without_noise(history.clock, history.time_s, degC))
      history.without_noise.emplace(sensor, *std::move(course));
  return std::make_shared<const SensorHistory>(std::move(history));
}

std::vector<double> followed_degC(const Observations& data, std::string_view sensor, double lag_s) {
  const auto column = data.sensors_degC.find(sensor);
  if (column == data.sensors_degC.end()) return std::vector<double>(data.size(), kNotMeasured);
  if (data.time_s.empty()) return column->second;
  if (!is_part_of_history(data, sensor))
    return lag_s == 0.0 ? column->second : low_pass(history_of(data), column->second, lag_s);
  const auto calm = data.history->without_noise.find(sensor);
  const std::vector<double>& course =
      calm == data.history->without_noise.end() ? data.history->sensors_degC.find(sensor)->second : calm->second.degC;
  return in_readings(data, lag_s == 0.0 ? course : low_pass(*data.history, course, lag_s));
}

std::vector<double> unknown_degC(const Observations& data, std::string_view sensor, double lag_s) {
  if (!is_part_of_history(data, sensor)) return {};
  const auto calm = data.history->without_noise.find(sensor);
  if (calm == data.history->without_noise.end()) return {};
  std::vector<double> unknown = in_readings(data, calm->second.sd_degC);
  // a low-pass takes the fast part of errors that are alike over this time away
  const double kept = std::sqrt(calm->second.memory_s / (calm->second.memory_s + std::abs(lag_s)));
  for (double& one : unknown) one *= kept;
  return unknown;
}

}  // namespace ecs::model
