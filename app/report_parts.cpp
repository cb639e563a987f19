// What several sections of a report are made of.
#include "app/report_sections.hpp"

namespace ecs::app {

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
    if (!value.empty()) lines += element("div", element("dt", name) + element("dd", value)) + Markup::literal("\n");
  return lines.empty() ? lines : element("dl", lines, "class=\"facts\"") + Markup::literal("\n");
}

Markup cell(const std::optional<double>& value, int decimals) {
  return text(value ? number_text(*value, decimals) : "\u2013");
}

}  // namespace ecs::app
