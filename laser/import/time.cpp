#include "laser/import/time.hpp"

#include <chrono>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::laser {
namespace {

/// Non-negative whole numbers of `text` between the separators, exactly three.
std::optional<std::vector<long long>> three_of(std::string_view text, char separator) {
  std::vector<long long> numbers;
  for (const std::string_view part : split(text, separator)) {
    const auto number = integer_in(part);
    if (!number || *number < 0 || *number > 9999) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers.size() == 3 ? std::optional(numbers) : std::nullopt;
}

std::optional<double> date_s(std::string_view text) {
  using std::chrono::year_month_day;
  const bool year_first = text.find('.') == std::string_view::npos;
  const auto parts = three_of(text, year_first ? '-' : '.');
  if (!parts) return std::nullopt;
  const auto& n = *parts;
  const year_month_day date{std::chrono::year(static_cast<int>(n[year_first ? 0 : 2])),
                            std::chrono::month(static_cast<unsigned>(n[1])),
                            std::chrono::day(static_cast<unsigned>(n[year_first ? 2 : 0]))};
  if (!date.ok()) return std::nullopt;
  return 86'400.0 * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

std::optional<double> time_of_day_s(std::string_view text) {
  if (text.ends_with('Z')) text.remove_suffix(1);
  const auto parts = split(text, ':');
  if (parts.size() < 2 || parts.size() > 3) return std::nullopt;
  const auto hours = integer_in(parts[0]), minutes = integer_in(parts[1]);
  const auto seconds = parts.size() == 3 ? number_in(parts[2]) : std::optional(0.0);
  const bool whole = hours && minutes && seconds && *hours >= 0 && *hours < 24 && *minutes >= 0 && *minutes < 60 &&
                     *seconds >= 0.0 && *seconds < 61.0;
  if (!whole) return std::nullopt;
  return 3600.0 * static_cast<double>(*hours) + 60.0 * static_cast<double>(*minutes) + *seconds;
}

}  // namespace

std::optional<double> seconds_in(std::string_view text) {
  const std::string_view whole = trimmed(text);
  const std::size_t gap = whole.find_first_of(" T");
  if (gap == std::string_view::npos) return time_of_day_s(whole);
  const auto date = date_s(whole.substr(0, gap));
  const auto time = time_of_day_s(trimmed(whole.substr(gap + 1)));
  return date && time ? std::optional(*date + *time) : std::nullopt;
}

std::string date_time_text(double seconds) {
  using namespace std::chrono;
  constexpr double kDay_s = 86'400.0, kLatest_s = 3e11;
  if (!(seconds >= kDay_s) || seconds > kLatest_s) return {};
  const double days = std::floor(seconds / kDay_s);
  const year_month_day date(sys_days(std::chrono::days(static_cast<int>(days))));
  const auto ms = static_cast<long long>(std::floor((seconds - days * kDay_s) * 1000.0));
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:03}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), ms / 3'600'000,
                     ms / 60'000 % 60, ms / 1000 % 60, ms % 1000);
}

}  // namespace ecs::laser
