// What several sections are made of, and the summary.

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/plot/curves.hpp"
#include "modules/report/page.hpp"

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

namespace {

PlotPanel phase_panel(const MeasuredPhase& phase, std::string_view name, int decimals, std::string_view unit,
                      const params::PositionUnit& shown_in) {
  const laser::Curve& curve = phase.readings.level.curve;
  PlotPanel panel{fmt::format("{}: band {}", name, quantity_text(phase.readings.band, decimals, unit)),
                  fmt::format("{} position [{}]", letter_of(curve.axis), shown_in.length),
                  fmt::format("error [{}]", unit_text(unit)),
                  {}};
  panel.series.push_back(spread_series(phase.readings.after));
  if (curve.approach_known) panel.series.push_back(mean_series(curve, Approach::reverse));
  panel.series.push_back(mean_series(curve, Approach::forward));
  for (PlotSeries& series : panel.series)
    for (PlotPoint& point : series.points) point.x /= shown_in.mm;
  return panel;
}

}  // namespace

Markup figure_of_row(const TableRow& row, const params::PositionUnit& shown_in) {
  const int decimals = decimals_of(row);
  const auto unit = laser::unit_of(row.planned.sense);
  PlotFigure figure{fmt::format("{}: error curves before and after compensation", row.planned.title), {}, 1, true};
  if (row.before) figure.panels.push_back(phase_panel(*row.before, "before", decimals, unit, shown_in));
  if (row.after) figure.panels.push_back(phase_panel(*row.after, "after", decimals, unit, shown_in));
  return element("figure", inline_svg(figure)) + Markup::literal("\n");
}

namespace {

Markup verdict_cell(const TableRow& row) {
  const RowVerdict verdict = verdict_of(row);
  const std::string_view sign = verdict == RowVerdict::within ? "✓ " : verdict == RowVerdict::above ? "▲ " : "";
  return text(fmt::format("{}{}", sign, word_for(verdict)));
}

Markup summary_table(const std::vector<TableRow>& rows, const std::vector<std::string>& ids) {
  TableMarkup table(columns("measurement||>before|>after|>ratio|>limit|unit|>E after|>R after|verdict"), "summary");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TableRow& row = rows[i];
    const int decimals = decimals_of(row);
    const auto band = [](const auto& phase) {
      return phase ? std::optional(phase->readings.band) : std::optional<double>();
    };
    const auto& limit = row.planned.published_after;
    const RowVerdict verdict = verdict_of(row);
    table.row({element("strong", element("a", row.planned.name, fmt::format("href=\"#{}\"", ids[i]))),
               text(row.planned.title), cell(band(row.before), decimals),
               element("strong", cell(band(row.after), decimals)), cell(row.ratio(), 1),
               text(limit ? plain_number(*limit) : "\u2013"), text(unit_text(laser::unit_of(row.planned.sense))),
               cell(row.after ? row.after->iso.E : std::nullopt, decimals),
               cell(row.after ? row.after->iso.R : std::nullopt, decimals), verdict_cell(row)},
              verdict == RowVerdict::above || verdict == RowVerdict::missing ? "open" : "");
  }
  return table.markup();
}

/// Error bands before and after as bars, those of one unit on one scale; nothing where none was measured both times.
Markup bands_figure(const std::vector<TableRow>& rows, std::string_view unit) {
  PlotPanel panel;
  PlotSeries before{"before", Mark::bar, {}}, after{"after", Mark::bar, {}};
  for (const TableRow& row : rows) {
    if (laser::unit_of(row.planned.sense) != unit || !row.before || !row.after) continue;
    const double place = static_cast<double>(panel.x_names.size());
    panel.x_names.push_back(row.planned.name);
    before.points.push_back({place, row.before->readings.band});
    after.points.push_back({place, row.after->readings.band});
    const int decimals = decimals_of(row);
    after.labels.push_back(fmt::format("{:.{}f} → {:.{}f} {}", row.before->readings.band, decimals,
                                       row.after->readings.band, decimals, unit_text(unit)));
  }
  if (panel.x_names.empty()) return {};
  panel.series = {std::move(before), std::move(after)};
  return element("figure", inline_svg({"Error band before (pale) and after (solid)", {std::move(panel)}, 1, false}));
}

std::string_view tone_of(const Judgement& j) {
  if (j.missing > 0 || j.within < j.judged) return "class=\"verdict open\"";
  return j.judged > 0 ? "class=\"verdict good\"" : "class=\"verdict\"";
}

}  // namespace

ReportSection summary_section(const ReportContent& content, const Judgement& judgement,
                              const std::vector<std::string>& ids) {
  Markup body = element("div",
                        element("strong", judgement.sentence) +
                            (judgement.worst_sentence.empty() ? Markup() : element("p", judgement.worst_sentence)),
                        tone_of(judgement));
  for (const std::string_view unit : {laser::unit_of(Sense::EX), laser::unit_of(Sense::EA)})
    body += bands_figure(content.rows, unit);
  body += Markup::literal("\n") + summary_table(content.rows, ids);
  body += paragraph_of(
      "Bars: pale before, solid after. Before, after: error band, the largest minus the smallest of all readings, both "
      "approaches and all runs, after the slope named with each component is removed. Ratio: before over after. E, R: "
      "systematic error and repeatability by ISO 230-2 of the remaining error; R is computed "
      "from standard deviations, so with few runs it may exceed the band. Where R is nearly as large as A, a map can "
      "hardly reduce the error further." +
          std::string(content.planned ? " Limit: the largest band that the plan allows or cites as published." : ""),
      "class=\"small\"");
  body += element("h3", "What to do next");
  body += judgement.next.empty() ? paragraph_of("No open points.") : list_of(without_commands(judgement.next));
  return {"summary", "Summary", std::move(body)};
}

}  // namespace ecs::app
