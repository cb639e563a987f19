#include "laser/csv_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/findings.hpp"

namespace ecs::laser {

std::vector<std::string> heading_words(std::string_view heading) {
  std::vector<std::string> words{""};
  for (const char c : lower(heading)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 || std::isalnum(byte) != 0)
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  }
  return words;
}

std::optional<Approach> approach_named(std::string_view word) {
  constexpr std::string_view kForward = "1 +1 + f fwd forward up pos v vor vorw\u00E4rts hin aller";
  constexpr std::string_view kReverse =
      "-1 - r b rev reverse bwd backward back neg down r\u00FCck r\u00FCckw\u00E4rts zur\u00FCck retour";
  const std::string name = lower(word);
  const auto is_among = [&](std::string_view words) {
    const auto list = split(words, ' ');
    return std::ranges::find(list, name) != list.end();
  };
  if (is_among(kForward)) return Approach::forward;
  if (is_among(kReverse)) return Approach::reverse;
  return name.empty() || name == "0" ? std::optional(Approach::unknown) : std::nullopt;
}

namespace {

std::string expected(std::string_view column, std::string_view what, std::string_view cell) {
  return fmt::format("{}: expected {}, found {}", column, what, in_quotes(cell));
}

std::string expected_number(std::string_view column, std::string_view cell) {
  std::string with_point(cell);
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  const bool decimal_comma = with_point != cell && number_in(with_point).has_value();
  return expected(column, "a finite number", cell) +
         (decimal_comma ? ": a decimal comma; write numbers with a decimal point" : "");
}

/// "2", "2.0" and "+2" are the integer 2.
std::optional<int> integer_cell(std::string_view cell) {
  const auto value = number_in(cell);
  if (!value || *value != std::floor(*value) || std::abs(*value) > std::numeric_limits<int>::max()) return std::nullopt;
  return static_cast<int>(*value);
}

std::string set_axis(Reading& reading, std::string_view cell) {
  const auto named = axis_named(cell);
  if (!named) return expected("axis", "X, Y, Z, A, B or C", cell);
  reading.axis = named->axis;
  reading.rotary = named->rotary;
  return {};
}

std::string set_sense(Reading& reading, std::string_view cell) {
  const auto sense = sense_named(cell);
  if (!sense) return expected("sense", "EX, EY, EZ (um) or EA, EB, EC (um/m)", cell);
  reading.sense = *sense;
  return {};
}

std::string set_error(Reading& reading, std::string_view cell) {
  const auto value = number_in(cell);
  if (!value) return expected_number("reading", cell);
  reading.error = *value;
  return {};
}

std::string set_approach(Reading& reading, std::string_view cell) {
  const auto named = approach_named(cell);
  const auto value = named ? std::optional(static_cast<int>(*named)) : integer_cell(cell);
  if (!value || std::abs(*value) > 1) return expected("approach", "1, -1, 0, forward or reverse", cell);
  reading.approach = static_cast<Approach>(*value);
  return {};
}

std::string set_run(Reading& reading, std::string_view cell) {
  const auto value = cell.empty() ? std::optional<int>(1) : integer_cell(cell);
  if (!value) return expected("run", "an integer", cell);
  reading.run = *value;
  return {};
}

std::string set_compensated(Reading& reading, std::string_view cell) {
  if (cell.empty()) return {};
  const auto value = integer_cell(cell);
  if (!value || *value < 0 || *value > 1) return expected("compensated", "0 or 1", cell);
  reading.compensated = *value == 1;
  return {};
}

const NumberColumn* number_column(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(kNumberColumns, [&](const NumberColumn& column) { return column.name == name; });
  return found == kNumberColumns.end() ? nullptr : found;
}

template <class Names>
bool is_in(const Names& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

std::optional<NamedAxis> axis_named(std::string_view letter) {
  for (const bool rotary : {false, true})
    for (const Axis axis : kAllAxes)
      if (letter == std::string_view(rotary ? "ABC" : "XYZ").substr(index_of(axis), 1)) return NamedAxis{axis, rotary};
  return std::nullopt;
}

bool is_known_column(std::string_view name) {
  return is_in(kOtherColumns, name) || is_in(kPositionColumns, name) || is_in(kAngleColumns, name) ||
         number_column(name) != nullptr || is_sensor_column(name);
}

std::string set_cell(Reading& reading, std::string_view column, std::string_view cell) {
  if (column == "axis") return set_axis(reading, cell);
  if (column == "sense") return set_sense(reading, cell);
  if (column == "reading") return set_error(reading, cell);
  if (column == "approach") return set_approach(reading, cell);
  if (column == "run") return set_run(reading, cell);
  if (column == "compensated") return set_compensated(reading, cell);
  if (cell.empty()) return {};
  const auto value = number_in(cell);
  if (!value) return expected_number(column, cell);
  if (const NumberColumn* number = number_column(column); number != nullptr) {
    reading.*(number->member) = *value;
  } else if (is_sensor_column(column)) {
    reading.sensors_degC.insert_or_assign(std::string(column), *value);
  } else {
    for (std::size_t i = 0; i < kAxes; ++i)
      if (kPositionColumns[i] == column)
        reading.position_mm[i] = *value;
      else if (kAngleColumns[i] == column)
        reading.angle_deg[i] = *value;
  }
  return {};
}

}  // namespace ecs::laser
