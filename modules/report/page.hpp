// A report as one HTML page, no scripts, nothing fetched from anywhere, A4 on paper, and its sections, each with its
// heading. Figures drawn as SVG inside it. Does not live here: what it tells (content.hpp), writing the file
// (modules/report/report_verb.cpp), figures in files (app/plot/gnuplot.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/names/commissioning.hpp"
#include "commissioning/plot/figure.hpp"
#include "modules/report/content.hpp"
#include "modules/report/markup.hpp"

namespace ecs::app {

/// Panels one below the other, the same scale in all of them; the axes' labels are those of the last. A figure with
/// names in place of numbers is drawn as horizontal bars, a second series in front of the first, with a broken line at
/// its level. One panel of equal units is drawn square, lines without marks.
[[nodiscard]] Markup inline_svg(const PlotFigure& figure);

/// Round numbers inside least … most, about `wanted` of them.
[[nodiscard]] std::vector<double> round_ticks(double least, double most, int wanted);

/// A heading with an anchor, then its content.
struct ReportSection {
  std::string id;
  std::string title;
  Markup body;
  std::string absent{};  ///< why there is no body: the section is named among those that are not part of the report
};

/// @param ids  of the component of each row
[[nodiscard]] ReportSection summary_section(const ReportContent& content, const Judgement& judgement,
                                            const std::vector<std::string>& ids);
[[nodiscard]] ReportSection machine_section(const ReportContent& content);
[[nodiscard]] ReportSection conditions_section(const ReportContent& content);
[[nodiscard]] ReportSection components_section(const ReportContent& content, const std::vector<std::string>& ids);
[[nodiscard]] ReportSection prediction_section(const ReportContent& content);
[[nodiscard]] ReportSection volume_section(const ReportContent& content);
[[nodiscard]] ReportSection circles_section(const ReportContent& content);
[[nodiscard]] ReportSection effects_section(const ReportContent& content);
[[nodiscard]] ReportSection parameters_section(const ReportContent& content);
[[nodiscard]] ReportSection map_section(const ReportContent& content);
[[nodiscard]] ReportSection unit_section(const ReportContent& content);
/// Definitions, and every file with its SHA-256.
[[nodiscard]] ReportSection sources_section(const ReportContent& content);

// --- used by several of them

/// <p>plain text</p>
[[nodiscard]] Markup paragraph_of(std::string_view plain, std::string_view attributes = {});
/// A plain statement that something is absent.
[[nodiscard]] Markup absence(std::string_view plain);
/// Without the parts that name a command or an option of a program: "(--status)", ": give --machine". Who reads a
/// report has no program. Empty where nothing else was said.
[[nodiscard]] std::string without_commands(std::string_view plain);
[[nodiscard]] std::vector<std::string> without_commands(const std::vector<std::string>& items);
/// The first few of a list and how many more there are: "a, b and 3 more".
[[nodiscard]] std::string first_few(const std::vector<std::string>& names);
inline constexpr std::size_t kMostRivals = 5;  ///< that a page names
/// <ul> of texts; nothing for none.
[[nodiscard]] Markup list_of(const std::vector<std::string>& items);
/// <dl> of name and value, in columns; long values take a line.
[[nodiscard]] Markup facts_of(const std::vector<std::pair<std::string, std::string>>& facts);
/// Largest and rms of the error vector in the volume, predicted, and from what.
[[nodiscard]] std::string volume_sentence(const ReportedVolume& volume);
/// A line of a map header as people write it: "µm/m", "least squares", real minus control.
[[nodiscard]] std::string worded(std::string_view line);
/// A number in a table, a dash where there is none.
[[nodiscard]] Markup cell(const std::optional<double>& value, int decimals);

/// Before and after on one scale.
/// @param unit  of the positions
[[nodiscard]] Markup figure_of_row(const TableRow& row, const params::PositionUnit& unit);

[[nodiscard]] std::string report_page(const ReportContent& content, const Judgement& judgement);

}  // namespace ecs::app
