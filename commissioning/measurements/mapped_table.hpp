// A table of a file that no format describes, and the meaning of its columns: guessed, as a file with the same headings
// was read, or chosen by the user; what would be read with it. Pure state, without a terminal. Does not live here: the
// guess (laser/import/suggestion.cpp), the whole file (files.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/measurements/files.hpp"
#include "laser/import/columns.hpp"

namespace ecs::commissioning {

/// What would be read from the beginning of the file.
struct MappingPreview {
  std::string wrong;               ///< why it cannot be accepted; empty: it can
  std::vector<std::string> lines;  ///< lines of readings, their number, the first readings, assumptions
};

/// Of the whole table, what no column says.
enum class MappingSetting : std::uint8_t { columns, axis, sense, values, approach, runs, rows, parked };
inline constexpr std::size_t kMappingSettings = 8;

struct SettingWords {
  std::string name;
  std::string value;
  std::string help;
};

class MappedTable {
 public:
  /// Where the mapping comes from.
  enum class Source { given, remembered, guessed, none };

  /// The beginning of a file as a table. Nothing where a format or a profile reads the file, or it holds no table.
  [[nodiscard]] static std::optional<MappedTable> of_file(const std::string& path, const ImportArguments& given);

  [[nodiscard]] std::size_t columns() const { return found_.shape.columns; }
  [[nodiscard]] bool has_headings() const { return !found_.shape.headings.empty(); }
  /// May be empty.
  [[nodiscard]] std::string heading(std::size_t column) const;
  /// As many cells as columns.
  [[nodiscard]] const std::vector<std::vector<std::string>>& first_rows() const { return first_rows_; }
  /// "X position"; "-": not read.
  [[nodiscard]] std::string role(std::size_t column) const;
  [[nodiscard]] std::string role_help(std::size_t column) const;
  /// With a factor and an offset; empty: the column has none.
  [[nodiscard]] std::string unit(std::size_t column) const;
  /// Where the mapping comes from, in words.
  [[nodiscard]] std::string origin() const;

  void next_role(std::size_t column, int by);
  /// The next role whose name begins with this letter.
  void next_role_with(std::size_t column, char letter);
  void clear_role(std::size_t column);
  void next_unit(std::size_t column, int by);
  /// The unit is used although the heading states another, or no longer.
  void toggle_forced_unit(std::size_t column);

  /// In the order of MappingSetting.
  [[nodiscard]] std::array<SettingWords, kMappingSettings> settings() const;
  /// Of all but `parked`, which is typed.
  void next_value(MappingSetting setting, int by);
  void set_parked(const std::string& text);

  /// The options of `laser import`.
  [[nodiscard]] ImportArguments answers() const;
  [[nodiscard]] const MappingPreview& preview() const { return preview_; }
  /// By the mapping of this table, which has the same headings.
  [[nodiscard]] bool is_remembered_as(const MappedTable& other) const {
    return source_ == Source::remembered && found_.shape.headings == other.found_.shape.headings;
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  MappedTable() = default;
  void begin_with(Source source);
  void take(const ImportArguments& options);
  void set_field(std::size_t column, const std::string& field);
  void assign(std::size_t column, int place);
  void change_axis(int by);
  void fit_units();
  void look_again();
  /// As many as there are rules: none.
  [[nodiscard]] std::size_t place_of_rule(std::size_t column) const;
  [[nodiscard]] const laser::ColumnRule* rule_of(std::size_t column) const;
  [[nodiscard]] laser::ColumnRule* rule_of(std::size_t column);
  [[nodiscard]] std::optional<std::size_t> only_position() const;
  [[nodiscard]] std::string word_of(const std::string& field) const;
  void set_word(const std::string& field, const std::string& word);
  [[nodiscard]] std::string axis_letter() const;
  [[nodiscard]] std::string doubled() const;
  [[nodiscard]] std::vector<std::string> units_for(const laser::ColumnRule& rule) const;
  [[nodiscard]] std::string read_text(const laser::MeasurementSet& set) const;

  std::string path_;
  std::string head_;        ///< whole lines of the beginning of the file
  double part_read_ = 1.0;  ///< of the bytes of the file
  laser::FoundTable found_;
  std::vector<std::vector<std::string>> first_rows_;
  std::optional<RememberedMapping> remembered_;
  Source source_ = Source::none;
  ImportArguments given_;
  ImportArguments options_;               ///< without `columns`
  std::vector<laser::ColumnRule> rules_;  ///< of columns, and words such as approach=motion
  MappingPreview preview_;
};

}  // namespace ecs::commissioning
