// A report as one HTML page, no scripts, nothing fetched from anywhere, A4 on paper, and its sections, each with its
// heading. HTML that cannot be broken by what is put into it: text becomes markup by text() alone, elements nest by
// element(). Figures drawn as SVG inside it. Does not live here: what it tells (content.hpp), writing the file
// (modules/report/report_verb.cpp), figures in files (app/plot/gnuplot.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/names/commissioning.hpp"
#include "commissioning/plot/figure.hpp"
#include "modules/report/content.hpp"

namespace ecs::app {

/// Finished HTML. Plain text has no way into it but text().
class Markup {
 public:
  Markup() = default;
  [[nodiscard]] const std::string& html() const { return html_; }
  [[nodiscard]] bool empty() const { return html_.empty(); }
  Markup& operator+=(const Markup& more) {
    html_ += more.html_;
    return *this;
  }
  [[nodiscard]] friend Markup operator+(Markup a, const Markup& b) { return a += b; }

  /// HTML written in the source of the program; never from a file.
  [[nodiscard]] static Markup literal(std::string html);

 private:
  explicit Markup(std::string html) : html_(std::move(html)) {}
  std::string html_;
};

/// Any text, from whatever file: control characters and what is no UTF-8 become '?', the five characters of HTML
/// entities.
[[nodiscard]] Markup text(std::string_view plain);

/// <tag attributes>inside</tag>. @param attributes  written in the program, without text from files
[[nodiscard]] Markup element(std::string_view tag, const Markup& inside, std::string_view attributes = {});
[[nodiscard]] Markup element(std::string_view tag, std::string_view inside, std::string_view attributes = {});

/// Letters, digits and dashes, for an id that is not yet in `used`; joins it.
[[nodiscard]] std::string fresh_id(std::string_view name, std::vector<std::string>& used);

/// The text between quotes of a CSS `content`: everything but letters, digits and blanks as an escape.
[[nodiscard]] std::string css_string(std::string_view plain);

// --- numbers

/// "−12.30": so many decimals, a real minus sign, never "−0.0".
[[nodiscard]] std::string number_text(double value, int decimals);
/// The same with thin unbreakable blank and unit: "12.3 µm".
[[nodiscard]] std::string quantity_text(double value, int decimals, std::string_view unit);
/// At most three decimals, none that are zero: positions and settings.
[[nodiscard]] std::string plain_number(double value);
/// Decimals with which a value of this size shows at least two digits that mean something.
[[nodiscard]] int decimals_for(double value);
/// "um/m" as people write it: "µm/m"; "degC": "°C".
[[nodiscard]] std::string unit_text(std::string_view unit);
/// "1 file", "3 files"
[[nodiscard]] std::string counted(std::size_t count, std::string_view one, std::string_view many);

// --- tables

struct TableColumn {
  std::string title;
  bool number = false;  ///< right-aligned
};

/// "step|>rms [µm]": titles parted by "|", those of right-aligned columns begin with ">".
[[nodiscard]] std::vector<TableColumn> columns(std::string_view titles);

/// A table whose head is repeated on every page and whose rows are cut by none; a short one stays in one piece.
class TableMarkup {
 public:
  /// @param style  class names written in the program
  explicit TableMarkup(std::vector<TableColumn> columns, std::string_view style = {});
  /// @pre as many cells as columns
  void row(const std::vector<Markup>& cells, std::string_view style = {});
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::size_t rows() const { return count_; }
  [[nodiscard]] Markup markup() const;

 private:
  std::vector<TableColumn> columns_;
  std::string style_;
  std::size_t count_ = 0;
  Markup rows_;
};

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
[[nodiscard]] Markup figure_of_row(const TableRow& row);

[[nodiscard]] std::string report_page(const ReportContent& content, const Judgement& judgement);

}  // namespace ecs::app
