#include "laser/import/rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::pair<std::string_view, CellKind>, 5> kCellKinds{{{"any", CellKind::any},
                                                                           {"word", CellKind::word},
                                                                           {"number", CellKind::number},
                                                                           {"date", CellKind::date},
                                                                           {"time", CellKind::time}}};

bool is_kind(CellKind kind, std::string_view cell) {
  switch (kind) {
    case CellKind::any:
      return true;
    case CellKind::word:
      return !number_or_comma(cell);
    case CellKind::number:
      return number_or_comma(cell).has_value();
    case CellKind::date:
      return cell.find('-') != std::string_view::npos && seconds_in(std::string(cell) + " 00:00");
    case CellKind::time:
      return seconds_in("2000-01-01 " + std::string(cell)).has_value();
  }
  return false;
}

}  // namespace

Result<std::vector<CellKind>> cell_kinds(std::string_view text) {
  std::vector<CellKind> kinds;
  for (const std::string_view word : cells_of(text, ' ')) {
    const auto* const known =
        std::find_if(kCellKinds.begin(), kCellKinds.end(), [&](const auto& kind) { return kind.first == word; });
    if (known == kCellKinds.end())
      return problem(ProblemKind::usage,
                     "row_begins: expected any, word, number, date or time for each cell, found " + in_quotes(word));
    kinds.push_back(known->second);
  }
  return kinds;
}

bool begins_as(const std::vector<CellKind>& kinds, const std::vector<std::string_view>& cells) {
  return cells.size() >= kinds.size() && std::equal(kinds.begin(), kinds.end(), cells.begin(), is_kind);
}

std::size_t rows_begun(std::string_view text, const ColumnMapping& mapping) {
  const auto lines = lines_of(text);
  return static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), [&](std::string_view line) {
    return begins_as(mapping.row_begins, cells_of(line, mapping.delimiter));
  }));
}

std::optional<StatedTarget> target_stated(std::string_view line, const ImportOptions& options) {
  const auto& unit = options.mapping->target_lines;
  const std::string plain = lower(trimmed(line));
  if (!unit || !plain.ends_with(lower(unit->name))) return std::nullopt;
  const auto number = number_in(std::string_view(plain).substr(0, plain.size() - unit->name.size()));
  const double mm = number.value_or(0.0) * options.target_unit.value_or(*unit).factor;
  return number && std::isfinite(mm) ? std::optional(StatedTarget{*number, mm}) : std::nullopt;
}

Result<std::string> keep_channel(std::vector<TableRow>& rows, const std::string& file_name,
                                 const ImportOptions& options) {
  if (options.mapping->channel_column == 0 || rows.empty()) return std::string();
  const auto cell = static_cast<std::size_t>(options.mapping->channel_column - 1);
  const auto channel_of = [&](const TableRow& row) { return cell < row.cells.size() ? row.cells[cell] : ""; };
  std::map<std::string_view, std::size_t> channels;
  for (const TableRow& row : rows) ++channels[channel_of(row)];
  const bool only = options.channel.empty() && channels.size() == 1;
  const std::string channel = only ? std::string(channels.begin()->first) : options.channel;
  if (!only && !channels.contains(channel)) {
    std::vector<std::string> names;
    for (const auto& [name, count] : channels) names.push_back(fmt::format("{} ({} values)", name, count));
    return tl::unexpected(
        usage(file_name, fmt::format("{}: give one of {}",
                                     channel.empty() ? "the log holds several channels"
                                                     : "no channel " + in_quotes(channel) + " in the log",
                                     fmt::join(names, ", "))));
  }
  std::erase_if(rows, [&](const TableRow& row) { return channel_of(row) != channel; });
  return channel;
}

}  // namespace ecs::laser
