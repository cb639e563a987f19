// HTML that cannot be broken by what is put into it: text becomes markup by text() alone, elements nest by element().
// Does not live here: pages and pictures (page.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

/// "−12.30": this many decimals, a real minus sign, never "−0.0".
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

}  // namespace ecs::app
