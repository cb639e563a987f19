// What several sections of a report are made of.
#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/sections.hpp"
#include "base/paragraph.hpp"

namespace ecs::app {
namespace {

constexpr std::size_t kLong = 36;  ///< letters in a column

/// Where an option ("--machine") or a command ("`ecs", "(ecs") begins.
std::size_t command_in(std::string_view plain) {
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const std::string_view rest = plain.substr(i);
    const bool option = rest.size() > 2 && rest.starts_with("--") && rest[2] >= 'a' && rest[2] <= 'z' &&
                        (i == 0 || plain[i - 1] == ' ' || plain[i - 1] == '(' || plain[i - 1] == '`');
    if (option || rest.starts_with("`ecs") || rest.starts_with("(ecs ")) return i;
  }
  return std::string_view::npos;
}

/// The bracket around a place, or the part of a sentence with it, from the mark before it to the one behind it.
std::pair<std::size_t, std::size_t> part_about(std::string_view plain, std::size_t at) {
  const std::size_t open = plain.rfind('(', at), closed = plain.rfind(')', at), close = plain.find(')', at);
  if (open != std::string_view::npos && (closed == std::string_view::npos || closed < open) &&
      close != std::string_view::npos)
    return {open > 0 && plain[open - 1] == ' ' ? open - 1 : open, close + 1};
  std::size_t from = 0, to = plain.size();
  for (const std::string_view mark : {". ", "; ", ": "}) {
    if (const std::size_t before = plain.substr(0, at).rfind(mark); before != std::string_view::npos)
      from = std::max(from, mark == ". " ? before + 1 : before);
    if (mark != ": ") to = std::min(to, plain.find(mark, at));
  }
  if (to < plain.size() && plain[to] == '.' && plain[from] == ' ') ++to;  // a whole sentence with its stop
  return {from, std::min(to, plain.size())};
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string without_commands(std::string_view plain) {
  std::string out(plain);
  for (std::size_t at = command_in(out); at != std::string::npos; at = command_in(out)) {
    const auto [from, to] = part_about(out, at);
    out.erase(from, to - from);
  }
  const std::size_t first = out.find_first_not_of(" ;:.,");
  return first == std::string::npos ? std::string() : out.substr(first);
}

std::vector<std::string> without_commands(const std::vector<std::string>& items) {
  std::vector<std::string> out;
  for (const std::string& item : items)
    if (std::string plain = without_commands(item); !plain.empty()) out.push_back(std::move(plain));
  return out;
}

std::string first_few(const std::vector<std::string>& names) {
  if (names.size() <= kMostRivals) return fmt::format("{}", fmt::join(names, ", "));
  return fmt::format("{} and {} more", fmt::join(names.begin(), names.begin() + kMostRivals, ", "),
                     names.size() - kMostRivals);
}

Markup paragraph_of(std::string_view plain, std::string_view attributes) {
  return element("p", plain, attributes) + Markup::literal("\n");
}

Markup absence(std::string_view plain) { return paragraph_of(plain, "class=\"absent\""); }

Markup list_of(const std::vector<std::string>& items) {
  Markup lines;
  for (const std::string& item : items) lines += element("li", item) + Markup::literal("\n");
  return lines.empty() ? lines : element("ul", lines) + Markup::literal("\n");
}

Markup facts_of(const std::vector<std::pair<std::string, std::string>>& facts) {
  Markup lines;
  for (const auto& [name, value] : facts)
    if (!value.empty())
      lines += element("div", element("dt", name) + element("dd", value),
                       columns_of(value) > kLong ? "class=\"wide\"" : "") +
               Markup::literal("\n");
  return lines.empty() ? lines : element("dl", lines, "class=\"facts\"") + Markup::literal("\n");
}

std::string worded(std::string_view line) {
  const std::string units = unit_text(line);
  std::string out;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const bool starts = i == 0 || units[i - 1] == ' ';
    if (units[i] == '-' && starts && i + 1 < units.size() && is_digit(units[i + 1]))
      out += "\u2212";
    else
      out += units[i] == '_' ? ' ' : units[i];
  }
  return out;
}

Markup cell(const std::optional<double>& value, int decimals) {
  return text(value ? number_text(*value, decimals) : "\u2013");
}

}  // namespace ecs::app
