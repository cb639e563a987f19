// The header of a map as text.
#include <algorithm>

#include <fmt/format.h>

#include "base/shown.hpp"
#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {
namespace {

/// Of who, what and when; the unit's identity has 40 bytes for the name of the machine.
constexpr std::size_t kLongestHeaderName = 200;
/// Of a source, a reason, a step of the processing.
constexpr std::size_t kLongestHeaderLine = 1U << 16;

/// One line, whatever was typed: line ends become blanks.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

void put(std::string& text, std::string_view key, const std::string& value) {
  if (!value.empty()) text += fmt::format("{}: {}\n", key, one_line(value));
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
  if (!component_of(entry.code) || mark == std::string_view::npos)
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

std::string take(MapHeader& header, std::string_view key, std::string_view value) {
  const bool names = key == "customer" || key == "machine" || key == "serial_number" || key == "date" ||
                     key == "engineer" || key == "configuration";
  if (const std::size_t most = names ? kLongestHeaderName : kLongestHeaderLine; value.size() > most)
    return fmt::format("header: {} has {} bytes, expected at most {}", in_quotes(key), value.size(), most);
  if (key == "customer")
    header.customer = value;
  else if (key == "machine")
    header.machine = value;
  else if (key == "serial_number")
    header.serial_number = value;
  else if (key == "date")
    header.date = value;
  else if (key == "engineer")
    header.engineer = value;
  else if (key == "configuration")
    header.configuration = value;
  else if (key == "processing")
    header.processing.emplace_back(value);
  else if (key == "source")
    return take_source(header, value);
  else if (key == "declared_zero")
    return take_declared_zero(header, value);
  else if (key == "uncertainty")
    return take_uncertainty(header, value);
  else
    return fmt::format("header: no such key {}", in_quotes(key));
  return {};
}

}  // namespace

std::string header_text(const MapHeader& header) {
  std::string text;
  put(text, "customer", header.customer);
  put(text, "machine", header.machine);
  put(text, "serial_number", header.serial_number);
  put(text, "date", header.date);
  put(text, "engineer", header.engineer);
  put(text, "configuration", header.configuration);
  for (const SourceFile& s : header.sources)
    put(text, "source", fmt::format("{} {} sha256={}", s.component, s.name, s.sha256));
  for (const DeclaredZero& z : header.declared_zero)
    put(text, "declared_zero", fmt::format("{} {}", name_of(z.component), z.reason));
  for (const StatedUncertainty& u : header.uncertainty)
    put(text, "uncertainty",
        fmt::format("{} value={:.4g} pass={:.4g} degrees_of_freedom={}", name_of(u.component), u.value, u.pass,
                    u.degrees_of_freedom));
  for (const std::string& step : header.processing) put(text, "processing", step);
  return text;
}

Result<MapHeader> parse_header(std::string_view text, const std::string& source_name) {
  MapHeader header;
  Findings findings(source_name);
  int line = 0;
  for (const std::string_view as_written : lines_of(text)) {
    ++line;
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

}  // namespace ecs::laser
