// Parameters, error map and state of the unit; definitions and the files that went in.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/sections.hpp"
#include "base/version.hpp"
#include "commissioning/maps/view.hpp"
#include "commissioning/unit/status.hpp"
#include "params/fields.hpp"

namespace ecs::app {
namespace {

// --- parameters

/// Four decimals at most; very small and very large numbers unchanged.
std::string shown_value(const params::Field& field, const UnitParameters& parameters) {
  const std::string value = params::text_of(field, parameters);
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
  TableMarkup table({{"parameter"}, {"value", true}, {"unit"}, {"default", true}}, "keys");
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
  if (findings.empty()) return paragraph_of("The check of the parameters found nothing.");
  std::vector<std::string> items;
  for (const params::Finding& finding : findings)
    items.push_back(
        fmt::format("{}: {}: {}", params::name_of(finding.severity), fmt::join(finding.keys, ", "), finding.message));
  return element("h3", "What the check of the parameters found") + list_of(without_commands(items));
}

// --- map

Markup tables_of(const laser::ErrorMap& map) {
  TableMarkup table({{"component"},
                     {""},
                     {"approach"},
                     {"from [mm]", true},
                     {"to [mm]", true},
                     {"points", true},
                     {"smallest", true},
                     {"largest", true},
                     {"unit"}});
  for (const laser::MapTable& t : map.tables) {
    if (t.position_mm.empty()) continue;
    const auto [least, most] = std::minmax_element(t.compensation.begin(), t.compensation.end());
    table.row({element("strong", name_of(t.component)), text(laser::description_of(t.component)),
               text(commissioning::word_for(t.approach)), text(plain_number(t.position_mm.front())),
               text(plain_number(t.position_mm.back())), text(fmt::format("{}", t.position_mm.size())), cell(*least, 2),
               cell(*most, 2), text(unit_text(unit_of(t.component)))});
  }
  return table.markup();
}

std::string squareness_text(const ReportContent& content) {
  if (!content.parameters) return "";
  const UnitParameters& p = content.parameters->file.parameters;
  return fmt::format("C0Y {}, B0Z {}, A0Z {} (errors, held in the parameters)",
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
    out += element("h3", "Objections to sending it") + list_of(without_commands(map.objections));
  if (!map.remarks.empty()) out += element("h3", "Worth knowing") + list_of(without_commands(map.remarks));
  if (!judged) out += absence("No parameters were given: whether the map is complete for the unit was not judged.");
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
  Markup body = facts_of({{"SHA-256 of the file", content.map->sha256},
                          {"block check in the unit (CRC-32, with these parameters)",
                           content.map->check ? fmt::format("{:08X}", *content.map->check)
                                              : "needs the unit's serial number: its state was not given"},
                          {"date of the map", header.date},
                          {"configuration", header.configuration},
                          {"squareness", squareness_text(content)}});
  body += tables_of(content.map->map) + declared_zeros(header);
  if (!header.processing.empty()) body += element("h3", "How it was made") + list_of(worded_lines(header.processing));
  body += against_map(*content.map, content.parameters.has_value());
  return {"map", "Error map", std::move(body)};
}

ReportSection unit_section(const ReportContent& content) {
  if (!content.status) return {"unit", "State of the unit", {}, "no state of the unit was given"};
  const StatusSnapshot& s = *content.status;
  const bool agrees = s.status.block_check_expected == s.status.block_check_found;
  Markup body =
      facts_of({{"taken", s.taken},
                {"serial number", s.identity.serial_number},
                {"name", s.identity.unit_name},
                {"firmware", fmt::format("{}.{}", s.identity.firmware_major, s.identity.firmware_minor)},
                {"mode", std::string(ecs::name_of(s.status.mode))},
                {"fault", s.status.fault == Fault::none ? "none" : fault_sentence(s.status)},
                {"block check", fmt::format("expected {:08X}, found {:08X}: {}", s.status.block_check_expected,
                                            s.status.block_check_found, agrees ? "agree" : "differ")},
                {"loop", fmt::format("{} period, {} overruns, {} watchdog trips",
                                     quantity_text(s.status.loop_period_us, 0, "us"), s.status.loop_overruns,
                                     s.status.watchdog_trips)}});
  if (content.map && content.map->check && s.status.block_check_found != 0)
    body += paragraph_of(*content.map->check == s.status.block_check_found
                             ? "The unit holds this map with these parameters: its block check is theirs."
                             : "The unit held another map or other parameters: its block check is not theirs.");
  return {"unit", "State of the unit", std::move(body)};
}

ReportSection sources_section(const ReportContent& content) {
  TableMarkup table({{"role"}, {"file"}, {"SHA-256"}}, "sources");
  for (const ReportedFile& file : content.files)
    table.row({text(file.role), text(file.name), element("code", file.sha256)});
  Markup body = paragraph_of(fmt::format("Written by {} from these files, as they were then.", program_version()),
                             "class=\"intro\"") +
                table.markup();
  return {"sources", "Files", std::move(body)};
}

}  // namespace ecs::app
