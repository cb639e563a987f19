// The header of a map as text, and the whole map.
#include "laser/map/csv.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/csv_table.hpp"
#include "laser/findings.hpp"
#include "laser/map/rotary_map.hpp"
#include "laser/text_decoding.hpp"

namespace ecs::laser {
namespace {

/// Of who, what and when; the unit's identity has 40 bytes for the name of the machine.
constexpr std::size_t kLongestHeaderName = 200;
/// Of a source, a reason, a step of the processing.
constexpr std::size_t kLongestHeaderLine = 1U << 16;

void put(std::string& text, std::string_view key, const std::string& value) {
  if (!value.empty()) text += fmt::format("{}: {}\n", key, shown_line(value));
}

/// `code rest of the line`
struct Coded {
  std::string_view code;
  std::string_view rest;
};
Coded coded(std::string_view value) {
  const std::size_t blank = value.find(' ');
  if (blank == std::string_view::npos) return {value, {}};
  return {value.substr(0, blank), trimmed(value.substr(blank))};
}

std::string take_source(MapHeader& header, std::string_view value) {
  const Coded entry = coded(value);
  const std::size_t mark = entry.rest.rfind(" sha256=");
  const bool of_rotary_axis =
      entry.code.size() == 1 && std::string_view("ABC").find(entry.code) != std::string_view::npos;
  if (!(component_of(entry.code) || of_rotary_axis) || mark == std::string_view::npos)
    return fmt::format("source: expected CODE FILE sha256=…, found {}", in_quotes(value));
  header.sources.push_back({std::string(entry.code), std::string(trimmed(entry.rest.substr(0, mark))),
                            std::string(trimmed(entry.rest.substr(mark + 8)))});
  return {};
}

std::string take_declared_zero(MapHeader& header, std::string_view value) {
  const Coded entry = coded(value);
  const auto component = component_of(entry.code);
  if (!component || entry.rest.empty())
    return fmt::format("declared_zero: expected CODE and a reason, found {}", in_quotes(value));
  header.declared_zero.push_back({*component, std::string(entry.rest)});
  return {};
}

/// `EXX value=0.98 pass=0.18 degrees_of_freedom=4`
std::string take_uncertainty(MapHeader& header, std::string_view value) {
  const Coded entry = coded(value);
  const auto component = component_of(entry.code);
  const auto number_of = [&](std::string_view key) -> std::optional<double> {
    for (const std::string_view word : split(entry.rest, ' '))
      if (word.starts_with(key) && word.substr(key.size()).starts_with('='))
        return number_in(word.substr(key.size() + 1));
    return std::nullopt;
  };
  const auto each = number_of("value"), pass = number_of("pass"), freedom = number_of("degrees_of_freedom");
  if (!component || !each || !pass || !freedom || *each < 0.0 || *pass < 0.0 || *freedom < 0.0 || *freedom > 1e6)
    return fmt::format("uncertainty: expected CODE value=… pass=… degrees_of_freedom=…, found {}", in_quotes(value));
  header.uncertainty.push_back({*component, *each, *pass, static_cast<int>(*freedom)});
  return {};
}

/// Number of an input in words, from 1: "5", "load", "motion_X", "deviation".
std::string input_word(std::uint8_t source) {
  if (source == kDeviationSource) return "deviation";
  if (follows_motion(source)) return fmt::format("motion_{}", letter_of(static_cast<Axis>(source - kMotionOfX)));
  return source == kLoadInput ? "load" : std::to_string(source + 1);
}

std::optional<std::uint8_t> input_named(std::string_view word) {
  if (word == "load") return static_cast<std::uint8_t>(kLoadInput);
  if (word == "deviation") return kDeviationSource;
  if (word.size() == 8 && word.starts_with("motion_"))
    if (const auto axis = axis_of(word.back())) return static_cast<std::uint8_t>(kMotionOfX + index_of(*axis));
  const auto number = integer_in(word);
  if (!number || *number < 1 || *number > static_cast<long long>(kTemperatureInputs)) return std::nullopt;
  return static_cast<std::uint8_t>(*number - 1);
}

/// The value of `key=value` among the words of a line.
std::optional<std::string_view> value_of(std::string_view line, std::string_view key) {
  for (const std::string_view word : split(line, ' '))
    if (word.starts_with(key) && word.substr(key.size()).starts_with('=')) return word.substr(key.size() + 1);
  return std::nullopt;
}

/// `3 t_spindle_degC`
std::string take_input(MapHeader& header, std::string_view value) {
  const Coded entry = coded(value);
  const auto number = input_named(entry.code);
  if (!number || *number >= kTemperatureInputs || entry.rest.empty())
    return fmt::format("input: expected a number 1 to {} and a sensor, found {}", kTemperatureInputs, in_quotes(value));
  header.inputs.push_back({*number, std::string(entry.rest)});
  return {};
}

std::string take_thermal(MapHeader& header, std::string_view value) {
  const Coded entry = coded(value);
  ThermalRow row;
  const auto component = component_of(entry.code);
  const auto law = thermal_law_named(coded(entry.rest).code);
  const auto source = input_named(value_of(entry.rest, "input").value_or(""));
  const auto minus = value_of(entry.rest, "minus");
  const auto other = minus ? input_named(*minus) : std::optional(kNoInput);
  bool whole = component && law && source && other;
  if (whole) row = {*component, *law, *source, *other};
  for (const auto& [key, into] : {std::pair{"coefficient", &row.coefficient},
                                  {"reference", &row.reference},
                                  {"lag_s", &row.lag_s},
                                  {"origin_mm", &row.origin_mm}}) {
    const auto number = number_in(value_of(entry.rest, key).value_or(""));
    whole = whole && number;
    if (number) *into = *number;
  }
  if (!whole || !sound(row))
    return fmt::format(
        "thermal: expected a row such as EZZ shift input=5 coefficient=2.4 reference=20 lag_s=0 "
        "origin_mm=0 within the ranges of the unit, found {}",
        in_quotes(value));
  header.thermal.push_back(row);
  return {};
}

/// Key and number of each thermal setting.
template <class Settings>
auto settings_of(Settings& s) {
  return std::array{std::pair{"rate_um_per_s", &s.rate_um_per_s},
                    std::pair{"hold_s", &s.hold_s},
                    std::pair{"longest_age_s", &s.longest_age_s},
                    std::pair{"stuck_s", &s.stuck_s},
                    std::pair{"fastest_degC_per_s", &s.fastest_degC_per_s},
                    std::pair{"step_degC", &s.step_degC},
                    std::pair{"least_degC", &s.least_degC},
                    std::pair{"greatest_degC", &s.greatest_degC}};
}

/// Keys that the line leaves out keep their usual value.
std::string take_thermal_settings(MapHeader& header, std::string_view value) {
  ThermalSettings settings;
  for (const std::string_view word : split(value, ' ')) {
    if (word.empty()) continue;
    const auto all = settings_of(settings);
    const auto* const its =
        std::ranges::find_if(all, [&](const auto& one) { return word.starts_with(fmt::format("{}=", one.first)); });
    const auto number = number_in(word.substr(std::min(word.size(), word.find('=') + 1)));
    if (its == all.end() || !number)
      return fmt::format("thermal_settings: expected key=number, found {}", in_quotes(word));
    *its->second = *number;
  }
  if (!sound(settings))
    return fmt::format("thermal_settings: expected numbers within the ranges of the unit, found {}", in_quotes(value));
  header.thermal_settings = settings;
  return {};
}

/// Who, what and when: in the order of the text.
constexpr std::array<std::pair<std::string_view, std::string MapHeader::*>, 6> kNames{
    {{"customer", &MapHeader::customer},
     {"machine", &MapHeader::machine},
     {"serial_number", &MapHeader::serial_number},
     {"date", &MapHeader::date},
     {"engineer", &MapHeader::engineer},
     {"configuration", &MapHeader::configuration}}};

std::string take(MapHeader& header, std::string_view key, std::string_view value) {
  const auto* const name = std::ranges::find(kNames, key, [](const auto& one) { return one.first; });
  if (const std::size_t most = name != kNames.end() ? kLongestHeaderName : kLongestHeaderLine; value.size() > most)
    return fmt::format("header: {} has {} bytes, expected at most {}", in_quotes(key), value.size(), most);
  if (name != kNames.end())
    header.*name->second = value;
  else if (key == "processing")
    header.processing.emplace_back(value);
  else if (key == "source")
    return take_source(header, value);
  else if (key == "declared_zero")
    return take_declared_zero(header, value);
  else if (key == "uncertainty")
    return take_uncertainty(header, value);
  else if (key == "input")
    return take_input(header, value);
  else if (key == "thermal")
    return take_thermal(header, value);
  else if (key == "thermal_settings")
    return take_thermal_settings(header, value);
  else if (is_rotary_key(key))
    return take_rotary_line(header, key, value);
  else
    return fmt::format("header: no such key {}", in_quotes(key));
  return {};
}

}  // namespace

std::string to_text(const ThermalRow& row) {
  const std::string minus = row.minus == kNoInput ? "" : fmt::format(" minus={}", input_word(row.minus));
  return fmt::format("{} {} input={}{} coefficient={} reference={} lag_s={} origin_mm={}", name_of(row.component),
                     name_of(row.law), input_word(row.source), minus, shortest(row.coefficient),
                     shortest(row.reference), shortest(row.lag_s), shortest(row.origin_mm));
}

std::string source_text(const MapHeader& header, std::uint8_t source) {
  if (follows_motion(source)) return fmt::format("the motion of {}", letter_of(static_cast<Axis>(source - kMotionOfX)));
  if (source == kLoadInput) return "the load";
  if (source == kDeviationSource) return "the deviation that an instrument shows";
  const auto its = std::ranges::find(header.inputs, source, &NamedInput::input);
  return its == header.inputs.end() ? fmt::format("input {}", source + 1)
                                    : fmt::format("input {} ({})", source + 1, its->sensor);
}

std::string header_text(const MapHeader& header) {
  std::string text;
  for (const auto& [key, member] : kNames) put(text, key, header.*member);
  for (const SourceFile& s : header.sources)
    put(text, "source", fmt::format("{} {} sha256={}", s.component, s.name, s.sha256));
  for (const DeclaredZero& z : header.declared_zero)
    put(text, "declared_zero", fmt::format("{} {}", name_of(z.component), z.reason));
  for (const StatedUncertainty& u : header.uncertainty)
    put(text, "uncertainty",
        fmt::format("{} value={:.4g} pass={:.4g} degrees_of_freedom={}", name_of(u.component), u.value, u.pass,
                    u.degrees_of_freedom));
  for (const NamedInput& named : header.inputs)
    put(text, "input", fmt::format("{} {}", input_word(named.input), named.sensor));
  for (const ThermalRow& row : header.thermal) put(text, "thermal", to_text(row));
  if (!header.thermal.empty() && header.thermal_settings != ThermalSettings{}) {
    std::string settings;
    for (const auto& [key, number] : settings_of(header.thermal_settings))
      settings += fmt::format("{}{}={}", settings.empty() ? "" : " ", key, shortest(*number));
    put(text, "thermal_settings", settings);
  }
  text += rotary_lines(header);
  for (const std::string& step : header.processing) put(text, "processing", step);
  return text;
}

Result<MapHeader> parse_header(std::string_view text, const std::string& source_name) {
  MapHeader header;
  Findings findings(source_name);
  for (const auto& [line, as_written] : numbered_lines_of(text)) {
    if (trimmed(as_written).empty()) continue;
    const std::string plain = shown(as_written);  // its names go to terminals and into files of other controls
    const std::string_view row = plain;
    const std::size_t colon = row.find(':');
    const std::string fault = colon == std::string_view::npos
                                  ? fmt::format("header: expected key: value, found {}", in_quotes(row))
                                  : take(header, trimmed(row.substr(0, colon)), trimmed(row.substr(colon + 1)));
    if (!fault.empty()) findings.add(line, 1, fault);
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return header;
}

namespace {

constexpr std::array<std::string_view, 5> kColumns{"axis", "sense", "approach", "p_mm", "value_um"};
constexpr double kLargest_um = 32'000.0;

struct Point {
  double position_mm;
  double compensation;
  int line;
};
using TableKey = std::pair<Component, Approach>;

struct Order {  // by component, forward before reverse
  bool operator()(const TableKey& a, const TableKey& b) const {
    if (a.first != b.first) return a.first < b.first;
    return static_cast<int>(a.second) > static_cast<int>(b.second);
  }
};
using Points = std::map<TableKey, std::vector<Point>, Order>;

/// Place of each column in the rows; nothing and a finding if the header row is not ours.
std::optional<std::array<std::size_t, 5>> columns_in(const CsvLine& row, int line, Findings& findings) {
  std::array<std::size_t, 5> place;
  place.fill(row.fields.size());
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    const CsvField& field = row.fields[i];
    const auto known = std::ranges::find(kColumns, field.text);
    if (field.text == "p_deg") {
      findings.add(
          line, field.column,
          "header: expected p_mm, found p_deg: a table of rotary axes, for --rotary of `ecs volume` and `ecs map "
          "build`");
      return std::nullopt;
    }
    if (known == kColumns.end()) {
      findings.add(line, field.column, "header: expected axis, sense, approach, p_mm, value_um, found {}",
                   in_quotes(field.text));
    } else if (place[static_cast<std::size_t>(known - kColumns.begin())] != row.fields.size()) {
      findings.add(line, field.column, "header: column {} occurs twice", field.text);
    } else {
      place[static_cast<std::size_t>(known - kColumns.begin())] = i;
    }
  }
  for (std::size_t k = 0; k < kColumns.size(); ++k)
    if (place[k] == row.fields.size()) findings.add(line, 0, "header: column {} is missing", kColumns[k]);
  if (!findings.empty()) return std::nullopt;
  return place;
}

/// One row into the points; what is wrong with it into the findings.
void take_row(const CsvLine& row, const std::array<std::size_t, 5>& place, int line, Points& points,
              Findings& findings) {
  const auto wrong = [&](std::size_t k, std::string_view expected) {
    const CsvField& field = row.fields[place[k]];
    findings.add(line, field.column, "{}: expected {}, found {}", kColumns[k], expected, in_quotes(field.text));
  };
  const auto text = [&](std::size_t k) -> const std::string& { return row.fields[place[k]].text; };
  const auto axis = text(0).size() == 1 ? axis_of(text(0)[0]) : std::nullopt;
  const auto sense = sense_named(text(1));
  const auto approach = integer_in(text(2));
  const auto position_mm = number_in(text(3));
  const auto value = number_in(text(4));
  const bool approach_known = approach && *approach >= -1 && *approach <= 1;
  const bool value_possible = value && std::abs(*value) <= kLargest_um;
  if (!axis) wrong(0, "X, Y or Z");
  if (!sense) wrong(1, "EX, EY, EZ, EA, EB or EC");
  if (!approach_known) wrong(2, "1, -1 or 0 (both)");
  if (!position_mm) wrong(3, "a position in mm");
  if (!value_possible) wrong(4, "a compensation in um (um/m for angles) within ±32000");
  if (!axis || !sense || !approach_known || !position_mm || !value_possible) return;
  points[{curve_of(*sense, *axis), static_cast<Approach>(*approach)}].push_back({*position_mm, *value, line});
}

MapTable table_from(const TableKey& key, std::vector<Point> points, Findings& findings) {
  std::ranges::stable_sort(points, [](const Point& a, const Point& b) { return a.position_mm < b.position_mm; });
  MapTable table{key.first, key.second, {}, {}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && points[i].position_mm == points[i - 1].position_mm)
      findings.add(points[i].line, 0, "{} has position {} mm twice (also in line {})", name_of(key.first),
                   points[i].position_mm, points[i - 1].line);
    table.position_mm.push_back(points[i].position_mm);
    table.compensation.push_back(points[i].compensation);
  }
  return table;
}

void refuse_mixed_approaches(const Points& points, Findings& findings) {
  for (const auto& [key, rows] : points) {
    if (key.second != Approach::unknown) continue;
    const bool also_one =
        points.contains({key.first, Approach::forward}) || points.contains({key.first, Approach::reverse});
    if (also_one)
      findings.add(rows.front().line, 0, "{} has rows for approach 0 (both) and rows for 1 or -1: keep one kind",
                   name_of(key.first));
  }
}

/// `rows: N` of a header line; it belongs to the file, not to the map.
std::optional<long long> rows_stated(std::string_view header_line) {
  if (!header_line.starts_with("rows:")) return std::nullopt;
  return integer_in(header_line.substr(5));
}

/// What is left of a file that lost its end.
void refuse_cut_file(long long stated, long long found, bool whole_line, Findings& findings) {
  if (stated != found)
    findings.add(0, 0,
                 "the header states {} rows, the file has {}: was it truncated? If you added or removed rows, correct "
                 "or delete the line \"# rows\"",
                 stated, found);
  else if (!whole_line)
    findings.add(0, 0, "the last row does not end with a line end: the file was truncated");
}

/// The text of a map from whatever editor saved it. What is not text is left to the readers of lines, but for a NUL.
Result<std::string> as_utf8(std::string_view bytes, const std::string& file_name) {
  const bool plain = std::ranges::none_of(bytes, [](char c) { return c == '\0' || (c & 0x80) != 0; });
  if (plain) return std::string(bytes);
  auto text = decoded(bytes, file_name);
  if (text) return std::move(text->text);
  if (utf16_order(bytes)) return tl::unexpected(std::move(text.error()));
  if (auto why = why_no_text(bytes, file_name)) return tl::unexpected(std::move(*why));
  return std::string(bytes);
}

}  // namespace

std::string to_map_csv(const ErrorMap& map) {
  std::string text;
  const std::string header = header_text(map.header);
  for (const std::string_view line : lines_of(header)) text += fmt::format("# {}\n", shown_line(line));
  std::size_t rows = 0;
  for (const MapTable& table : map.tables) rows += table.position_mm.size();
  text += fmt::format("# rows: {}\n", rows);
  text += "axis,sense,approach,p_mm,value_um\n";
  for (const MapTable& table : map.tables)
    for (std::size_t i = 0; i < table.position_mm.size(); ++i)
      text +=
          fmt::format("{},{},{},{},{}\n", letter_of(moving_axis(table.component)), name_of(sense_of(table.component)),
                      static_cast<int>(table.approach), table.position_mm[i], table.compensation[i]);
  return text;
}

Result<ErrorMap> parse_map_csv(std::string_view bytes, const std::string& file_name) {
  ECS_TRY(plain, as_utf8(bytes, file_name));
  std::string_view text = plain;
  Findings findings(file_name);
  std::string header;
  std::optional<std::array<std::size_t, 5>> place;
  Points points;
  std::optional<long long> stated_rows;
  long long rows_found = 0;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (const auto& [line, row] : numbered_lines_of(text)) {
    const std::string_view content = trimmed(row);
    if (content.starts_with('#')) {
      const std::string_view entry = trimmed(content.substr(1));
      if (const auto stated = rows_stated(entry))
        stated_rows = stated;
      else
        header += entry;
    } else if (!content.empty()) {
      const CsvLine fields = csv_fields(row);
      if (!fields.fault.empty()) {
        findings.add(line, fields.fault_column, fields.fault);
      } else if (!place) {
        place = columns_in(fields, line, findings);
        if (!place) return tl::unexpected(findings.as_problem());
      } else if (fields.fields.size() != kColumns.size()) {
        findings.add(line, 1, "expected {} fields, found {}", kColumns.size(), fields.fields.size());
      } else {
        ++rows_found;
        take_row(fields, *place, line, points, findings);
      }
    }
    header += '\n';  // header lines keep the numbers of their lines in the file
  }
  if (!place)
    findings.add(0, 0,
                 "not a complete map: expected a header row axis,sense,approach,p_mm,value_um, found none. Is the file "
                 "truncated?");
  refuse_mixed_approaches(points, findings);
  if (stated_rows && findings.empty()) refuse_cut_file(*stated_rows, rows_found, text.ends_with('\n'), findings);

  ErrorMap map;
  for (auto& [key, rows] : points) map.tables.push_back(table_from(key, std::move(rows), findings));
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  ECS_TRY(parsed, parse_header(header, file_name));
  map.header = std::move(parsed);
  if (map.tables.empty() && map.header.thermal.empty() && map.header.rotary.empty())
    return problem(ProblemKind::bad_input, "{}: the map has no rows", file_name);
  return map;
}

Result<ErrorMap> read_map_csv(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::map, path));
  return parse_map_csv(text, path.string());
}

}  // namespace ecs::laser
