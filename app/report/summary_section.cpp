// The first page of a report: the verdict, every component in one table, the worst, what to do next.
#include <fmt/format.h>

#include "app/report/sections.hpp"
#include "app/report/svg.hpp"

namespace ecs::app {
namespace {

Markup verdict_cell(const TableRow& row) {
  const RowVerdict verdict = verdict_of(row);
  const std::string_view sign = verdict == RowVerdict::within ? "✓ " : verdict == RowVerdict::above ? "▲ " : "";
  return text(fmt::format("{}{}", sign, word_for(verdict)));
}

Markup summary_table(const std::vector<TableRow>& rows, const std::vector<std::string>& ids) {
  TableMarkup table({{"measurement"},
                     {""},
                     {"before", true},
                     {"after", true},
                     {"ratio", true},
                     {"limit", true},
                     {"unit"},
                     {"E after", true},
                     {"R after", true},
                     {"verdict"}},
                    "summary");
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
      "approaches and all runs, after "
      "the slope named with each component is removed. Ratio: before over after. E, R: systematic deviation and "
      "repeatability by ISO 230-2 of what is left; where R is most of the band, no map can take more away." +
          std::string(content.planned ? " Limit: the largest band that the plan allows or cites as published." : ""),
      "class=\"small\"");
  body += element("h3", "What to do next");
  body += judgement.next.empty() ? paragraph_of("Nothing is open in what this report was given.")
                                 : list_of(without_commands(judgement.next));
  return {"summary", "Summary", std::move(body)};
}

}  // namespace ecs::app
