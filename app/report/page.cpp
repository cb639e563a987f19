#include "app/report/page.hpp"

#include <fmt/format.h>

#include "app/report/sections.hpp"
#include "app/report/style.hpp"
#include "base/version.hpp"

namespace ecs::app {
namespace {

std::string machine_name(const ReportContent& content) {
  const std::string name = header_value(content, "machine");
  return name.empty() ? "Machine without a name" : name;
}

std::string map_hash(const ReportContent& content) {
  return content.map ? "map " + content.map->sha256.substr(0, 16) : std::string("no map");
}

PageEdges edges_of(const ReportContent& content) {
  const std::string serial = header_value(content, "serial_number");
  return {machine_name(content) + (serial.empty() ? "" : " · " + serial), map_hash(content),
          content.date.empty() ? std::string("Commissioning report") : "Commissioning report · " + content.date};
}

/// "serial_number" as people read it.
std::string title_of(std::string key) {
  for (char& c : key)
    if (c == '_') c = ' ';
  return key;
}

/// First and last date of a phase's files.
std::string dates_of(const ReportContent& content, std::optional<MeasuredPhase> TableRow::*phase) {
  std::string first, last;
  for (const TableRow& row : content.rows) {
    if (!(row.*phase)) continue;
    const auto date = laser::metadata_value((row.*phase)->readings.before, "date");
    if (!date || date->empty()) continue;
    if (first.empty() || *date < first) first = *date;
    if (*date > last) last = *date;
  }
  return first == last ? first : first + " … " + last;
}

Markup head_of(const ReportContent& content) {
  std::vector<std::pair<std::string, std::string>> facts;
  for (const auto& [key, value] : content.header)
    if (key != "machine" && key != "date") facts.emplace_back(title_of(key), value);
  if (content.machine) facts.emplace_back("configuration", content.machine->configuration);
  facts.emplace_back("measured before", dates_of(content, &TableRow::before));
  facts.emplace_back("measured after", dates_of(content, &TableRow::after));
  facts.emplace_back("date of the report", content.date.empty() ? "no date was given" : content.date);
  facts.emplace_back("error map (SHA-256)", content.map ? content.map->sha256.substr(0, 16) + "…" : "none given");
  if (content.map && content.map->check)
    facts.emplace_back("block check in the unit", fmt::format("{:08X}", *content.map->check));
  return element("header", element("p", "Commissioning report", "class=\"kind\"") +
                               element("h1", machine_name(content)) + facts_of(facts)) +
         Markup::literal("\n");
}

Markup contents_of(const std::vector<ReportSection>& sections) {
  Markup links;
  for (const ReportSection& section : sections)
    links += element("a", section.title, fmt::format("href=\"#{}\"", section.id)) + Markup::literal("\n");
  return element("nav", links) + Markup::literal("\n");
}

Markup laid_out(const ReportSection& section) {
  return element("section", element("h2", section.title) + Markup::literal("\n") + section.body,
                 fmt::format("id=\"{}\"", section.id)) +
         Markup::literal("\n");
}

/// Sections without a body become one list before the last section.
std::vector<ReportSection> without_absent(std::vector<ReportSection> all) {
  std::vector<std::string> absent;
  for (const ReportSection& section : all)
    if (section.body.empty()) absent.push_back(fmt::format("{}: {}.", section.title, section.absent));
  std::erase_if(all, [](const ReportSection& section) { return section.body.empty(); });
  if (!absent.empty())
    all.insert(all.end() - 1, {"absent", "Not part of this report", list_of(without_commands(absent))});
  return all;
}

}  // namespace

std::string report_page(const ReportContent& content, const Judgement& judgement) {
  std::vector<std::string> used{"summary", "machine",    "conditions", "components", "prediction", "volume", "circles",
                                "effects", "parameters", "map",        "unit",       "sources",    "absent"};
  std::vector<std::string> ids;
  for (const TableRow& row : content.rows) ids.push_back(fresh_id("c-" + row.planned.name, used));
  const std::vector<ReportSection> sections = without_absent(
      {summary_section(content, judgement, ids), components_section(content, ids), prediction_section(content),
       volume_section(content), circles_section(content), effects_section(content), machine_section(content),
       conditions_section(content), map_section(content), parameters_section(content), unit_section(content),
       sources_section(content)});
  Markup body = head_of(content) + contents_of(sections);
  for (const ReportSection& section : sections) body += laid_out(section);
  body += element("footer", fmt::format("{} · {} · {}", program_version(), machine_name(content), map_hash(content)));
  const std::string title = fmt::format("Commissioning report: {}", machine_name(content));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n{}\n<style>{}</style>\n</head>\n"
      "<body>\n{}\n</body>\n</html>\n",
      element("title", title).html(), report_style(edges_of(content)), body.html());
}

}  // namespace ecs::app
