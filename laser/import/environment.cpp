// Environment logs, joined by time to measurements: tables of temperatures, pressure and humidity with a heading, as
// loggers write them; logs of SIOS nanomeasuring machines, nine numbers a line (m, degC, Pa, percent).
#include "laser/import/environment.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/time.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

bool is_condition(std::string_view column) {
  return is_sensor_column(column) || column == "pressure_hPa" || column == "humidity_pct";
}

/// First and last time of the readings; nothing if one has none.
std::optional<std::pair<double, double>> span_of(const MeasurementSet& set) {
  std::optional<std::pair<double, double>> span;
  for (const Reading& reading : set.readings) {
    if (!reading.time_s) return std::nullopt;
    if (!span) span.emplace(*reading.time_s, *reading.time_s);
    span->first = std::min(span->first, *reading.time_s);
    span->second = std::max(span->second, *reading.time_s);
  }
  return span;
}

/// One column of the log with the times of its rows on the clock of the readings.
struct Condition {
  std::string name;
  std::vector<double> times_s;
  std::vector<double> values;
};

double between(const Condition& condition, double time_s) {
  const auto after = std::lower_bound(condition.times_s.begin(), condition.times_s.end(), time_s);
  if (after == condition.times_s.begin()) return condition.values.front();
  if (after == condition.times_s.end()) return condition.values.back();
  const auto i = static_cast<std::size_t>(after - condition.times_s.begin());
  const double share = (time_s - condition.times_s[i - 1]) / (condition.times_s[i] - condition.times_s[i - 1]);
  return condition.values[i - 1] + share * (condition.values[i] - condition.values[i - 1]);
}

bool has_condition(const Reading& reading, const std::string& name) {
  if (name == "pressure_hPa") return reading.pressure_hPa.has_value();
  if (name == "humidity_pct") return reading.humidity_pct.has_value();
  return reading.sensors_degC.contains(name);
}

/// Times of the log's rows on the clock of the readings.
Result<std::vector<double>> times_of(MeasurementSet& set, const EnvironmentSeries& series,
                                     std::optional<double> every_s) {
  const auto span = span_of(set);
  const auto count = static_cast<double>(series.rows.size());
  const bool has_times =
      std::ranges::all_of(series.rows, [](const EnvironmentRow& row) { return row.time_s.has_value(); });
  if (!span && (has_times || every_s))
    return tl::unexpected(usage(set.source,
                                "environment: the readings have no time (time_s, or date_time in --columns), but the "
                                "environment has: they cannot be joined by time"));
  const double begin = span ? span->first : 0.0;
  const double length = span ? span->second - span->first : static_cast<double>(set.readings.size() - 1);
  std::vector<double> times;
  if (!has_times) {
    const double step = every_s.value_or(count > 1.0 ? length / (count - 1.0) : 0.0);
    for (std::size_t i = 0; i < series.rows.size(); ++i) times.push_back(begin + step * static_cast<double>(i));
    set.notes.push_back(every_s
                            ? fmt::format("environment: a row every {:g} s from the first reading on", *every_s)
                            : fmt::format("environment: it has no time; its {} rows are distributed evenly over the {}",
                                          series.rows.size(), span ? "time of the readings" : "readings"));
    return times;
  }
  const auto begun = metadata_value(set, kBegun);
  const auto begun_s = begun ? seconds_in(*begun) : std::nullopt;
  const bool by_date = series.has_dates && begun_s;
  const double zero = by_date ? *begun_s : *series.rows.front().time_s - begin;
  for (const EnvironmentRow& row : series.rows) times.push_back(*row.time_s - zero);
  set.notes.push_back(by_date ? "environment: joined by date and time"
                              : "environment: joined by time, assumed to begin with the first reading");
  const double before = times.front() - begin, after = begin + length - times.back();
  for (const auto& [missing_s, what] : {std::pair{before, "before it begins"}, {after, "after it ends"}})
    if (missing_s > 0.0)
      set.notes.push_back(
          fmt::format("environment: the readings extend {:.0f} s {}, where its end values are used", missing_s, what));
  return times;
}

std::vector<Condition> conditions_of(const EnvironmentSeries& series, const std::vector<double>& times_s) {
  std::vector<Condition> conditions;
  for (std::size_t c = 0; c < series.columns.size(); ++c) {
    if (!is_condition(series.columns[c])) continue;
    Condition condition{series.columns[c], {}, {}};
    for (std::size_t i = 0; i < series.rows.size(); ++i) {
      if (!series.rows[i].values[c] || (!condition.times_s.empty() && times_s[i] <= condition.times_s.back())) continue;
      condition.times_s.push_back(times_s[i]);
      condition.values.push_back(*series.rows[i].values[c]);
    }
    if (!condition.values.empty()) conditions.push_back(std::move(condition));
  }
  return conditions;
}

}  // namespace

Result<void> join_environment(MeasurementSet& set, const EnvironmentSeries& series, std::optional<double> every_s) {
  if (set.readings.empty() || series.rows.empty()) return {};
  ECS_TRY(times_s, times_of(set, series, every_s));
  const auto conditions = conditions_of(series, times_s);
  std::vector<std::string> joined;
  for (const Condition& condition : conditions) {
    std::size_t given = 0;
    for (std::size_t i = 0; i < set.readings.size(); ++i) {
      Reading& reading = set.readings[i];
      if (has_condition(reading, condition.name)) continue;
      const double value = between(condition, reading.time_s.value_or(static_cast<double>(i)));
      static_cast<void>(set_cell(reading, condition.name, shortest(value)));
      ++given;
    }
    if (given == 0) continue;
    const auto [least, most] = std::ranges::minmax_element(condition.values);
    joined.push_back(fmt::format("{} {:.6g} ... {:.6g}", condition.name, *least, *most));
    if (!set.columns.empty() && std::ranges::find(set.columns, condition.name) == set.columns.end())
      set.columns.push_back(condition.name);
  }
  if (!joined.empty()) set.notes.push_back(fmt::format("environment: {}", fmt::join(joined, ", ")));
  return {};
}

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
    const bool again =
        std::ranges::any_of(columns, [&](const EnvironmentColumn& column) { return column.name == name; });
    if (!name.empty() && !again) columns.push_back({i, std::move(name), unit});
  }
  return columns;
}

bool is_environment(const std::vector<EnvironmentColumn>& columns) {
  const auto count = std::ranges::count_if(columns, [](const EnvironmentColumn& column) {
    return is_sensor_column(column.name) || column.name == "pressure_hPa" || column.name == "humidity_pct";
  });
  const bool has_place = std::ranges::any_of(columns, [](const EnvironmentColumn& column) {
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
    delimiter_ = shape ? shape->delimiter : ',';
    for (const auto& [number, line] : numbered_lines_of(text_)) {
      if (is_comment(line)) continue;
      const auto cells = cells_of(line, delimiter_);
      if (columns_.empty())
        take_heading(cells, number);
      else
        take_row(line, cells, number);
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
      findings_.add(line, 1, "expected a heading with two of temperature, pressure and humidity");
      return;
    }
    width_ = headings.size();
    columns_ = std::move(columns);
    for (const EnvironmentColumn& column : columns_)
      if (column.name != "time_s") series_.columns.push_back(column.name);
  }

  void take_row(std::string_view line, const std::vector<std::string_view>& cells, int number) {
    if (cells.size() < width_)
      return findings_.add(number, 1, "expected {} cells as in the heading, found {}", width_, cells.size());
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
        findings_.add(number, column_of(line, cell), "{}: expected a number{}, found {}", column.name,
                      is_time ? " or a date and time" : "", in_quotes(cell));
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

namespace {

Result<EnvironmentSeries> read_sios_environment(std::string_view text, const std::string& file_name) {
  EnvironmentSeries series;
  series.columns = {"x_mm",         "y_mm",         "z_mm",         "t_air_degC",   "t_air_x_degC",
                    "t_air_y_degC", "t_air_z_degC", "pressure_hPa", "humidity_pct", "t_material_degC"};
  Findings findings(file_name);
  for (const auto& [number, line] : numbered_lines_of(text)) {
    if (trimmed(line).empty()) continue;
    const auto row = row_of(line, 9);
    if (!row) {
      findings.add(
          number, 1,
          "expected nine numbers (X, Y, Z, three air temperatures, pressure, humidity, sample temperature), found " +
              in_quotes(trimmed(line)));
      continue;
    }
    const auto& n = *row;
    series.rows.push_back({std::nullopt,
                           {n[0] * kMmPerM, n[1] * kMmPerM, n[2] * kMmPerM, (n[3] + n[4] + n[5]) / 3.0, n[3], n[4],
                            n[5], n[6] / kPaPerHPa, n[7], n[8]}});
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (series.rows.empty()) return problem_at(file_name, 0, 0, "expected environment records, found none");
  return series;
}

/// Nine numbers, the seventh a pressure in Pa.
Recognition recognises_environment(const FileStart& file) {
  constexpr double kLeast_Pa = 30'000.0, kMost_Pa = 130'000.0;  // from the highest workshop to any weather
  const auto numbers = numbers_alone(file.first_line);
  const bool fits = numbers.size() == 9 && numbers[6] > kLeast_Pa && numbers[6] < kMost_Pa;
  return fits ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kSiosEnvironment{
    .id = "sios_environment",
    .title = "SIOS environment log (.pos)",
    .sample = "environment.pos",
    .recognises = recognises_environment,
    .read_environment = read_sios_environment,
    .units = ErrorUnits::fixed,
};

}  // namespace ecs::laser
