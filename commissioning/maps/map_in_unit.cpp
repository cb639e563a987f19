#include "commissioning/maps/map_in_unit.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "core/memory_image.hpp"
#include "laser/map/csv.hpp"

namespace ecs::commissioning {

Result<FoundMap> map_in(protocol::UnitClient& client, const protocol::ProgressCallback& progress) {
  ECS_TRY(image, read_active_image(client, progress));
  if (!image) return problem(ProblemKind::refused, "the unit contains no map: send one with `ecs map send`");
  auto content = laser::content_of(*image);
  if (!content) {
    Problem why = content.error();
    why.kind = ProblemKind::refused;
    why.message = "the map in the unit is not valid: " + why.message;
    return tl::unexpected(std::move(why));
  }
  return FoundMap{std::move(content->map), content->parameters, "the unit"};
}

Result<PreparedMap> prepared_map(const std::string& map_file, const std::string& params_file,
                                 const PrepareOptions& options) {
  ECS_TRY(map, laser::read_map_csv(map_file));
  ECS_TRY(parameters, params::read_parameters(params_file));
  return prepared_map(map, map_file, parameters, params_file, options);
}

Result<PreparedMap> prepared_map(const laser::ErrorMap& map, const std::string& map_name,
                                 const params::ParametersFile& parameters, const std::string& params_name,
                                 const PrepareOptions& options) {
  if (auto wrong = objections_to(parameters, params_name, options.incomplete)) return tl::unexpected(std::move(*wrong));
  std::vector<std::string> objections;
  if (!options.other_machine) objections = other_machine(map.header, parameters.identity);  // it explains the rest
  for (std::string& why : objections_to_map(map, parameters.parameters)) objections.push_back(std::move(why));
  if (auto refused = refused_map(objections, map_name)) return tl::unexpected(std::move(*refused));
  ECS_TRY(image, laser::image_of(map, parameters.parameters));
  if (!image.changed.empty() && !options.accept_resampling) {
    std::vector<std::string> why{laser::change_by_resampling(map) + ": " + kEvenly};
    why.insert(why.end(), image.changed.begin(), image.changed.end());
    return tl::unexpected(std::move(*refused_map(why, map_name)));
  }
  std::vector<std::string> remarks =
      remarks_in(laser::findings_for(map, parameters.parameters, travels_beside(params_name, parameters)));
  for (std::string& taken : params::defaults_in_short(parameters)) remarks.push_back(std::move(taken));
  return PreparedMap{map.header, parameters.identity, std::move(image), std::move(remarks)};
}

Result<std::vector<std::uint8_t>> image_for_file(const PreparedMap& map) {
  const ImageView view(map.image.bytes);
  const auto parameters = view.parameters();
  const auto first_of = [](const std::string& a, const std::string& b) { return a.empty() ? b : a; };
  const std::string serial_number = first_of(map.header.serial_number, map.identity.serial_number);
  const std::string machine = first_of(map.header.machine, map.identity.machine);
  return laser::with_identity(map.image.bytes,
                              {serial_number, machine, parameters ? configuration_hash(*parameters) : 0});
}

Result<std::vector<std::uint8_t>> image_to_write(MessageSink& messages, const std::string& file,
                                                 const laser::ErrorMap& map, const params::ParametersFile& parameters,
                                                 const std::string& params_name) {
  if (file.empty()) return std::vector<std::uint8_t>();
  ECS_TRY(prepared, prepared_map(map, {}, parameters, params_name));
  for (const std::string& note : prepared.image.notes) messages.note(note);
  return image_for_file(prepared);
}

Result<void> write_image(const std::string& file, std::span<const std::uint8_t> image) {
  if (file.empty()) return {};
  return write_file(file, std::string(image.begin(), image.end()));
}

Cell image_cell(const std::string& file, std::span<const std::uint8_t> image) {
  if (file.empty()) return null_cell();
  const laser::StatedIdentity stated = laser::stated_identity(image);
  return record_cell("memory image written to {file}: {bytes} bytes, checksum (CRC-32) {check}, {whose}\n",
                     "file"_is(file), "bytes"_is(image.size()),
                     "check"_is(fmt::format("{:08X}", ImageView(image).check())),
                     "serial_number"_is(text_cell(stated.serial_number)),
                     "whose"_shown(stated.serial_number.empty()
                                       ? "for no unit in particular: neither map nor parameters state a serial number"
                                       : fmt::format("for unit {}", stated.serial_number)));
}

std::vector<std::string> other_unit(const PreparedMap& map, const std::string& serial_number) {
  std::vector<std::string> objections = other_unit(map.header, serial_number);
  for (std::string& differs : other_unit(map.identity, serial_number)) objections.push_back(std::move(differs));
  return objections;
}

namespace {

constexpr double kSame = 1e-6;

const laser::MapTable* same_table(const laser::ErrorMap& map, const laser::MapTable& table) {
  const auto found = std::find_if(map.tables.begin(), map.tables.end(), [&](const laser::MapTable& t) {
    return t.component == table.component && t.approach == table.approach;
  });
  return found == map.tables.end() ? nullptr : &*found;
}

std::string name_of_table(const laser::MapTable& table) {
  return fmt::format("{} {}{}", name_of(table.component), word_for(table.approach),
                     table.approach == Approach::unknown ? " approaches" : "");
}

MapDifference of_table(const laser::MapTable& table, const std::string& what) {
  return {table.component, table.approach, {}, {}, {}, fmt::format("{}: {}", name_of_table(table), what)};
}

/// A curve of a rotary axis is one line.
std::string shortened(std::string_view line) {
  constexpr std::size_t kMost = 100;
  return line.size() <= kMost ? std::string(line) : fmt::format("{} …", line.substr(0, kMost));
}

void compare_headers(const laser::MapHeader& expected, const laser::MapHeader& found, std::vector<MapDifference>& out) {
  const std::string a = laser::header_text(expected), b = laser::header_text(found);
  const auto lines_a = lines_of(a), lines_b = lines_of(b);
  const auto take = [&](const auto& lines, const auto& other, const char* where) {
    for (const std::string_view line : lines)
      if (std::find(other.begin(), other.end(), line) == other.end())
        out.push_back({{}, {}, {}, {}, {}, fmt::format("header: only {} has \"{}\"", where, shortened(line))});
  };
  take(lines_a, lines_b, "the file");
  take(lines_b, lines_a, "the unit");
}

void compare_values(const laser::MapTable& expected, const laser::MapTable& found, std::vector<MapDifference>& out) {
  if (expected.position_mm.size() != found.position_mm.size()) {
    out.push_back(of_table(expected, fmt::format("the file has {} points, the unit {}", expected.position_mm.size(),
                                                 found.position_mm.size())));
    return;
  }
  for (std::size_t i = 0; i < expected.position_mm.size(); ++i) {
    const double p = expected.position_mm[i], want = expected.compensation[i], got = found.compensation[i];
    if (std::abs(p - found.position_mm[i]) > kSame)
      out.push_back({expected.component,
                     expected.approach,
                     p,
                     {},
                     {},
                     fmt::format("{}: the file has a point at {:.6g} mm, the unit at {:.6g} mm",
                                 name_of_table(expected), p, found.position_mm[i])});
    else if (std::abs(want - got) > kSame)
      out.push_back({expected.component, expected.approach, p, want, got,
                     fmt::format("{} at {:.6g} mm: file {:.2f} {}, unit {:.2f}", name_of_table(expected), p, want,
                                 unit_of(expected.component), got)});
  }
}

/// At the points of either. @pre both have points
LargestDifference largest_between(const laser::MapTable& file, const laser::MapTable& unit) {
  LargestDifference largest;
  bool any = false;
  for (const auto* points : {&file.position_mm, &unit.position_mm})
    for (const double p : *points) {
      const LargestDifference here{file.component, file.approach, p, laser::compensation_at(file, p),
                                   laser::compensation_at(unit, p)};
      if (!any || here.difference() > largest.difference()) largest = here;
      any = true;
    }
  return largest;
}

}  // namespace

std::vector<MapDifference> differences_between(const laser::ErrorMap& expected, const laser::ErrorMap& found) {
  std::vector<MapDifference> out;
  compare_headers(expected.header, found.header, out);
  for (const laser::MapTable& table : found.tables)
    if (same_table(expected, table) == nullptr) out.push_back(of_table(table, "only in the unit"));
  for (const laser::MapTable& table : expected.tables) {
    const laser::MapTable* other = same_table(found, table);
    if (other == nullptr)
      out.push_back(of_table(table, "only in the file"));
    else
      compare_values(table, *other, out);
  }
  return out;
}

std::optional<LargestDifference> largest_difference(const laser::ErrorMap& file, const laser::ErrorMap& unit) {
  std::optional<LargestDifference> largest;
  for (const laser::MapTable& table : file.tables)
    if (const laser::MapTable* other = same_table(unit, table); other != nullptr)
      if (const auto one = largest_between(table, *other); !largest || one.difference() > largest->difference())
        largest = one;
  return largest;
}

std::vector<MapDifference> beyond_resolution(const laser::ErrorMap& file, const laser::ErrorMap& unit) {
  std::vector<MapDifference> out;
  for (const laser::MapTable& table : file.tables) {
    const laser::MapTable* other = same_table(unit, table);
    if (other == nullptr || other->position_mm == table.position_mm) continue;
    const LargestDifference at = largest_between(table, *other);
    if (at.difference() <= laser::resolution_for(other->compensation)) continue;
    out.push_back({at.component, at.approach, at.position_mm, at.expected, at.found,
                   fmt::format("{} at {:.6g} mm: curve of the file {:.2f} {}, unit {:.2f}", name_of_table(table),
                               at.position_mm, at.expected, unit_of(at.component), at.found)});
  }
  return out;
}

namespace {

/// Map and parameters of the file as a unit would hold them: rounded and resampled as the image does it.
Result<laser::ImageContent> expected_content(const laser::ErrorMap& map, const std::string& params_file,
                                             const UnitParameters& of_unit) {
  UnitParameters parameters = of_unit;
  if (!params_file.empty()) {
    ECS_TRY(file, params::read_parameters(params_file));
    parameters = file.parameters;
  }
  ECS_TRY(image, laser::image_of(map, parameters));
  return laser::content_of(image.bytes);
}

}  // namespace

Result<std::optional<std::uint32_t>> active_check(protocol::UnitClient& client) {
  ECS_TRY(map, client.active_map());
  if (map.active_bank == protocol::Bank::none) return std::optional<std::uint32_t>();
  return std::optional(map.block_check_expected);
}

Result<SentMap> send_map(protocol::UnitClient& client, const PreparedMap& map, const std::string& file,
                         bool other_machine, const BeforeSending& before, const protocol::ProgressCallback& progress) {
  ECS_TRY(identity, client.identity());
  if (!other_machine)
    if (auto refused = refused_map(other_unit(map, identity.serial_number), file))
      return tl::unexpected(std::move(*refused));
  ECS_TRY(check_before, active_check(client));
  if (before) before(check_before);
  const auto start = std::chrono::steady_clock::now();
  ECS_TRY(report, send_image_to(client, identity, map.image.bytes,
                                other_machine ? Addressee::this_unit : Addressee::as_stated, progress));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return SentMap{report, identity, report.check, check_before, seconds};
}

Result<MapVerdict> verdict_on(const FoundMap& found, const std::string& map_file, const std::string& params_file) {
  ECS_TRY(map, laser::read_map_csv(map_file));
  ECS_TRY(expected, expected_content(map, params_file, found.parameters.value_or(UnitParameters{})));
  MapVerdict verdict;
  verdict.differences = differences_between(expected.map, found.map);
  verdict.largest = largest_difference(map, found.map);
  for (MapDifference& resampled : beyond_resolution(map, found.map))
    verdict.differences.push_back(std::move(resampled));
  if (found.parameters) verdict.parameters = params::diff(expected.parameters, *found.parameters);
  return verdict;
}

}  // namespace ecs::commissioning
