#include "laser/import.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/readers.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kHead = 16 * 1024;  ///< heads and headings stand at the start of a file

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

bool is_dynamic(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, kHead);
  return has(head, "HEADER::") && has(head, "Data:") && !has(head, "TARGET DATA::") && !has(head, "DEVIATIONS::");
}

std::string_view first_line(std::string_view text) {
  for (const std::string_view line : lines_of(text.substr(0, kHead)))
    if (!trimmed(line).empty() && !trimmed(line).starts_with('#')) return trimmed(line);
  return {};
}

bool is_nine_numbers(std::string_view line) {
  int count = 0;
  for (const std::string_view word : split(line, ' ')) {
    if (trimmed(word).empty()) continue;
    if (!number_in(word)) return false;
    ++count;
  }
  return count == 9;
}

bool is_csv_header(std::string_view line) {
  std::string plain = lower(line);
  std::replace_if(
      plain.begin(), plain.end(), [](char c) { return c == ';' || c == '\t' || c == '"' || c == ' '; }, ',');
  int known = 0;
  for (const std::string_view word : split(plain, ','))
    if (word == "axis" || word == "sense" || word == "reading" || word == "approach" || word == "x_mm") ++known;
  return known >= 2;
}

std::string extension_of(const std::string& file_name) {
  return lower(std::filesystem::path(file_name).extension().string());
}

Result<Imported> wrapped(FileFormat format, Result<MeasurementSet> set) {
  if (!set) return tl::unexpected(std::move(set.error()));
  return Imported{format, std::move(*set), {}};
}

Result<Imported> environment_of(std::string_view text, const std::string& file_name) {
  auto records = parse_sios_environment(text, file_name);
  if (!records) return tl::unexpected(std::move(records.error()));
  Imported imported{FileFormat::sios_environment, {}, std::move(*records)};
  imported.set.source = file_name;
  return imported;
}

Result<Imported> parsed_text(FileFormat format, std::string_view text, const std::string& file_name,
                             const ImportOptions& options) {
  switch (format) {
    case FileFormat::renishaw_run:
      return wrapped(format, parse_renishaw_run(text, file_name, options));
    case FileFormat::renishaw_table:
      return wrapped(format, parse_renishaw_table(text, file_name, options));
    case FileFormat::api_pos:
      return wrapped(format, parse_api_pos(text, file_name, options));
    case FileFormat::iso230_assignments:
      return wrapped(format, parse_iso230_assignments(text, file_name, options));
    case FileFormat::sios_environment:
      return environment_of(text, file_name);
    case FileFormat::renishaw_dynamic:
      return wrapped(format, parse_renishaw_dynamic(text, file_name, options));
    case FileFormat::measurement_csv:
      break;
  }
  return wrapped(FileFormat::measurement_csv, parse_measurement_set(text, file_name));
}

}  // namespace

std::string_view name_of(FileFormat format) {
  constexpr std::array<std::string_view, 7> kNames{"measurement CSV",
                                                   "Renishaw run file (.rtl .rta .rts)",
                                                   "Renishaw dynamic capture (.rtx)",
                                                   "Renishaw error compensation table (.REN)",
                                                   "API laser report (.pos)",
                                                   "SIOS environment log (.pos)",
                                                   "ISO 230-2 assignments (.dat)"};
  return kNames[static_cast<std::size_t>(format)];
}

std::optional<FileFormat> format_of(std::string_view bytes, const std::string& file_name) {
  if (is_dynamic(bytes)) return FileFormat::renishaw_dynamic;
  if (has(bytes, "TARGET DATA::") || has(bytes, "DEVIATIONS::")) return FileFormat::renishaw_run;
  if (has(bytes, "REF_DATA_FWD[") || has(bytes, "REF_DATA_BWD[")) return FileFormat::iso230_assignments;
  if (has(bytes, "Avg Error")) return FileFormat::api_pos;
  if (has(bytes, "Axis position") && has(bytes, "Combined")) return FileFormat::renishaw_table;
  const std::string_view line = first_line(bytes);
  if (is_nine_numbers(line)) return FileFormat::sios_environment;
  if (is_csv_header(line) || extension_of(file_name) == ".csv") return FileFormat::measurement_csv;
  return std::nullopt;
}

Result<Imported> parse_any(std::string_view bytes, const std::string& file_name, const ImportOptions& options) {
  const auto format = format_of(bytes, file_name);
  if (format == FileFormat::renishaw_dynamic) return parsed_text(*format, bytes, file_name, options);
  const auto text = decoded(bytes, file_name, options.encoding);
  if (!text) return tl::unexpected(text.error());
  if (!format) {
    std::string known;
    for (std::size_t i = 0; i < 7; ++i)
      known += fmt::format("{}{}", i == 0 ? "" : ", ", name_of(static_cast<FileFormat>(i)));
    return problem_at(file_name, 0, 0, "not a measurement file that is known here; looked for: " + known);
  }
  auto imported = parsed_text(*format, text->text, file_name, options);
  if (imported && text->encoding != Encoding::utf8)
    imported->set.notes.push_back(fmt::format("not UTF-8: read as {}", name_of(text->encoding)));
  return imported;
}

Result<Imported> read_any(const std::filesystem::path& path, const ImportOptions& options) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_any(*bytes, path.string(), options);
}

Result<Axis> axis_wanted(const ImportOptions& options, const std::string& file_name) {
  if (options.axis) return *options.axis;
  return tl::unexpected(Problem{
      ProblemKind::usage, "the file does not say which axis moved: give the axis X, Y or Z", file_name, 0, 0, {}});
}

Result<Sense> positioning_sense(const ImportOptions& options, Axis axis, const std::string& file_name) {
  const Sense sense = options.sense.value_or(static_cast<Sense>(index_of(axis)));
  if (!is_rotation(sense)) return sense;
  return tl::unexpected(
      Problem{ProblemKind::usage,
              fmt::format("the file holds lengths: expected the sense EX, EY or EZ, found {}", ecs::name_of(sense)),
              file_name,
              0,
              0,
              {}});
}

Vector3 position_at(const ImportOptions& options, Axis axis, double target_mm) {
  Vector3 position = options.parked_mm;
  position[index_of(axis)] = target_mm;
  return position;
}

void number_rows(MeasurementSet& set) {
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].row = static_cast<int>(i) + 1;
}

}  // namespace ecs::laser
