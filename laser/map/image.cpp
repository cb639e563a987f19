#include "laser/map/image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/address_map.hpp"
#include "laser/map/rotary_map.hpp"

namespace ecs::laser {
namespace {

struct TableGrid {
  double start_mm = 0.0;
  double increment_mm = 1.0;
  std::vector<double> values;
  double largest_change = 0.0;  ///< between the points given and the grid's own line, um
};

/// What the positions of a map file are rounded to.
constexpr double kWritten_mm = 1e-4;

/// Evenly spaced to a millionth of the spacing, or as evenly as rounded positions can be.
bool evenly_spaced(const std::vector<double>& p) {
  if (p.size() < 3) return true;
  const double step = (p.back() - p.front()) / static_cast<double>(p.size() - 1);
  const double allowed_mm = std::max(1e-6 * step, std::min(kWritten_mm, 1e-3 * step));
  for (std::size_t i = 0; i < p.size(); ++i)
    if (std::abs(p[i] - (p.front() + step * static_cast<double>(i))) > allowed_mm) return false;
  return true;
}

double smallest_spacing(const std::vector<double>& p) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < p.size(); ++i) smallest = std::min(smallest, p[i] - p[i - 1]);
  return smallest;
}

/// The table on a uniform grid; the largest difference at the given points is kept.
TableGrid grid_of(const MapTable& table) {
  const auto& p = table.position_mm;
  TableGrid grid;
  grid.start_mm = p.front();
  if (p.size() == 1 || evenly_spaced(p)) {
    if (p.size() > 1) grid.increment_mm = (p.back() - p.front()) / static_cast<double>(p.size() - 1);
    grid.values = table.compensation;
    return grid;
  }
  const double cells = std::ceil((p.back() - p.front()) / smallest_spacing(p) - 1e-9);
  if (cells > static_cast<double>(kMostValues)) return grid;  // no values: the caller refuses
  grid.increment_mm = (p.back() - p.front()) / cells;
  MapTable resampled{table.component, table.approach, {}, {}};
  for (std::size_t k = 0; k <= static_cast<std::size_t>(cells); ++k) {
    resampled.position_mm.push_back(grid.start_mm + grid.increment_mm * static_cast<double>(k));
    resampled.compensation.push_back(compensation_at(table, resampled.position_mm.back()));
  }
  for (std::size_t i = 0; i < p.size(); ++i)
    grid.largest_change =
        std::max(grid.largest_change, std::abs(compensation_at(resampled, p[i]) - table.compensation[i]));
  grid.values = std::move(resampled.compensation);
  return grid;
}

std::string table_name(const MapTable& table) {
  if (table.approach == Approach::unknown) return std::string(name_of(table.component));
  return fmt::format("{} {}", name_of(table.component), table.approach == Approach::forward ? "forward" : "reverse");
}

/// Entries of components that are declared zero (curves only: squareness lives in the parameters).
std::vector<TableEntry> zero_entries(const MapHeader& header) {
  std::vector<TableEntry> entries;
  for (const DeclaredZero& zero : header.declared_zero) {
    if (is_squareness(zero.component)) continue;
    TableEntry entry;
    entry.component = zero.component;
    entry.declared_zero = true;
    entries.push_back(entry);
  }
  return entries;
}

std::vector<std::uint8_t> assemble(const UnitParameters& parameters, const std::vector<TableEntry>& entries,
                                   const std::vector<std::int16_t>& counts, const MapHeader& of_map) {
  MapHeader words = of_map;
  words.thermal.clear();
  words.rotary.clear();  // and with them their bending
  const std::string header = header_text(words);
  const PackedRotary rotary(of_map);
  const ImagePlan plan{static_cast<std::uint32_t>(entries.size()),
                       static_cast<std::uint32_t>(counts.size()),
                       static_cast<std::uint32_t>(header.size()),
                       format_for(!of_map.thermal.empty(), !of_map.rotary.empty(),
                                  !of_map.rotary.empty() && of_map.bending != RotaryBending{}),
                       static_cast<std::uint32_t>(of_map.thermal.size()),
                       {rotary.setup().tables[0].count, rotary.setup().tables[1].count}};
  std::vector<std::uint8_t> bytes(image_bytes(plan));
  begin_image(bytes, plan);
  write_parameters(bytes, parameters);
  write_identity(bytes, {of_map.serial_number, of_map.machine, configuration_hash(parameters)});
  for (std::uint32_t i = 0; i < plan.table_count; ++i) write_entry(bytes, i, entries[i]);
  if (!of_map.thermal.empty()) write_thermal(bytes, of_map.thermal_settings, of_map.thermal);
  if (!of_map.rotary.empty()) write_rotary(bytes, rotary.setup());
  for (std::uint32_t i = 0; i < plan.value_count; ++i) write_value(bytes, i, counts[i]);
  write_header(bytes, header);
  seal_image(bytes);
  return bytes;
}

Result<void> within_capacity(std::size_t values, std::size_t bytes, const UnitParameters& parameters) {
  const std::size_t capacity = parameters.memory_modules * kValuesPerModule;
  if (values > capacity)
    return problem(ProblemKind::refused, fmt::format("the map has {} values, {} axis memory module(s) store {}: raise "
                                                     "the number of modules, or build the map with a larger increment",
                                                     values, parameters.memory_modules, capacity));
  if (bytes > bank_bytes(parameters.memory_modules))
    return problem(ProblemKind::refused,
                   fmt::format("the map needs {} bytes, {} axis memory module(s) have {}: shorten "
                               "the header (fewer source files or shorter notes) or the tables",
                               bytes, parameters.memory_modules, bank_bytes(parameters.memory_modules)));
  return {};
}

/// As long as it says, if check_image() finds no fault.
Result<std::vector<std::uint8_t>> sound_bytes(std::vector<std::uint8_t> image) {
  const ImageVerdict verdict = check_image(image);
  if (verdict.fault != ImageFault::none)
    return problem(ProblemKind::refused, fmt::format("the memory image {}", text_of(verdict.fault)));
  image.resize(verdict.total_bytes);
  return image;
}

/// An image of format 1 with room for an identity.
std::vector<std::uint8_t> in_todays_format(const std::vector<std::uint8_t>& old) {
  const ImageView view(old);
  const ImagePlan plan{view.table_count(), view.value_count(), static_cast<std::uint32_t>(view.header().size())};
  std::vector<std::uint8_t> image(image_bytes(plan));
  begin_image(image, plan);
  std::copy_n(old.begin() + kPrefixBytes, kParameterBytes, image.begin() + kPrefixBytes);
  const auto rest = static_cast<std::ptrdiff_t>(directory_offset(view.format()));
  std::copy(old.begin() + rest, old.end(), image.begin() + directory_offset());
  return image;
}

}  // namespace

double resolution_for(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  for (const double resolution : {0.01, 0.1})
    if (largest <= resolution * 32'767.0) return resolution;
  return 1.0;
}

/// 35 counts of 0.01 are 0.35, not 0.35000000000000003.
double value_of_counts(std::int16_t counts, double resolution) {
  const double per_unit = std::round(1.0 / resolution);
  return std::abs(per_unit * resolution - 1.0) < 1e-12 ? counts / per_unit : counts * resolution;
}

std::string change_by_resampling(const ErrorMap& map) {
  std::size_t count = 0;
  double largest = 0.0;
  const MapTable* most = nullptr;
  for (const MapTable& table : map.tables) {
    const TableGrid grid = grid_of(table);
    if (grid.values.empty() || grid.largest_change <= resolution_for(grid.values)) continue;
    ++count;
    if (most != nullptr && grid.largest_change <= largest) continue;
    most = &table;
    largest = grid.largest_change;
  }
  if (most == nullptr) return "";
  return fmt::format("{}, and resampling changes {} by up to {:.2f} {} ({})",
                     count == 1 ? "a table is unevenly spaced" : fmt::format("{} tables are unevenly spaced", count),
                     count == 1 ? "it" : "them", largest, unit_of(most->component), table_name(*most));
}

Result<MapImage> image_of(const ErrorMap& map, const UnitParameters& parameters) {
  std::vector<Problem> objections;
  for (const MapFinding& finding : findings_for(map, parameters))
    if (finding.objection) objections.push_back({ProblemKind::refused, finding.message, {}, 0, 0, {}});
  if (!objections.empty()) return tl::unexpected(folded(std::move(objections)));

  MapImage image;
  std::vector<TableEntry> entries = zero_entries(map.header);
  std::vector<std::int16_t> counts;
  for (const MapTable& table : map.tables) {
    const TableGrid grid = grid_of(table);
    if (grid.values.empty())
      return problem(ProblemKind::refused,
                     fmt::format("{}: its points lie too close together for the axis memory", table_name(table)));
    if (grid.largest_change > 0.0 || grid.values.size() != table.position_mm.size())
      image.notes.push_back(fmt::format("{}: unevenly spaced, resampled every {:.4g} mm, largest change {:.2f} {}",
                                        table_name(table), grid.increment_mm, grid.largest_change,
                                        unit_of(table.component)));
    const double resolution = resolution_for(grid.values);
    if (grid.largest_change > resolution) image.changed.push_back(image.notes.back());
    entries.push_back({table.component, table.approach, false, static_cast<std::uint32_t>(counts.size()),
                       static_cast<std::uint32_t>(grid.values.size()), grid.start_mm, grid.increment_mm, resolution});
    for (const double value : grid.values) counts.push_back(static_cast<std::int16_t>(std::lround(value / resolution)));
  }
  image.bytes = assemble(parameters, entries, counts, map.header);
  ECS_DO(within_capacity(counts.size(), image.bytes.size(), parameters));
  return image;
}

std::vector<std::uint8_t> image_of(const UnitParameters& parameters) { return assemble(parameters, {}, {}, {}); }

Result<ImageContent> content_of(std::span<const std::uint8_t> image) {
  const ImageVerdict verdict = check_image(image);
  if (verdict.fault == ImageFault::block_check)
    return problem(ProblemKind::refused,
                   fmt::format("the memory image is corrupt: checksum (CRC-32) {:08X} stored, {:08X} "
                               "computed",
                               verdict.check_expected, verdict.check_found));
  if (verdict.fault != ImageFault::none)
    return problem(ProblemKind::refused, fmt::format("the memory image {}", text_of(verdict.fault)));
  const ImageView view(image);
  ImageContent content;
  content.parameters = *view.parameters();
  ECS_TRY(header, parse_header(view.header(), "map header"));
  content.map.header = std::move(header);
  for (std::uint32_t k = 0; k < view.thermal_count(); ++k) content.map.header.thermal.push_back(view.thermal_row(k));
  if (view.thermal_count() > 0) content.map.header.thermal_settings = view.thermal_settings();
  if (const auto rotary = view.rotary()) take_rotary(content.map.header, *rotary);
  for (std::uint32_t i = 0; i < view.table_count(); ++i) {
    const TableEntry entry = view.entry(i);
    if (entry.declared_zero) continue;
    MapTable table{entry.component, entry.approach, {}, {}};
    for (std::uint32_t k = 0; k < entry.count; ++k) {
      table.position_mm.push_back(entry.start_mm + entry.increment_mm * k);
      table.compensation.push_back(value_of_counts(view.value_counts(entry.first_value + k), entry.resolution));
    }
    content.map.tables.push_back(std::move(table));
  }
  return content;
}

StatedIdentity stated_identity(std::span<const std::uint8_t> image) {
  const ImageView view(image);
  if (const auto stated = view.identity()) return {std::string(stated->serial_number), std::string(stated->machine)};
  const auto header = parse_header(view.header(), "map header");
  return header ? StatedIdentity{header->serial_number, header->machine} : StatedIdentity{};
}

Result<std::vector<std::uint8_t>> with_identity(std::vector<std::uint8_t> image, const ImageIdentity& identity) {
  auto sound = sound_bytes(std::move(image));
  if (!sound) return sound;
  if (ImageView(*sound).format() == kFormatWithoutIdentity) *sound = in_todays_format(*sound);
  write_identity(*sound, identity);
  seal_image(*sound);
  return sound;
}

Result<std::vector<std::uint8_t>> with_parameters(std::vector<std::uint8_t> image, const UnitParameters& parameters) {
  auto sound = sound_bytes(std::move(image));
  if (!sound) return sound;
  write_parameters(*sound, parameters);
  seal_image(*sound);
  return sound;
}

}  // namespace ecs::laser
