#include "modules/logbook/place.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/settings.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOff = "off";
constexpr const char* kUnnamed = "machine";

/// Letters and digits as they are, in lower case; what is between them one dash.
std::string file_word(const std::string& name) {
  std::string word;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || byte >= 0x80)
      word += static_cast<char>(std::tolower(byte));
    else if (!word.empty() && word.back() != '-')
      word += '-';
  }
  while (!word.empty() && word.back() == '-') word.pop_back();
  return word.substr(0, 100);
}

std::optional<LogOwner> owner_of(const fs::path& path) {
  const auto book = Logbook::open_to_read(path);
  if (!book) return std::nullopt;
  const auto owner = book->owner();
  return owner ? std::optional(*owner) : std::nullopt;
}

/// Names for a logbook that begins; the first that is free is taken.
fs::path free_name(const fs::path& folder, const LogOwner& owner) {
  const std::string machine = file_word(owner.machine), number = file_word(owner.serial_number);
  std::vector<std::string> names;
  if (!machine.empty()) names.push_back(machine);
  if (!number.empty()) names.push_back(machine.empty() ? number : fmt::format("{}-{}", machine, number));
  if (names.empty()) names.emplace_back(kUnnamed);
  const std::string last = names.back();
  for (int i = 2;; ++i) {
    for (const std::string& name : names) {
      std::error_code error;
      fs::path path = folder / (name + std::string(kLogbookExtension));
      if (!fs::exists(path, error)) return path;
    }
    names = {fmt::format("{}-{}", last, i)};
  }
}

/// The newest entries may lie in the write-ahead log beside it.
fs::file_time_type written(const fs::path& path) {
  fs::file_time_type newest = fs::file_time_type::min();
  for (const char* ending : {"", "-wal"}) {
    std::error_code error;
    const auto time = fs::last_write_time(path.string() + ending, error);
    if (!error) newest = std::max(newest, time);
  }
  return newest;
}

std::string quoted_value(std::string_view value) {
  value = trimmed(value);
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  return std::string(value);
}

LogOwner owner_in_header(std::string_view content) {
  LogOwner owner;
  for (const HeaderLine& line : header_lines(content)) {
    if (line.key == "machine" && owner.machine.empty()) owner.machine = quoted_value(line.value);
    if ((line.key == "serial_number" || line.key == "serial no") && owner.serial_number.empty())
      owner.serial_number = quoted_value(line.value);
  }
  return owner;
}

}  // namespace

Result<LogbookSetting> logbook_setting() {
  LogbookSetting setting;
  const std::string wanted = setting_or_empty("ECS_LOGBOOK", "logbook");
  if (lower(wanted) == kOff) {
    setting.off = true;
  } else if (wanted.ends_with(kLogbookExtension)) {
    setting.file = wanted;
  } else if (!wanted.empty()) {
    setting.folder = wanted;
  } else {
    ECS_TRY(state, state_folder());
    setting.folder = state / "logbooks";
  }
  return setting;
}

std::vector<fs::path> logbooks(const LogbookSetting& setting) {
  std::vector<fs::path> found;
  std::error_code error;
  if (!setting.file.empty() && fs::exists(setting.file, error)) found.push_back(setting.file);
  if (setting.folder.empty()) return found;
  for (fs::directory_iterator at(setting.folder, error), end; !error && at != end; at.increment(error))
    if (at->path().extension() == kLogbookExtension) found.push_back(at->path());
  std::sort(found.begin(), found.end());
  std::stable_sort(found.begin(), found.end(),
                   [](const fs::path& a, const fs::path& b) { return written(a) > written(b); });
  return found;
}

Result<std::optional<fs::path>> logbook_of(const LogbookSetting& setting, const LogOwner& owner) {
  if (setting.off) return std::optional<fs::path>();
  if (!setting.file.empty()) return std::optional(setting.file);
  if (owner.machine.empty() && owner.serial_number.empty()) return std::optional<fs::path>();
  std::error_code error;
  fs::create_directories(setting.folder, error);
  if (error)
    return tl::unexpected(
        Problem{ProblemKind::output, "cannot be made: " + error.message(), setting.folder.string(), 0, 0, {}});
  std::optional<fs::path> by_name_alone;
  for (const fs::path& path : logbooks(setting)) {
    const auto of = owner_of(path);
    if (!of || (of->machine.empty() && of->serial_number.empty()) || !belongs(*of, owner)) continue;
    const bool both = !owner.serial_number.empty() && of->serial_number == owner.serial_number;
    if (both || owner.serial_number.empty()) return std::optional(path);
    if (!by_name_alone) by_name_alone = path;
  }
  return by_name_alone ? by_name_alone : std::optional(free_name(setting.folder, owner));
}

std::string operator_name() {
  if (std::string set = setting_or_empty("ECS_OPERATOR", "operator"); !set.empty()) return set;
  if (const passwd* user = ::getpwuid(::geteuid()); user != nullptr && user->pw_name != nullptr) return user->pw_name;
  return {};
}

LogOwner owner_in(std::string_view content) {
  const std::size_t first = content.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string_view::npos) return {};
  if (const LogOwner owner = owner_in_header(content.substr(first));
      !owner.machine.empty() || !owner.serial_number.empty())
    return owner;
  const bool machine_file = content.find("configuration") != std::string_view::npos;
  if (!machine_file && content.find("[identity]") == std::string_view::npos) return {};
  const auto table = parse_toml(content, {});
  if (!table) return {};
  LogOwner owner;
  if (const auto* identity = table->get_as<toml::table>("identity")) {
    owner.machine = (*identity)["machine"].value_or(std::string());
    owner.serial_number = (*identity)["serial_number"].value_or(std::string());
  } else if (table->contains("axis") && table->contains("configuration")) {
    owner.machine = (*table)["name"].value_or(std::string());
  }
  return owner;
}

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
  const char* header;  ///< in the header of a measurement set
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
  const Json object = Json::parse(json, nullptr, false);
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
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::optional<Instrument>();
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
      if (const auto wrong = wrong_date(node->value_or(std::string())))
        reader.complain(*node, fmt::format("{}: {}", key, *wrong));
  if (const auto days = reader.number(table, kInterval)) {
    if (*days >= 1 && *days <= kMostDays)
      instrument.calibration_interval_days = static_cast<int>(*days);
    else
      reader.complain(*table.get(kInterval), fmt::format("{}: expected 1 to {} days", kInterval, kMostDays));
  }
  if (!reader.clean()) return tl::unexpected(reader.all());
  return instrument;
}

}  // namespace ecs::commissioning
