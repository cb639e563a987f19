#include <algorithm>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/csv_table.hpp"
#include "modules/fleet/run.hpp"

namespace ecs::commissioning {
namespace {

/// What is wrong with the names of the columns; "" for nothing.
std::string header_fault(const std::vector<laser::CsvField>& header, const ManifestColumns& columns) {
  const auto has = [&](const std::string& name) {
    return std::any_of(header.begin(), header.end(), [&](const auto& field) { return field.text == name; });
  };
  std::vector<std::string> missing, absent;
  for (const std::string& name : columns.needed)
    if (!has(name)) missing.push_back(name), absent.push_back(name);
  for (const std::string& name : columns.optional)
    if (!has(name)) absent.push_back(name);
  for (std::size_t i = 0; i < header.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (header[i].text == header[j].text && !header[i].text.empty())
        return fmt::format("expected each column once, found {} twice", header[i].text);
    const std::string meant = nearest_word(header[i].text, absent);
    const auto known = [&](const auto& names) {
      return std::find(names.begin(), names.end(), header[i].text) != names.end();
    };
    if (!meant.empty() && !known(columns.needed) && !known(columns.optional))
      return fmt::format("unknown column {}: did you mean {}?", header[i].text, meant);
  }
  if (missing.empty()) return {};
  return fmt::format("the first line lacks the column{} {}; a list of machines has the columns {}",
                     missing.size() == 1 ? "" : "s", fmt::join(missing, ", "), fmt::join(columns.needed, ", "));
}

}  // namespace

Result<Manifest> Manifest::parse(std::string text, const std::string& name, std::filesystem::path folder,
                                 const ManifestColumns& columns) {
  Manifest manifest;
  manifest.text_ = std::move(text);
  manifest.name_ = name;
  manifest.folder_ = std::move(folder);
  manifest.columns_ = columns.needed;
  manifest.columns_.insert(manifest.columns_.end(), columns.optional.begin(), columns.optional.end());
  manifest.needed_ = columns.needed.size();
  std::string_view all = manifest.text_;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (all.starts_with(kByteOrderMark)) all.remove_prefix(kByteOrderMark.size());
  int number = 0;
  for (const std::string_view line : lines_of(all)) {
    ++number;
    if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
    if (manifest.fields_ > 0) {
      manifest.rows_.push_back({static_cast<std::size_t>(line.data() - manifest.text_.data()),
                                static_cast<std::uint32_t>(line.size()), number});
      continue;
    }
    const laser::CsvLine header = laser::csv_fields(line);
    std::string fault = header.fault.empty() ? header_fault(header.fields, columns) : header.fault;
    if (!fault.empty()) return problem_at(name, number, std::max(1, header.fault_column), std::move(fault));
    manifest.fields_ = header.fields.size();
    for (const std::string& column : manifest.columns_) {
      const auto found = std::find_if(header.fields.begin(), header.fields.end(),
                                      [&](const laser::CsvField& field) { return field.text == column; });
      manifest.field_of_.push_back(
          found == header.fields.end() ? std::nullopt : std::optional<std::size_t>(found - header.fields.begin()));
    }
  }
  if (manifest.rows_.empty())
    return problem_at(name, std::max(1, number), 1, "expected the columns {} and a row for each, found no row",
                      fmt::join(columns.needed, ", "));
  std::unordered_map<std::string, int> line_of;
  for (std::size_t i = 0; i < manifest.rows_.size(); ++i)
    if (const auto row = manifest.row(i))
      if (const auto [first, is_new] = line_of.try_emplace(row->id(), row->line); !is_new)
        manifest.doubled_.emplace(i, first->second);
  return manifest;
}

Result<Manifest> Manifest::read(const std::filesystem::path& path, const ManifestColumns& columns) {
  ECS_TRY(text, read_file(path));
  return parse(std::move(text), path.string(), path.parent_path(), columns);
}

Result<ManifestRow> Manifest::row(std::size_t i) const {
  const Place& place = rows_[i];
  laser::CsvLine line = laser::csv_fields(std::string_view(text_).substr(place.begin, place.length));
  if (!line.fault.empty()) return problem_at(name_, place.line, line.fault_column, line.fault);
  if (line.fields.size() != fields_)
    return problem_at(name_, place.line, 1, "expected {} cells as in the first line, found {}", fields_,
                      line.fields.size());
  ManifestRow row{place.line, {}};
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto field = field_of_[c];
    row.cells.push_back(field ? std::move(line.fields[*field].text) : std::string());
    if (c < needed_ && row.cells.back().empty())
      return problem_at(name_, place.line, line.fields[*field].column, "{}: expected a value, found an empty cell",
                        columns_[c]);
  }
  if (row.id().size() > kLongestId)
    return problem_at(name_, place.line, 1, "{}: expected at most {} characters, found {}", columns_.front(),
                      kLongestId, row.id().size());
  return row;
}

std::optional<int> Manifest::doubles_line(std::size_t i) const {
  const auto found = doubled_.find(i);
  return found == doubled_.end() ? std::nullopt : std::optional(found->second);
}

std::string Manifest::from_folder(const std::string& path) const {
  return path.empty() ? path : (folder_ / path).lexically_normal().string();
}

}  // namespace ecs::commissioning
