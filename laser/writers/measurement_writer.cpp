#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/csv_table.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

template <class Has>
bool any(const MeasurementSet& set, const Has& has) {
  return std::ranges::any_of(set.readings, has);
}

/// Every column that some reading needs, in the usual order.
std::vector<std::string> columns_used(const MeasurementSet& set) {
  std::vector<std::string> columns{"axis", "x_mm", "y_mm", "z_mm", "sense", "reading", "approach", "run"};
  for (const Axis axis : kAllAxes)
    if (any(set, [&](const Reading& r) { return r.angle_deg[index_of(axis)] != 0.0 || (r.rotary && r.axis == axis); }))
      columns.emplace_back(kAngleColumns[index_of(axis)]);
  for (const NumberColumn& column : kNumberColumns)
    if (any(set, [&](const Reading& r) { return (r.*(column.member)).has_value(); })) columns.emplace_back(column.name);
  if (any(set, [](const Reading& r) { return r.compensated.has_value(); })) columns.emplace_back("compensated");
  std::set<std::string> others;
  for (const Reading& reading : set.readings) {
    for (const auto& entry : reading.sensors_degC) others.insert(entry.first);
    for (const auto& entry : reading.extras) others.insert(entry.first);
    for (const auto& entry : reading.text_extras) others.insert(entry.first);
  }
  columns.insert(columns.end(), others.begin(), others.end());
  return columns;
}

/// A column that holds nothing but defaults need not be written where the set's own header lacks it.
bool says_nothing(const MeasurementSet& set, std::string_view column) {
  for (const Axis axis : kAllAxes)
    if (column == kPositionColumns[index_of(axis)])
      return !any(set, [&](const Reading& r) { return r.position_mm[index_of(axis)] != 0.0; });
  if (column == "approach") return !any(set, [](const Reading& r) { return r.approach != Approach::unknown; });
  if (column == "run") return !any(set, [](const Reading& r) { return r.run != 1; });
  return false;
}

std::vector<std::string> columns_of(const MeasurementSet& set) {
  std::vector<std::string> columns = set.columns;
  for (std::string& used : columns_used(set)) {
    if (std::ranges::find(columns, used) != columns.end()) continue;
    if (!set.columns.empty() && says_nothing(set, used)) continue;
    columns.push_back(std::move(used));
  }
  return columns;
}

template <class Map>
std::string number_from(const Map& map, std::string_view name) {
  const auto found = map.find(name);
  return found == map.end() ? std::string() : shortest(found->second);
}

std::string cell_of(const Reading& reading, std::string_view column) {
  if (column == "axis") return std::string(1, letter_of(reading.axis, reading.rotary));
  if (column == "sense") return std::string(name_of(reading.sense));
  if (column == "reading") return shortest(reading.error);
  if (column == "approach") return std::to_string(static_cast<int>(reading.approach));
  if (column == "run") return std::to_string(reading.run);
  if (column == "compensated") return reading.compensated ? (*reading.compensated ? "1" : "0") : "";
  for (const Axis axis : kAllAxes)
    if (column == kPositionColumns[index_of(axis)])
      return shortest(reading.position_mm[index_of(axis)]);
    else if (column == kAngleColumns[index_of(axis)])
      return shortest(reading.angle_deg[index_of(axis)]);
  for (const NumberColumn& number : kNumberColumns)
    if (column == number.name) return reading.*(number.member) ? shortest(*(reading.*(number.member))) : "";
  if (is_sensor_column(column)) return number_from(reading.sensors_degC, column);
  const auto text = reading.text_extras.find(column);
  return text == reading.text_extras.end() ? number_from(reading.extras, column) : csv_field_of(text->second);
}

}  // namespace

std::string to_csv(const MeasurementSet& set) {
  std::string text;
  for (const MetadataEntry& entry : set.metadata)
    text += shown_line(entry.key.empty() ? fmt::format("# {}", entry.value)
                                         : fmt::format("# {}: {}", entry.key, entry.value)) +
            "\n";
  const std::vector<std::string> columns = columns_of(set);
  for (std::size_t i = 0; i < columns.size(); ++i) text.append(i == 0 ? "" : ",").append(csv_field_of(columns[i]));
  text += '\n';
  for (const Reading& reading : set.readings) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      text.append(i == 0 ? "" : ",").append(cell_of(reading, columns[i]));
    text += '\n';
  }
  return text;
}

Result<void> write_measurement_set(const std::filesystem::path& path, const MeasurementSet& set) {
  return write_file(path, to_csv(set));
}

namespace {

std::string metadata_line(std::string_view key, std::string_view value) {
  return shown_line(fmt::format("# {}: {}", key, value)) + "\n";
}

}  // namespace

std::string to_csv(const CircleTest& test) {
  std::string own = metadata_line("plane", plane_name(test.plane));
  own += metadata_line("radius_mm", shortest(test.radius_mm));
  if (test.feed_mm_min) own += metadata_line("feed_mm_min", shortest(*test.feed_mm_min));
  if (test.start_angle_deg) own += metadata_line("start_angle_deg", shortest(*test.start_angle_deg));
  for (std::size_t i = 0; i < test.plane.size(); ++i)
    if (test.centre_mm[i])
      own += metadata_line(fmt::format("centre_{}_mm", small_letter_of(test.plane[i])), shortest(*test.centre_mm[i]));
  std::string text;
  for (const MetadataEntry& entry : test.metadata)
    if (const std::string line = metadata_line(entry.key, entry.value);
        own.find(fmt::format("# {}: ", entry.key)) == own.npos)
      text += line;
  const bool in_parts = std::ranges::any_of(test.readings, [](const CircleReading& one) { return one.part != 1; });
  text += own + (in_parts ? "angle_deg,deviation_um,direction,run,part\n" : "angle_deg,deviation_um,direction,run\n");
  for (const CircleReading& reading : test.readings)
    text += fmt::format("{:.4f},{:.4f},{},{}{}\n", reading.angle_deg, reading.deviation_um,
                        contouring_name(reading.clockwise), reading.run,
                        in_parts ? fmt::format(",{}", reading.part) : std::string());
  return text;
}

}  // namespace ecs::laser
