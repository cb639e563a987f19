// What several sections of a report are made of.
#include "app/report/sections.hpp"
#include "base/paragraph.hpp"

namespace ecs::app {
namespace {

constexpr std::size_t kLong = 36;  ///< letters in a column

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

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
