#include "commissioning/measurements/json.hpp"

#include <algorithm>
#include <set>
#include <string>

#include "base/json.hpp"

namespace ecs::commissioning {
namespace {

Json metadata_json(const laser::MeasurementSet& set) {
  Json object = Json::object();
  for (const laser::MetadataEntry& entry : set.metadata)
    if (!entry.key.empty() && !object.contains(entry.key)) object[entry.key] = entry.value;
  return object;
}

}  // namespace

Json json_of_line(Axis axis, Sense sense, const Vector3& parked_mm, std::optional<bool> compensated) {
  Json parked = Json::object();
  for (const Axis a : kAllAxes)
    if (a != axis)
      parked[std::string(1, static_cast<char>(letter_of(a) - 'A' + 'a'))] = number_or_null(parked_mm[index_of(a)]);
  return {{"axis", std::string(1, letter_of(axis))},
          {"sense", name_of(sense)},
          {"component", name_of(curve_of(sense, axis))},
          {"unit", laser::unit_of(sense)},
          {"parked_mm", std::move(parked)},
          {"compensated", compensated ? Json(*compensated) : Json(nullptr)}};
}

Json json_of(const LineSummary& line) {
  Json object = json_of_line(line.group.axis, line.group.sense, line.group.parked_mm, line.group.compensated);
  object["readings"] = line.readings;
  object["runs"] = line.runs;
  object["targets"] = line.targets;
  object["from_mm"] = number_or_null(line.first_mm);
  object["to_mm"] = number_or_null(line.last_mm);
  object["step_mm"] = number_or_null(line.step_mm);
  object["forward"] = line.forward;
  object["reverse"] = line.reverse;
  return object;
}

Json json_of(const laser::MeasurementSet& set) {
  std::set<std::string> axes, senses;
  std::size_t runs = 0, targets = 0;
  Json lines = Json::array();
  for (const LineSummary& line : lines_in(set)) {
    axes.insert(std::string(1, letter_of(line.group.axis)));
    senses.insert(std::string(name_of(line.group.sense)));
    runs = std::max(runs, line.runs);
    targets += line.targets;
    lines.push_back(json_of(line));
  }
  return {{"readings", set.readings.size()},
          {"axes", axes},
          {"senses", senses},
          {"runs", runs},
          {"targets", targets},
          {"metadata", metadata_json(set)},
          {"notes", set.notes},
          {"lines", std::move(lines)},
          {"sensors", laser::sensor_names_of(set)}};
}

}  // namespace ecs::commissioning
