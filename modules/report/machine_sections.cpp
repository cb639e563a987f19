// The machine and the conditions of the measurements; parameters, map and state of its unit.

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/version.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/unit/status.hpp"
#include "core/mode_word.hpp"
#include "modules/report/page.hpp"
#include "params/fields.hpp"

namespace ecs::app {
namespace {

std::string optional_mm(const std::optional<double>& value) {
  return value ? plain_number(*value) : std::string("\u2013");
}

std::string from_to(double from_mm, double to_mm, const params::PositionUnit& shown_in) {
  return fmt::format("{} … {}", plain_number(from_mm / shown_in.mm), plain_number(to_mm / shown_in.mm));
}

std::string line_text(const params::MachineAxis& axis, const params::PositionUnit& shown_in) {
  std::vector<std::string> parts;
  for (const Axis other : kAllAxes)
    if (const auto& at = axis.measurement_line_mm[index_of(other)])
      parts.push_back(fmt::format("{} {}", letter_of(other), plain_number(*at / shown_in.mm)));
  return parts.empty() ? "\u2013" : fmt::format("{}", fmt::join(parts, ", "));
}

Markup axes_table(const params::Machine& machine, const params::PositionUnit& shown_in) {
  TableMarkup table(
      columns(fmt::format("axis|>travel [{0}]|>datum [{0}]|transducer|>resolution [µm]|>screw pitch [mm]|>scale pitch "
                          "[mm]|>expansion [µm/(m\u00a0K)]|measured at [{0}]",
                          shown_in.length)));
  for (const Axis axis : kAllAxes) {
    const auto& a = machine.axes[index_of(axis)];
    if (!a) continue;
    table.row({element("strong", std::string(1, letter_of(axis))),
               text(from_to(a->travel_mm[0], a->travel_mm[1], shown_in)), text(plain_number(a->datum_mm / shown_in.mm)),
               text(a->transducer == Transducer::encoder ? "encoder" : "resolver"),
               text(plain_number(a->resolution_um)), text(optional_mm(a->screw_pitch_mm)),
               text(optional_mm(a->scale_pitch_mm)), text(optional_mm(a->expansion_um_per_m_degC)),
               text(line_text(*a, shown_in))});
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

Markup set_up_table(const std::vector<Measured>& phases, const std::vector<Environment>& recorded,
                    const params::PositionUnit& shown_in) {
  std::vector<TableColumn> columns{{"measurement"},
                                   {"phase"},
                                   {"date"},
                                   {"instrument"},
                                   {"runs", true},
                                   {"targets", true},
                                   {fmt::format("from … to [{}]", shown_in.length), true}};
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
      cells.push_back(text(from_to(line.first_mm, line.last_mm, shown_in)));
    }
    for (const Environment& env : recorded) cells.push_back(text(recorded_text(*one.set, env.column)));
    table.row(cells);
  }
  return table.markup();
}

Markup conditions_tables(const std::vector<Measured>& phases, const std::vector<Environment>& recorded,
                         const params::PositionUnit& shown_in) {
  if (recorded.size() <= kBesideSetUp) return set_up_table(phases, recorded, shown_in);
  Markup tables = set_up_table(phases, {}, shown_in);
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
    if (std::none_of(recorded.begin(), recorded.end(),
                     [name = std::string_view(column)](const Environment& e) { return e.column == name; }))
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
              axes_table(*content.machine, position_unit_of(content))};
}

ReportSection conditions_section(const ReportContent& content) {
  const auto phases = phases_in(content);
  const auto recorded = recorded_in(phases);
  Markup body = conditions_tables(phases, recorded, position_unit_of(content));
  if (const std::string missing = not_recorded(recorded); !missing.empty()) body += absence(missing);
  body += common_metadata(phases);
  return {"conditions", "Conditions of the measurements", std::move(body)};
}

namespace {

// --- parameters

/// Four decimals at most; very small and very large numbers unchanged.
std::string shown_value(const params::Field& field, const UnitParameters& parameters) {
  std::string value = params::text_of(field, parameters);
  const auto number = params::number_of(field, parameters);
  if (field.type != params::FieldType::number || !number) return value;
  const double size = std::abs(*number);
  if (size != 0.0 && (size < 0.01 || size > 1e9)) return value;
  std::string digits = number_text(*number, 4);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  return digits;
}

/// Bold with a dot where it is not the default.
Markup value_cell(const params::Field& field, const UnitParameters& parameters) {
  const std::string value = shown_value(field, parameters);
  if (params::text_of(field, parameters) == params::default_text(field)) return text(value);
  return element("strong", "• " + value);
}

/// The key without "axis.X."
std::string short_key(const params::Field& field) { return field.axis ? field.key.substr(7) : field.key; }

Markup common_table(const UnitParameters& parameters) {
  TableMarkup table(columns("parameter|>value|unit|>default"), "keys");
  for (const params::Field& field : params::fields())
    if (!field.axis)
      table.row({element("code", field.key), value_cell(field, parameters), text(unit_text(field.unit)),
                 text(params::default_text(field))});
  return table.markup();
}

/// The keys of all axes without "axis.X.", each once, in the order of the file.
std::vector<std::string> keys_of_axes() {
  std::vector<std::string> keys;
  std::size_t place = 0;
  for (const params::Field& field : params::fields()) {
    if (!field.axis) continue;
    const auto known = std::find(keys.begin(), keys.end(), short_key(field));
    if (known == keys.end()) {
      keys.insert(keys.begin() + static_cast<std::ptrdiff_t>(std::min(place, keys.size())), short_key(field));
      ++place;
    } else {
      place = static_cast<std::size_t>(known - keys.begin()) + 1;
    }
  }
  return keys;
}

Markup axes_table(const UnitParameters& parameters) {
  std::vector<Axis> present;
  for (const Axis axis : kAllAxes)
    if (parameters.axis_present[index_of(axis)]) present.push_back(axis);
  if (present.empty()) return {};
  std::vector<TableColumn> columns{{"parameter of each axis"}};
  for (const Axis axis : present) columns.push_back({std::string(1, letter_of(axis)), true});
  columns.push_back({"unit"});
  columns.push_back({"default", true});
  TableMarkup table(columns, "keys");
  for (const std::string& key : keys_of_axes()) {
    std::vector<Markup> cells{element("code", key)};
    const params::Field* field = nullptr;
    for (const Axis axis : present) {
      const params::Field* own = params::field_named(fmt::format("axis.{}.{}", letter_of(axis), key));
      cells.push_back(own == nullptr ? text("\u2013") : value_cell(*own, parameters));
      if (own != nullptr) field = own;
    }
    if (field == nullptr) continue;
    cells.push_back(text(unit_text(field->unit)));
    cells.push_back(text(params::default_text(*field)));
    table.row(cells);
  }
  return table.markup();
}

Markup findings_of(const std::vector<params::Finding>& findings) {
  if (findings.empty()) return paragraph_of("The check of the parameters has no findings.");
  std::vector<std::string> items;
  for (const params::Finding& finding : findings)
    items.push_back(
        fmt::format("{}: {}: {}", params::name_of(finding.severity), fmt::join(finding.keys, ", "), finding.message));
  return element("h3", "Findings of the check of the parameters") + list_of(without_commands(items));
}

// --- map

Markup tables_of(const laser::ErrorMap& map, const params::PositionUnit& shown_in) {
  TableMarkup table(columns(
      fmt::format("component||approach|>from [{0}]|>to [{0}]|>points|>smallest|>largest|unit", shown_in.length)));
  for (const laser::MapTable& t : map.tables) {
    if (t.position_mm.empty()) continue;
    const auto [least, most] = std::minmax_element(t.compensation.begin(), t.compensation.end());
    table.row({element("strong", name_of(t.component)), text(laser::description_of(t.component)),
               text(commissioning::word_for(t.approach)), text(plain_number(t.position_mm.front() / shown_in.mm)),
               text(plain_number(t.position_mm.back() / shown_in.mm)), text(fmt::format("{}", t.position_mm.size())),
               cell(*least, 2), cell(*most, 2), text(unit_text(unit_of(t.component)))});
  }
  return table.markup();
}

std::string squareness_text(const ReportContent& content) {
  if (!content.parameters) return "";
  const UnitParameters& p = content.parameters->file.parameters;
  return fmt::format("C0Y {}, B0Z {}, A0Z {} (errors, stored in the parameters)",
                     quantity_text(p.C0Y_um_per_m, 2, "um/m"), quantity_text(p.B0Z_um_per_m, 2, "um/m"),
                     quantity_text(p.A0Z_um_per_m, 2, "um/m"));
}

std::vector<std::string> worded_lines(const std::vector<std::string>& lines) {
  std::vector<std::string> out;
  for (const std::string& line : lines) out.push_back(worded(line));
  return out;
}

Markup declared_zeros(const laser::MapHeader& header) {
  if (header.declared_zero.empty()) return {};
  std::vector<std::string> items;
  for (const laser::DeclaredZero& zero : header.declared_zero)
    items.push_back(
        fmt::format("{} ({}): {}", name_of(zero.component), laser::description_of(zero.component), zero.reason));
  return element("h3", "Components declared zero") + list_of(items);
}

Markup against_map(const ReportedMap& map, bool judged) {
  Markup out;
  if (!map.objections.empty())
    out += element("h3", "Reasons why it cannot be sent") + list_of(without_commands(map.objections));
  if (!map.remarks.empty()) out += element("h3", "Remarks") + list_of(without_commands(map.remarks));
  if (!judged) out += absence("No parameters were given: completeness of the map for the unit was not checked.");
  return out;
}

}  // namespace

ReportSection parameters_section(const ReportContent& content) {
  if (!content.parameters) return {"parameters", "Parameters of the unit", {}, "no parameters were given"};
  const UnitParameters& parameters = content.parameters->file.parameters;
  return {"parameters", "Parameters of the unit",
          paragraph_of("• and bold: changed from the default.", "class=\"small intro\"") + common_table(parameters) +
              axes_table(parameters) + findings_of(content.parameters->findings)};
}

ReportSection map_section(const ReportContent& content) {
  if (!content.map) return {"map", "Error map", {}, "no error map was given"};
  const laser::MapHeader& header = content.map->map.header;
  Markup body = facts_of(
      {{"SHA-256 of the file", content.map->sha256},
       {"checksum (CRC-32) in the unit, with these parameters",
        content.map->check ? fmt::format("{:08X}", *content.map->check)
                           : "not computed: give the status of the unit (--status), which states its serial number"},
       {"date of the map", header.date},
       {"configuration", header.configuration},
       {"squareness", squareness_text(content)}});
  body += tables_of(content.map->map, position_unit_of(content)) + declared_zeros(header);
  if (!header.processing.empty()) body += element("h3", "How it was made") + list_of(worded_lines(header.processing));
  body += against_map(*content.map, content.parameters.has_value());
  return {"map", "Error map", std::move(body)};
}

ReportSection unit_section(const ReportContent& content) {
  if (!content.status) return {"unit", "State of the unit", {}, "no state of the unit was given"};
  const StatusSnapshot& s = *content.status;
  const bool agrees = s.status.block_check_expected == s.status.block_check_found;
  Markup body = facts_of({{"taken", s.taken},
                          {"serial number", s.identity.serial_number},
                          {"name", s.identity.unit_name},
                          {"firmware", fmt::format("{}.{}", s.identity.firmware_major, s.identity.firmware_minor)},
                          {"mode", std::string(word_of(s.status.mode))},
                          {"fault", s.status.fault == Fault::none ? "none" : fault_sentence(s.status)},
                          {"checksum", agrees ? fmt::format("{:08X}, as expected", s.status.block_check_found)
                                              : fmt::format("expected {:08X}, found {:08X}: they differ",
                                                            s.status.block_check_expected, s.status.block_check_found)},
                          {"loop", fmt::format("{} period, {} overruns, {} watchdog trips",
                                               quantity_text(s.status.loop_period_us, 0, "us"), s.status.loop_overruns,
                                               s.status.watchdog_trips)}});
  if (content.map && content.map->check && s.status.block_check_found != 0)
    body += paragraph_of(*content.map->check == s.status.block_check_found
                             ? "The unit contains this map with these parameters: the checksums agree."
                             : "The unit contained another map or other parameters: the checksums differ.");
  return {"unit", "State of the unit", std::move(body)};
}

ReportSection sources_section(const ReportContent& content) {
  TableMarkup table(columns("role|file|SHA-256"), "sources");
  for (const ReportedFile& file : content.files)
    table.row({text(file.role), text(file.name), element("code", file.sha256)});
  Markup body = paragraph_of(fmt::format("Written by {} from these files, as they were then.", program_version()),
                             "class=\"intro\"") +
                table.markup();
  return {"sources", "Files", std::move(body)};
}

}  // namespace ecs::app
