// A report as one page: its style, on a screen, light or dark, and on A4; its head, its sections.
#include "modules/report/page.hpp"

#include <fmt/format.h>

#include "base/version.hpp"

namespace ecs::app {
namespace {

/// The text at the edge of every printed page.
struct PageEdges {
  std::string top_left;
  std::string top_right;
  std::string bottom_left;
};

constexpr const char* kStyle = R"css(
:root { --ink: #16202b; --soft: #566270; --rule: #c9d0d8; --faint: #eef1f4; --paper: #ffffff; --good: #1f6b45;
  --open: #9a3412; --fwd: #0b4f9e; --rev: #b4501a; --spread: #b9c1ca; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { @media screen { :root { --ink: #e4e8ed; --soft: #9aa6b3; --rule: #3a4450;
  --faint: #1d242c; --paper: #14191f; --good: #7bc79f; --open: #f0a27a; --fwd: #79b1f0; --rev: #f0a36e;
  --spread: #55606c; } } }
* { box-sizing: border-box; }
html { background: var(--paper); color: var(--ink); font: 10pt/1.42 "Inter", "Segoe UI", "Helvetica Neue", Arial,
  "Liberation Sans", "DejaVu Sans", sans-serif; font-variant-numeric: tabular-nums; }
body { max-width: 190mm; margin: 10mm auto; padding: 0 5mm; overflow-wrap: break-word; }
header { border-bottom: 2.5pt solid var(--ink); padding-bottom: 3mm; margin-bottom: 4mm; }
header .kind { color: var(--soft); text-transform: uppercase; letter-spacing: .12em; font-size: 8pt; margin: 0; }
h1 { font-size: 22pt; line-height: 1.15; margin: 1mm 0 3mm; font-weight: 650; }
h2 { font-size: 14pt; line-height: 1.2; margin: 9mm 0 2.5mm; padding-bottom: 1mm; border-bottom: .8pt solid var(--ink);
  font-weight: 650; }
h3 { font-size: 10.5pt; margin: 4.5mm 0 1.2mm; font-weight: 650; }
h1, h2, h3 { break-after: avoid; break-inside: avoid; }
p { margin: 0 0 2mm; orphans: 3; widows: 3; }
ul { margin: 0 0 2.5mm; padding-left: 5mm; }
li { margin-bottom: .8mm; break-inside: avoid; }
.small, .how { color: var(--soft); font-size: 8.3pt; line-height: 1.35; }
.how { margin-bottom: 1mm; }
.lead { font-size: 11pt; font-weight: 600; }
.absent { color: var(--soft); font-style: italic; }
.problem { color: var(--open); font-weight: 600; }
.verdict { border-left: 4pt solid var(--soft); background: var(--faint); padding: 2.5mm 4mm; margin-bottom: 4mm;
  break-inside: avoid; }
.verdict strong { font-size: 12.5pt; font-weight: 650; }
.verdict p { margin: 1mm 0 0; }
.verdict.good { border-color: var(--good); }
.verdict.open { border-color: var(--open); border-left-style: double; border-left-width: 7pt; }
.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(54mm, 1fr)); gap: 1.6mm 6mm;
  margin: 0 0 3mm; break-after: avoid; }
.facts div { break-inside: avoid; }
dt { color: var(--soft); font-size: 8pt; line-height: 1.2; }
dd { margin: 0; font-weight: 550; }
.facts .wide { grid-column: 1 / -1; }
.intro { break-after: avoid; break-inside: avoid; }
nav { font-size: 8.5pt; color: var(--soft); margin-bottom: 2mm; }
nav a { color: inherit; margin-right: 3.5mm; }
table { border-collapse: collapse; width: 100%; margin: 1mm 0 3mm; font-size: 8.4pt; line-height: 1.28; }
thead { display: table-header-group; }
tr { break-inside: avoid; }
.whole { break-inside: avoid; }
table.summary { break-inside: auto; }
th { text-align: left; font-weight: 600; color: var(--soft); border-bottom: .8pt solid var(--ink); padding: .7mm 1.2mm;
  vertical-align: bottom; }
td { border-bottom: .4pt solid var(--rule); padding: .65mm 1.2mm; vertical-align: top; }
th:first-child, td:first-child { padding-left: 0; }
th:last-child, td:last-child { padding-right: 0; }
th.n, td.n { text-align: right; white-space: nowrap; }
th.n { white-space: normal; }
td a { color: inherit; text-decoration-color: var(--rule); }
td.n strong { white-space: nowrap; }
td:first-child, td:nth-child(2) { overflow-wrap: anywhere; }
tr.open td { background: var(--faint); font-weight: 600; }
table.summary td:nth-child(2) { width: 30%; }
table.iso { font-size: 7.6pt; }
table.iso th, table.iso td { padding-left: .7mm; padding-right: .7mm; }
table.dense { font-size: 7.8pt; }
table.dense td:nth-child(3) { white-space: nowrap; }
table.dense td { padding-top: .35mm; padding-bottom: .35mm; }
table.keys td { padding-top: .35mm; padding-bottom: .35mm; }
table.sources { font-size: 7.2pt; }
table.sources td { padding-top: .3mm; padding-bottom: .3mm; }
code { font: 0.95em "JetBrains Mono", "DejaVu Sans Mono", "Liberation Mono", monospace; }
article { break-inside: avoid; margin-bottom: 3mm; }
article h3 { display: flex; gap: 2.5mm; align-items: baseline; border-top: .5pt solid var(--rule); padding-top: 2mm; }
.code { font-weight: 700; }
.badge { margin-left: auto; font-size: 8pt; font-weight: 600; color: var(--soft); border: .6pt solid var(--rule);
  padding: 0 1.6mm; }
.badge.open { color: var(--paper); background: var(--open); border-color: var(--open); }
figure { margin: 0 0 1mm; break-inside: avoid; }
svg { display: block; width: 100%; height: auto; }
svg text { fill: var(--ink); font-size: 10px; font-family: inherit; }
svg .tick { fill: var(--soft); font-size: 9.2px; }
svg .name { font-weight: 600; }
svg .end { text-anchor: end; }
svg .mid { text-anchor: middle; }
svg path { fill: none; }
svg .grid { stroke: var(--rule); stroke-width: .5; }
svg .zero { stroke: var(--soft); stroke-width: .8; }
svg .frame { stroke: var(--soft); stroke-width: .8; }
svg .spread { stroke: var(--spread); stroke-width: 1.6; }
svg .line { stroke-width: 1.25; stroke-linejoin: round; }
svg .fwd { stroke: var(--fwd); }
svg .rev { stroke: var(--rev); }
svg .bid { stroke: var(--ink); }
svg .line.rev { stroke-dasharray: 6 3; }
svg .mark { stroke-width: .9; }
svg .mark.fwd { fill: var(--fwd); }
svg .mark.rev { fill: var(--paper); }
svg .mark.bid { fill: var(--ink); }
svg .bar { fill: var(--fwd); }
svg .bar.before { fill: var(--ink); opacity: 0.22; }
svg .level { stroke: var(--ink); stroke-width: 1; stroke-dasharray: 4 3; }
footer { margin-top: 8mm; border-top: .8pt solid var(--rule); padding-top: 2mm; color: var(--soft); font-size: 8pt; }
@media screen and (max-width: 720px) { table { display: block; overflow-x: auto; } body { padding: 0 3mm; } }
@media print {
  body { max-width: none; margin: 0; padding: 0; }
  nav, footer { display: none; }
  td a { text-decoration: none; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)css";

constexpr const char* kPage = R"css(@page {{ size: A4; margin: 19mm 15mm 17mm 17mm;
  @top-left {{ content: "{}"; font: 8pt sans-serif; color: #566270; }}
  @top-right {{ content: "{}"; font: 8pt sans-serif; color: #566270; }}
  @bottom-left {{ content: "{}"; font: 8pt sans-serif; color: #566270; }}
  @bottom-right {{ content: counter(page) " / " counter(pages); font: 8pt sans-serif; color: #566270; }} }}
)css";

/// The style sheet; names nothing outside the page.
std::string report_style(const PageEdges& edges) {
  return kStyle + fmt::format(fmt::runtime(kPage), css_string(edges.top_left), css_string(edges.top_right),
                              css_string(edges.bottom_left));
}

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
  facts.emplace_back("measurements before compensation", dates_of(content, &TableRow::before));
  facts.emplace_back("measurements after compensation", dates_of(content, &TableRow::after));
  facts.emplace_back("date of the report", content.date.empty() ? "no date was given" : content.date);
  facts.emplace_back("error map (SHA-256)", content.map ? content.map->sha256.substr(0, 16) + "…" : "none given");
  if (content.map && content.map->check)
    facts.emplace_back("checksum (CRC-32) in the unit", fmt::format("{:08X}", *content.map->check));
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
