// Tables of temperatures, pressure and humidity with a heading, as loggers write them.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/format.hpp"
#include "laser/import/time.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

/// What a column of the table is.
struct EnvironmentColumn {
  std::size_t index = 0;
  std::string name;  ///< of the measurement CSV; "time_s" for the time
  std::optional<Unit> unit;
};

bool has_word(const std::string& heading, std::string_view word) { return heading.find(word) != std::string::npos; }

/// "°C" of "air temperature (°C)" is degC.
std::optional<Unit> unit_in(std::string_view heading) {
  const std::size_t open = heading.find_first_of("([");
  if (open == std::string_view::npos) return std::nullopt;
  std::string name(trimmed(heading.substr(open + 1, heading.find_first_of(")]", open) - open - 1)));
  for (const std::string_view sign : {"\xC2\xB0", "\xC2\xBA"})
    if (name.starts_with(sign)) name.erase(0, sign.size());
  return unit_named(name);
}

/// Letters and digits of what stands before the unit, without the word for temperature.
std::string sensor_name(const std::string& heading) {
  std::string word;
  std::string name;
  for (const char c : heading.substr(0, heading.find_first_of("([")) + " ") {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (is_letter) {
      word += c;
      continue;
    }
    if (!word.empty() && !word.starts_with("temp")) name += (name.empty() ? "" : "_") + word;
    word.clear();
  }
  return name.empty() ? "air" : name;
}

std::string name_in(const std::string& heading, const std::optional<Unit>& unit) {
  if (has_word(heading, "time") || has_word(heading, "date")) return "time_s";
  if (has_word(heading, "press") || has_word(heading, "baro")) return "pressure_hPa";
  if (has_word(heading, "humid")) return "humidity_pct";
  if (!has_word(heading, "temp") && !(unit && unit->kind == UnitKind::temperature)) return {};
  if (has_word(heading, "air")) return "t_air_degC";
  for (const std::string_view word : {"material", "sample", "workpiece"})
    if (has_word(heading, word)) return "t_material_degC";
  return fmt::format("t_{}_degC", sensor_name(heading));
}

std::vector<EnvironmentColumn> columns_named(const std::vector<std::string_view>& headings) {
  std::vector<EnvironmentColumn> columns;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const std::string plain = lower(headings[i]);
    const auto unit = unit_in(headings[i]);
    std::string name = is_known_column(headings[i]) ? std::string(headings[i]) : name_in(plain, unit);
    const bool again = std::any_of(columns.begin(), columns.end(),
                                   [&](const EnvironmentColumn& column) { return column.name == name; });
    if (!name.empty() && !again) columns.push_back({i, std::move(name), unit});
  }
  return columns;
}

bool is_environment(const std::vector<EnvironmentColumn>& columns) {
  const auto count = std::count_if(columns.begin(), columns.end(), [](const EnvironmentColumn& column) {
    return is_sensor_column(column.name) || column.name == "pressure_hPa" || column.name == "humidity_pct";
  });
  const bool has_place = std::any_of(columns.begin(), columns.end(), [](const EnvironmentColumn& column) {
    return column.name == "reading" || column.name == "axis" || column.name == "x_mm";
  });
  return count >= 2 && !has_place;
}

/// A pressure without a unit is in Pa, hPa or kPa: at ground level they cannot be mistaken for each other.
double pressure_hPa(double value) {
  if (value > 30'000.0) return value / 100.0;
  return value < 130.0 ? value * 10.0 : value;
}

class EnvironmentTableReader {
 public:
  EnvironmentTableReader(std::string_view text, const std::string& file_name) : text_(text), findings_(file_name) {}

  Result<EnvironmentSeries> series() {
    const auto shape = table_shape(text_);
    const auto lines = lines_of(text_);
    delimiter_ = shape ? shape->delimiter : ',';
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (is_comment(lines[i])) continue;
      const auto cells = cells_of(lines[i], delimiter_);
      if (columns_.empty())
        take_heading(cells, static_cast<int>(i) + 1);
      else
        take_row(lines[i], cells, static_cast<int>(i) + 1);
      if (columns_.empty()) break;
    }
    if (findings_.empty() && series_.rows.empty()) findings_.add(0, 0, "expected rows below the heading, found none");
    if (!findings_.empty()) return tl::unexpected(findings_.as_problem());
    return std::move(series_);
  }

 private:
  void take_heading(const std::vector<std::string_view>& headings, int line) {
    auto columns = columns_named(headings);
    if (!is_environment(columns)) {
      findings_.add(line, 1, "expected a heading with temperatures, pressure or humidity, two of them");
      return;
    }
    width_ = headings.size();
    columns_ = std::move(columns);
    for (const EnvironmentColumn& column : columns_)
      if (column.name != "time_s") series_.columns.push_back(column.name);
  }

  void take_row(std::string_view line, const std::vector<std::string_view>& cells, int number) {
    if (cells.size() < width_)
      return findings_.add(number, 1,
                           fmt::format("expected {} cells as in the heading, found {}", width_, cells.size()));
    EnvironmentRow row;
    for (const EnvironmentColumn& column : columns_) {
      const std::string_view cell = cells[column.index];
      const bool is_time = column.name == "time_s";
      auto value = number_or_comma(cell);
      if (!value && is_time) {
        value = seconds_in(cell);
        series_.has_dates = value.has_value();
      } else if (value && column.unit) {
        value = *value * column.unit->factor + column.unit->offset;
      } else if (value && column.name == "pressure_hPa") {
        value = pressure_hPa(*value);
      }
      if (!value && !cell.empty())
        findings_.add(number, column_of(line, cell),
                      fmt::format("{}: expected a number{}, found {}", column.name,
                                  is_time ? " or a date and time" : "", in_quotes(cell)));
      if (is_time)
        row.time_s = value;
      else
        row.values.push_back(value);
    }
    series_.rows.push_back(std::move(row));
  }

  std::string_view text_;
  Findings findings_;
  char delimiter_ = ',';
  std::size_t width_ = 0;
  std::vector<EnvironmentColumn> columns_;
  EnvironmentSeries series_;
};

Result<EnvironmentSeries> read_environment_table(std::string_view text, const std::string& file_name) {
  return EnvironmentTableReader(text, file_name).series();
}

Recognition recognises_environment_table(const FileStart& file) {
  if (file.has("wavelength") || file.has("refractive")) return Recognition::no;
  const std::string heading = lower(file.first_line);
  for (const char* error : {"deviation", "error", "abweichung", "fehler",
                            "\xC3\xA9"
                            "cart",
                            "\xC3\x89"
                            "cart",
                            "erreur"})  // readings beside the air
    if (heading.find(error) != std::string::npos) return Recognition::no;
  for (const char delimiter : {',', ';', '\t'})
    if (is_environment(columns_named(cells_of(file.first_line, delimiter)))) return Recognition::likely;
  return Recognition::no;
}

}  // namespace

extern const FileFormat kEnvironmentTable{
    .id = "environment_table",
    .title = "table of the environment",
    .sample = "environment.csv",
    .recognises = recognises_environment_table,
    .read_environment = read_environment_table,
    .units = ErrorUnits::fixed,
};

}  // namespace ecs::laser
