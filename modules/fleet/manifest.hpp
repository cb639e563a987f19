// A manifest: a table (CSV) with one machine or unit a line, each with an id of its own.
// Does not live here: what is done with a line (batch.hpp, run.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs::commissioning {

/// The columns that a manifest may have, in the order in which rows give their cells.
struct ManifestColumns {
  std::vector<std::string> needed;    ///< the first of them is the id
  std::vector<std::string> optional;  ///< their cells are empty where the column is absent
};

struct ManifestRow {
  int line = 0;
  std::vector<std::string> cells;  ///< of the needed columns, then of the optional ones
  [[nodiscard]] const std::string& id() const { return cells.front(); }
};

/// Keeps the text of the file and where its rows begin: a row is cut into cells when it is asked for, so that a hundred
/// thousand rows take little more memory than the file. Safe to read from several threads.
class Manifest {
 public:
  /// Refuses a table without rows or without a needed column. Other columns are left alone, unless the name looks like
  /// that of a missing one. Lines that begin with '#' and empty lines count only for line numbers.
  [[nodiscard]] static Result<Manifest> parse(std::string text, const std::string& name, std::filesystem::path folder,
                                              const ManifestColumns& columns);
  [[nodiscard]] static Result<Manifest> read(const std::filesystem::path& path, const ManifestColumns& columns);

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// A problem with its line where the row has another number of cells than the header, an open quote, no id or one of
  /// more than kLongestId bytes, or an empty needed cell.
  [[nodiscard]] Result<ManifestRow> row(std::size_t i) const;
  /// The line of the first row with the same id; nothing for that row itself.
  [[nodiscard]] std::optional<int> doubles_line(std::size_t i) const;

  /// A path of a cell, from the folder of the manifest; "" stays "".
  [[nodiscard]] std::string from_folder(const std::string& path) const;
  [[nodiscard]] const std::string& name() const { return name_; }

  static constexpr std::size_t kLongestId = 200;  ///< a choice; it stands in every line of the results

 private:
  struct Place {
    std::size_t begin = 0;
    std::uint32_t length = 0;
    int line = 0;
  };
  std::string text_, name_;
  std::filesystem::path folder_;
  std::vector<std::string> columns_;                  ///< names, in the order of the cells of a row
  std::vector<std::optional<std::size_t>> field_of_;  ///< of each of them
  std::size_t needed_ = 0, fields_ = 0;
  std::vector<Place> rows_;
  std::map<std::size_t, int> doubled_;  ///< row to line of the first
};

}  // namespace ecs::commissioning
