#include "commissioning/models/lines.hpp"

#include <map>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::commissioning {

std::vector<MeasuredLine> measured_lines(const model::Observations& data) {
  std::map<std::tuple<model::Channel, Axis, Vector3>, MeasuredLine> lines;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const Vector3 parked = data.parked_of(k);
    MeasuredLine& line = lines[{data.channel(k), data.axis[k], parked}];
    if (line.rows.empty()) line.path = data.path_name(k);
    line.axis = data.axis[k];
    line.sense = data.sense[k];
    line.rotary = data.rotary;
    line.parked_mm = parked;
    line.rows.push_back(k);
  }
  std::vector<MeasuredLine> list;
  for (auto& each : lines) list.push_back(std::move(each.second));
  return list;
}

std::vector<double> places_along(const model::Observations& data, Axis axis) {
  std::vector<double> x;
  for (std::size_t k = 0; k < data.size(); ++k)
    x.push_back(data.on_path(k) ? data.along[k] : data.position_mm[k][index_of(axis)]);
  return x;
}

std::string label_along(const model::Observations& data, const MeasuredLine& line) {
  if (!line.path.empty()) return std::string(variable_along(data.path_of(line.rows.front())));
  return fmt::format("{} position [{}]", data.letter(line.axis), data.position_unit());
}

std::string title_of(const MeasuredLine& line) {
  if (!line.path.empty()) return line.path;
  const std::string text = fmt::format("{} along {}", name_of(line.sense), laser::letter_of(line.axis, line.rotary));
  std::vector<std::string> parked;
  for (const Axis a : kAllAxes)
    if (a != line.axis && line.parked_mm[index_of(a)] != 0.0)
      parked.push_back(fmt::format("{} {:.6g}", laser::letter_of(a, line.rotary), line.parked_mm[index_of(a)]));
  return parked.empty() ? text : fmt::format("{} at {}", text, fmt::join(parked, ", "));
}

Mark reading_mark(int approach) {
  if (approach == 0) return Mark::reading;
  return approach > 0 ? Mark::forward_reading : Mark::reverse_reading;
}

Mark line_mark(int approach) {
  if (approach == 0) return Mark::both;
  return approach > 0 ? Mark::forward : Mark::reverse;
}

}  // namespace ecs::commissioning
