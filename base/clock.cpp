// The time of day as the files and messages write it, and dates of the calendar.
#include "base/clock.hpp"

#include <chrono>
#include <ctime>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs {

std::string now_utc() { return utc_of(std::time(nullptr)); }

std::string utc_of(std::int64_t unix_s) {
  const std::time_t time = unix_s;
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return {text, length};
}

double steady_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

namespace {

/// The digits at `from` as a number; nothing if there is another character among them.
std::optional<int> digits(std::string_view text, std::size_t from, std::size_t count) {
  if (text.size() < from + count) return std::nullopt;
  int value = 0;
  for (const char c : text.substr(from, count)) {
    if (c < '0' || c > '9') return std::nullopt;
    value = 10 * value + (c - '0');
  }
  return value;
}

/// "09:10", "09:10:11", "09:10:11.25", each with or without "Z".
bool is_time(std::string_view text) {
  if (text.ends_with('Z')) text.remove_suffix(1);
  const auto hour = digits(text, 0, 2), minute = digits(text, 3, 2);
  if (!hour || !minute || text[2] != ':' || *hour > 23 || *minute > 59) return false;
  if (text.size() == 5) return true;
  const auto second = digits(text, 6, 2);
  if (!second || text[5] != ':' || *second > 60) return false;
  if (text.size() == 8) return true;
  return text[8] == '.' && text.size() > 9 && text.find_first_not_of("0123456789", 9) == std::string_view::npos;
}

}  // namespace

bool is_iso_date(std::string_view text) {
  text = trimmed(text);
  const auto year = digits(text, 0, 4), month = digits(text, 5, 2), day = digits(text, 8, 2);
  if (!year || !month || !day || text[4] != '-' || text[7] != '-') return false;
  const std::chrono::year_month_day date{std::chrono::year{*year}, std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return false;
  if (text.size() == 10) return true;
  return (text[10] == 'T' || text[10] == ' ') && is_time(text.substr(11));
}

std::optional<std::string> wrong_date(std::string_view text) {
  if (trimmed(text).empty() || is_iso_date(text)) return std::nullopt;
  return fmt::format("expected year-month-day, as in 2026-03-12, found \"{}\"", text);
}

}  // namespace ecs
