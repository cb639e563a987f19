#include "laser/import/registry.hpp"

#include <algorithm>
#include <array>

#include "base/text.hpp"
#include "laser/import/readers.hpp"

namespace ecs::laser {

extern const FileFormat kMeasurementCsv;
extern const FileFormat kRenishawRun;
extern const FileFormat kRenishawDynamic;
extern const FileFormat kRenishawTable;
extern const FileFormat kApiReport;
extern const FileFormat kSiosEnvironment;
extern const FileFormat kEnvironmentTable;
extern const FileFormat kIso230Assignments;
extern const FileFormat kPlate;
extern const FileFormat kJsonLines;
extern const FileFormat kMappedColumns;
extern const FileFormat kMappedMatrix;

std::span<const FileFormat* const> file_formats() {
  // clang-format off
  static constexpr std::array kFormats{
      &kMeasurementCsv,
      &kRenishawRun,
      &kRenishawDynamic,
      &kRenishawTable,
      &kApiReport,
      &kSiosEnvironment,
      &kEnvironmentTable,
      &kIso230Assignments,
      &kPlate,
      &kJsonLines,
      &kMappedColumns,
      &kMappedMatrix,
  };
  // clang-format on
  return kFormats;
}

const FileFormat* file_format(std::string_view id) {
  const auto formats = file_formats();
  const auto at = std::find_if(formats.begin(), formats.end(), [&](const auto* format) { return format->id == id; });
  return at == formats.end() ? nullptr : *at;
}

const FileFormat* recognised_format(std::string_view text, const std::string& file_name) {
  const FileStart file(text, file_name);
  const FileFormat* likely = nullptr;
  for (const FileFormat* format : file_formats()) {
    const Recognition found = format->recognises ? format->recognises(file) : Recognition::no;
    if (found == Recognition::certain) return format;
    if (found == Recognition::likely && !likely) likely = format;
  }
  return likely;
}

const FileFormat& format_written_as(std::string_view extension) {
  for (const FileFormat* format : file_formats()) {
    const auto& own = format->written_extensions;
    if (std::find(own.begin(), own.end(), lower(extension)) != own.end()) return *format;
  }
  return kMeasurementCsv;
}

FileStart::FileStart(std::string_view whole, std::string_view name) : text(whole), file_name(name) {
  constexpr std::size_t kHeadBytes = 16 * 1024;  // heads and headings are at the start of a file
  head = lower(text.substr(0, kHeadBytes));
  for (const std::string_view line : lines_of(text.substr(0, kHeadBytes)))
    if (first_line.empty() && !trimmed(line).starts_with('#')) first_line = trimmed(line);
}

}  // namespace ecs::laser
