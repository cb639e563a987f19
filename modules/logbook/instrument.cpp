#include <algorithm>
#include <array>
#include <chrono>
#include <sstream>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/settings.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "modules/logbook/place.hpp"

namespace ecs::commissioning {

std::vector<HeaderLine> header_lines(std::string_view content) {
  constexpr std::size_t kMostLines = 200;
  std::vector<HeaderLine> lines;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < kMostLines && begin < content.size(); ++k) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view text = trimmed(content.substr(begin, end - begin));
    begin = end + 1;
    if (!text.starts_with('#')) break;
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) continue;
    lines.push_back({lower(trimmed(text.substr(1, colon - 1))), trimmed(text.substr(colon + 1))});
  }
  return lines;
}

namespace {

struct TextKey {
  const char* key;     ///< in JSON and TOML
  const char* header;  ///< in the header of a measurement file
  std::string Instrument::*member;
};
constexpr std::array<TextKey, 6> kTextKeys{{
    {"name", "instrument", &Instrument::name},
    {"manufacturer", "instrument_manufacturer", &Instrument::manufacturer},
    {"serial_number", "instrument_serial_number", &Instrument::serial_number},
    {"calibration_certificate", "calibration_certificate", &Instrument::calibration_certificate},
    {"calibration_date", "calibration_date", &Instrument::calibration_date},
    {"valid_until", "calibration_valid_until", &Instrument::valid_until},
}};
constexpr const char* kInterval = "calibration_interval_days";
constexpr int kMostDays = 36500;
/// A line break as \n: the library loses the first one behind three quotes.
constexpr auto kOneLine = toml::toml_formatter::default_flags &
                          ~(toml::format_flags::allow_multi_line_strings | toml::format_flags::allow_literal_strings);

std::optional<std::chrono::sys_days> day_in(const std::string& text) {
  int year = 0;
  unsigned month = 0, day = 0;
  if (!is_iso_date(text) || std::sscanf(text.c_str(), "%d-%u-%u", &year, &month, &day) != 3) return std::nullopt;
  return std::chrono::sys_days(std::chrono::year(year) / std::chrono::month(month) / std::chrono::day(day));
}

std::string text_of(std::chrono::sys_days day) {
  const std::chrono::year_month_day date(day);
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

}  // namespace

bool is_known(const Instrument& instrument) { return instrument != Instrument{}; }

std::string valid_until(const Instrument& instrument) {
  if (!instrument.valid_until.empty()) return instrument.valid_until;
  const auto from = day_in(instrument.calibration_date);
  if (!from || !instrument.calibration_interval_days) return {};
  return text_of(*from + std::chrono::days(*instrument.calibration_interval_days));
}

std::optional<bool> calibrated_on(const Instrument& instrument, const std::string& day) {
  const auto at = day_in(day.substr(0, 10));
  const auto until = day_in(valid_until(instrument).substr(0, 10));
  if (!at || !until) return std::nullopt;
  const auto from = day_in(instrument.calibration_date.substr(0, 10));
  return *at <= *until && (!from || *from <= *at);
}

std::string instrument_json(const Instrument& instrument, const std::string& day) {
  if (!is_known(instrument)) return {};
  Json object = Json::object();
  for (const TextKey& one : kTextKeys) object[one.key] = text_or_null(instrument.*one.member);
  object["valid_until"] = text_or_null(valid_until(instrument));
  object[kInterval] =
      instrument.calibration_interval_days ? Json(*instrument.calibration_interval_days) : Json(nullptr);
  const auto calibrated = calibrated_on(instrument, day);
  object["calibrated"] = calibrated ? Json(*calibrated) : Json(nullptr);
  return one_line(object);
}

Instrument instrument_in_json(std::string_view json) {
  Instrument instrument;
  const Json object = json_in(json);
  if (!object.is_object()) return instrument;
  for (const TextKey& one : kTextKeys)
    if (const auto found = object.find(one.key); found != object.end() && found->is_string())
      instrument.*one.member = found->get<std::string>();
  if (const auto found = object.find(kInterval); found != object.end() && found->is_number_integer())
    instrument.calibration_interval_days = found->get<int>();
  return instrument;
}

Instrument instrument_in_header(std::string_view content) {
  Instrument instrument;
  for (const HeaderLine& line : header_lines(content)) {
    for (const TextKey& one : kTextKeys)
      if (line.key == one.header) instrument.*one.member = line.value;
    if (line.key == kInterval)
      if (const auto days = integer_in(line.value); days && *days > 0 && *days <= kMostDays)
        instrument.calibration_interval_days = static_cast<int>(*days);
  }
  return instrument;
}

std::string instrument_file() {
  if (std::string named = setting_or_empty("ECS_INSTRUMENT", "instrument"); !named.empty()) return named;
  return (settings_file().parent_path() / "instrument.toml").string();
}

Result<std::optional<Instrument>> instrument_in_use() {
  const std::string file = instrument_file();
  if (!disc::exists(file)) return std::optional<Instrument>();
  ECS_TRY(text, read_file(file));
  ECS_TRY(instrument, parse_instrument(text, file));
  return std::optional(std::move(instrument));
}

std::string to_toml(const Instrument& instrument) {
  std::ostringstream text;
  toml::table table;
  for (const TextKey& one : kTextKeys)
    if (!(instrument.*one.member).empty()) table.insert(one.key, instrument.*one.member);
  if (instrument.calibration_interval_days) table.insert(kInterval, *instrument.calibration_interval_days);
  text << "# The instrument that measures; its certificate stands in the logbook (modules/logbook/README.md).\n"
       << toml::toml_formatter(table, kOneLine) << '\n';
  return text.str();
}

Result<Instrument> parse_instrument(std::string_view text, const std::string& file) {
  TomlReader reader(file);
  ECS_TRY(table, reader.parsed(text));
  Instrument instrument;
  std::vector<std::string> known{kInterval};
  for (const TextKey& one : kTextKeys) {
    known.emplace_back(one.key);
    instrument.*one.member = reader.word(table, one.key).value_or("");
  }
  reader.only(table, known, "an instrument file");
  for (const char* key : {"calibration_date", "valid_until"})
    if (const auto* node = table.get(key); node != nullptr && node->is_string())
      if (const auto wrong = wrong_date(node->value_or(std::string()))) reader.complain(*node, "{}: {}", key, *wrong);
  if (const auto days = reader.number(table, kInterval)) {
    if (*days >= 1 && *days <= kMostDays)
      instrument.calibration_interval_days = static_cast<int>(*days);
    else
      reader.complain(*table.get(kInterval), "{}: expected 1 to {} days", kInterval, kMostDays);
  }
  if (!reader.clean()) return tl::unexpected(reader.all());
  return instrument;
}

}  // namespace ecs::commissioning
