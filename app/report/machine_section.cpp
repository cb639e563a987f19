// Machine and conditions: what was measured, with what, in which surroundings.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/sections.hpp"
#include "commissioning/measurements/fields.hpp"

namespace ecs::app {
namespace {

std::string optional_mm(const std::optional<double>& value) {
  return value ? plain_number(*value) : std::string("\u2013");
}

std::string line_text(const params::MachineAxis& axis) {
  std::vector<std::string> parts;
  for (const Axis other : kAllAxes)
    if (const auto& at = axis.measurement_line_mm[index_of(other)])
      parts.push_back(fmt::format("{} {}", letter_of(other), plain_number(*at)));
  return parts.empty() ? "\u2013" : fmt::format("{}", fmt::join(parts, ", "));
}

Markup axes_table(const params::Machine& machine) {
  TableMarkup table({{"axis"},
                     {"travel [mm]", true},
                     {"datum [mm]", true},
                     {"transducer"},
                     {"resolution [µm]", true},
                     {"screw pitch [mm]", true},
                     {"scale pitch [mm]", true},
                     {"expansion [µm/(m\u00a0K)]", true},
                     {"measured at [mm]"}});
  for (const Axis axis : kAllAxes) {
    const auto& a = machine.axes[index_of(axis)];
    if (!a) continue;
    table.row({element("strong", std::string(1, letter_of(axis))),
               text(fmt::format("{} … {}", plain_number(a->travel_mm[0]), plain_number(a->travel_mm[1]))),
               text(plain_number(a->datum_mm)), text(a->transducer == Transducer::encoder ? "encoder" : "resolver"),
               text(plain_number(a->resolution_um)), text(optional_mm(a->screw_pitch_mm)),
               text(optional_mm(a->scale_pitch_mm)), text(optional_mm(a->expansion_um_per_m_degC)),
               text(line_text(*a))});
  }
  return table.markup();
}

// --- conditions

struct Measured {
  std::string name;
  std::string phase;
  const laser::MeasurementSet* set = nullptr;
};

std::vector<Measured> phases_in(const ReportContent& content) {
  std::vector<Measured> all;
  for (const TableRow& row : content.rows) {
    if (row.before) all.push_back({row.planned.name, "before", &row.before->readings.before});
    if (row.after) all.push_back({row.planned.name, "after", &row.after->readings.before});
  }
  return all;
}

struct Environment {
  std::string column;
  std::string title;
  std::string unit;
};

/// What was recorded beside the error in any file, in the order of this list, then the sensors by name.
std::vector<Environment> recorded_in(const std::vector<Measured>& phases) {
  static const std::vector<Environment> kKnown{
      {"t_air_degC", "air", "°C"},       {"t_material_degC", "material", "°C"}, {"pressure_hPa", "pressure", "hPa"},
      {"humidity_pct", "humidity", "%"}, {"feed_mm_min", "feed", "mm/min"},     {"load_kg", "load", "kg"}};
  std::set<std::string> names, sensors;
  for (const Measured& one : phases) {
    for (const ConditionSummary& c : conditions_in(*one.set)) names.insert(c.name);
    for (const std::string& sensor : laser::sensor_names_of(*one.set)) sensors.insert(sensor);
  }
  std::vector<Environment> found;
  for (const Environment& known : kKnown)
    if (names.count(known.column) > 0) found.push_back(known);
  for (const std::string& sensor : sensors)
    if (sensor != "t_air_degC" && sensor != "t_material_degC")
      found.push_back({sensor, sensor.substr(2, sensor.size() - 7), "°C"});
  return found;
}

constexpr const char* kNothing = "\u2013";

std::string span_text(const ConditionSummary& c) {
  const double least = c.least, most = c.most;
  const int decimals = std::max(std::abs(least), std::abs(most)) < 200.0 ? 1 : 0;
  const std::string low = number_text(least, decimals), high = number_text(most, decimals);
  return low == high ? low : fmt::format("{} … {}", low, high);
}

std::string recorded_text(const laser::MeasurementSet& set, const std::string& column) {
  for (const ConditionSummary& c : conditions_in(set))
    if (c.name == column) return span_text(c);
  return kNothing;
}

std::string metadata(const laser::MeasurementSet& set, std::string_view key) {
  return laser::metadata_value(set, key).value_or("\u2013");
}

constexpr std::size_t kBesideSetUp = 2;  ///< columns of surroundings for which the table of set-ups has room
constexpr std::size_t kAcross = 7;       ///< that a table of their own has room for

/// Only what has any of these columns.
Markup surroundings_table(const std::vector<Measured>& phases, const std::vector<Environment>& recorded) {
  std::vector<TableColumn> columns{{"measurement"}, {"phase"}};
  for (const Environment& one : recorded) columns.push_back({fmt::format("{} [{}]", one.title, one.unit), true});
  TableMarkup table(columns, "dense");
  for (const Measured& one : phases) {
    std::vector<Markup> cells{element("strong", one.name), text(one.phase)};
    bool any = false;
    for (const Environment& env : recorded) {
      const std::string value = recorded_text(*one.set, env.column);
      any = any || value != kNothing;
      cells.push_back(text(value));
    }
    if (any) table.row(cells);
  }
  return table.markup();
}

Markup set_up_table(const std::vector<Measured>& phases, const std::vector<Environment>& recorded) {
  std::vector<TableColumn> columns{{"measurement"},         {"phase"},      {"date"},
                                   {"instrument"},          {"runs", true}, {"targets", true},
                                   {"from … to [mm]", true}};
  for (const Environment& one : recorded) columns.push_back({fmt::format("{} [{}]", one.title, one.unit), true});
  TableMarkup table(columns, "dense");
  for (const Measured& one : phases) {
    const auto lines = lines_in(*one.set);
    std::vector<Markup> cells{element("strong", one.name), text(one.phase), text(metadata(*one.set, "date")),
                              text(metadata(*one.set, "instrument"))};
    if (lines.empty()) {
      cells.insert(cells.end(), 3, text("\u2013"));
    } else {
      const LineSummary& line = lines.front();
      cells.push_back(text(fmt::format("{}{}", line.runs, line.forward && line.reverse ? " × 2" : "")));
      cells.push_back(text(fmt::format("{}", line.targets)));
      cells.push_back(text(fmt::format("{} … {}", plain_number(line.first_mm), plain_number(line.last_mm))));
    }
    for (const Environment& env : recorded) cells.push_back(text(recorded_text(*one.set, env.column)));
    table.row(cells);
  }
  return table.markup();
}

Markup conditions_tables(const std::vector<Measured>& phases, const std::vector<Environment>& recorded) {
  if (recorded.size() <= kBesideSetUp) return set_up_table(phases, recorded);
  Markup tables = set_up_table(phases, {});
  for (std::size_t at = 0; at < recorded.size(); at += kAcross) {
    const auto from = recorded.begin() + static_cast<std::ptrdiff_t>(at);
    const auto to = recorded.begin() + static_cast<std::ptrdiff_t>(std::min(recorded.size(), at + kAcross));
    tables += surroundings_table(phases, {from, to});
  }
  return tables;
}

/// Which of the quantities that matter for air and material nobody wrote down.
std::string not_recorded(const std::vector<Environment>& recorded) {
  std::vector<std::string_view> missing;
  for (const auto& [column, words] : {std::pair{"t_air_degC", "air temperature"},
                                      {"t_material_degC", "material temperature"},
                                      {"pressure_hPa", "air pressure"},
                                      {"humidity_pct", "humidity"},
                                      {"feed_mm_min", "feed"}})
    if (std::none_of(recorded.begin(), recorded.end(), [&](const Environment& e) { return e.column == column; }))
      missing.push_back(words);
  if (missing.empty()) return "";
  return fmt::format("Not recorded in the files: {}.", fmt::join(missing, ", "));
}

/// Any other statement of the files' heads, said once where all agree.
Markup common_metadata(const std::vector<Measured>& phases) {
  static const std::set<std::string> kShown{"machine", "serial_number", "instrument", "date", "parked", ""};
  std::vector<std::pair<std::string, std::vector<std::string>>> by_key;
  for (const Measured& one : phases)
    for (const laser::MetadataEntry& entry : one.set->metadata) {
      if (kShown.count(entry.key) > 0) continue;
      auto at = std::find_if(by_key.begin(), by_key.end(), [&](const auto& k) { return k.first == entry.key; });
      if (at == by_key.end()) at = by_key.insert(by_key.end(), {entry.key, {}});
      if (std::find(at->second.begin(), at->second.end(), entry.value) == at->second.end())
        at->second.push_back(entry.value);
    }
  std::vector<std::pair<std::string, std::string>> facts;
  for (const auto& [key, values] : by_key)
    if (values.size() <= 4) facts.emplace_back(key, fmt::format("{}", fmt::join(values, "; ")));
  return facts_of(facts);
}

}  // namespace

ReportSection machine_section(const ReportContent& content) {
  if (!content.machine)
    return {"machine",
            "Machine",
            {},
            "no machine file was given: travels, transducers and measurement lines are not stated"};
  return {"machine", "Machine",
          facts_of({{"name", content.machine->name}, {"chain", content.machine->configuration}}) +
              axes_table(*content.machine)};
}

ReportSection conditions_section(const ReportContent& content) {
  const auto phases = phases_in(content);
  const auto recorded = recorded_in(phases);
  Markup body = conditions_tables(phases, recorded);
  if (const std::string missing = not_recorded(recorded); !missing.empty()) body += absence(missing);
  body += common_metadata(phases);
  return {"conditions", "Conditions of the measurements", std::move(body)};
}

}  // namespace ecs::app
