// A report as one page: its style, on a screen, light or dark, and on A4; its head, its sections.
#include "modules/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/shown.hpp"
#include "base/text.hpp"
#include "base/version.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kMinus = "\u2212";
constexpr std::string_view kThinBlank = "\u202f";
constexpr std::size_t kShort = 22;  ///< rows of a table that is not cut

bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

std::string class_attribute(std::string_view words) {
  return words.empty() ? std::string() : fmt::format("class=\"{}\"", words);
}

std::string with_minus(std::string digits) {
  if (!digits.starts_with('-')) return digits;
  if (digits.find_first_of("123456789") == std::string::npos) return digits.substr(1);
  return std::string(kMinus) + digits.substr(1);
}

}  // namespace

Markup Markup::literal(std::string html) { return Markup(std::move(html)); }

Markup text(std::string_view plain) {
  std::string html;
  for (const char c : shown(plain)) switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += c;
    }
  return Markup::literal(std::move(html));
}

Markup element(std::string_view tag, const Markup& inside, std::string_view attributes) {
  return Markup::literal(
      fmt::format("<{}{}{}>{}</{}>", tag, attributes.empty() ? "" : " ", attributes, inside.html(), tag));
}

Markup element(std::string_view tag, std::string_view inside, std::string_view attributes) {
  return element(tag, text(inside), attributes);
}

std::string fresh_id(std::string_view name, std::vector<std::string>& used) {
  std::string base;
  for (const char c : name) base += is_word(c) ? c : '-';
  if (base.empty() || base.front() == '-' || (base.front() >= '0' && base.front() <= '9')) base = "m" + base;
  std::string id = base;
  for (int n = 2; std::find(used.begin(), used.end(), id) != used.end(); ++n) id = fmt::format("{}-{}", base, n);
  used.push_back(id);
  return id;
}

std::string css_string(std::string_view plain) {
  std::string out;
  for (const char c : shown(plain)) {
    if (is_word(c) || c == ' ' || static_cast<unsigned char>(c) >= 0x80)
      out += c;
    else
      out += fmt::format("\\{:06x} ", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return out;
}

std::string number_text(double value, int decimals) {
  if (!std::isfinite(value)) return "\u2013";
  return with_minus(fmt::format("{:.{}f}", value, decimals));
}

std::string quantity_text(double value, int decimals, std::string_view unit) {
  return fmt::format("{}{}{}", number_text(value, decimals), kThinBlank, unit_text(unit));
}

std::string plain_number(double value) {
  if (!std::isfinite(value)) return "\u2013";
  std::string digits = fmt::format("{:.3f}", value);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  return with_minus(std::move(digits));
}

int decimals_for(double value) {
  const double size = std::abs(value);
  if (size >= 2.0) return 1;
  if (size >= 0.2) return 2;
  return size > 0.0 ? 3 : 1;
}

std::string unit_text(std::string_view unit) {
  std::string out;
  for (std::size_t at = 0; at < unit.size();) {
    const auto joins = [](char c) { return is_word(c) || c == '_'; };
    const bool begins = at == 0 || !joins(unit[at - 1]);
    const auto here = [&](std::string_view word) {
      return begins && unit.substr(at).starts_with(word) &&
             (at + word.size() == unit.size() || !joins(unit[at + word.size()]));
    };
    if (here("um") || here("us")) {
      out += "µ";
      out += unit[at + 1];
      at += 2;
    } else if (here("m2") || here("m3")) {
      out += unit[at + 1] == '2' ? "m²" : "m³";
      at += 2;
    } else if (here("degC")) {
      out += "°C";
      at += 4;
    } else {
      out += unit[at++];
    }
  }
  return out;
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::vector<TableColumn> columns(std::string_view titles) {
  std::vector<TableColumn> all;
  for (const std::string_view title : split(titles, '|')) {
    const bool number = title.starts_with('>');
    all.push_back({std::string(title.substr(number ? 1 : 0)), number});
  }
  return all;
}

TableMarkup::TableMarkup(std::vector<TableColumn> columns, std::string_view style)
    : columns_(std::move(columns)), style_(style) {}

void TableMarkup::row(const std::vector<Markup>& cells, std::string_view style) {
  Markup line;
  for (std::size_t i = 0; i < cells.size(); ++i)
    line += element("td", cells[i], class_attribute(i < columns_.size() && columns_[i].number ? "n" : ""));
  ++count_;
  rows_ += element("tr", line, class_attribute(style)) + Markup::literal("\n");
}

Markup TableMarkup::markup() const {
  Markup head;
  for (const TableColumn& column : columns_)
    head += element("th", column.title, column.number ? "class=\"n\" scope=\"col\"" : "scope=\"col\"");
  return element("table", element("thead", element("tr", head)) + Markup::literal("\n") + element("tbody", rows_),
                 class_attribute(count_ > kShort  ? style_
                                 : style_.empty() ? "whole"
                                                  : style_ + " whole")) +
         Markup::literal("\n");
}

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
