#include "laser/import/time.hpp"

#include <chrono>
#include <vector>

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

}  // namespace ecs::laser
