// Which format a file has, by what it holds. Does not live here: reading it, explaining what is not read.
#include <algorithm>
#include <array>
#include <filesystem>

#include "base/text.hpp"
#include "laser/import/import.hpp"
#include "laser/import/renishaw_file.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kHeadBytes = 16 * 1024;  ///< heads and headings stand at the start of a file

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

bool is_dynamic(std::string_view head) {
  return has(head, "header::") && has(head, "data:") && !has(head, "target data::") && !has(head, "deviations::");
}

/// The first line that holds something and is no comment.
std::string_view first_line(std::string_view text) {
  for (const std::string_view line : lines_of(text.substr(0, kHeadBytes)))
    if (!trimmed(line).empty() && !trimmed(line).starts_with('#')) return trimmed(line);
  return {};
}

/// Numbers of a line that holds nothing else.
std::vector<double> numbers_alone(std::string_view line) {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(line)) {
    const auto number = number_or_comma(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// Nine numbers, the seventh a pressure in Pa.
bool is_environment(std::string_view line) {
  const auto numbers = numbers_alone(line);
  return numbers.size() == 9 && numbers[6] > 30'000.0 && numbers[6] < 130'000.0;
}

/// X, Y, Z and six zeros.
bool is_probe_point(std::string_view line) {
  const auto numbers = numbers_alone(line);
  return numbers.size() == 9 && std::all_of(numbers.begin() + 3, numbers.end(), [](double n) { return n == 0.0; });
}

bool is_channel_sample(std::string_view line) {
  const auto words = words_of(line);
  return words.size() >= 4 && has(words[1], "-") && seconds_in(std::string(words[1]) + " " + std::string(words[2])) &&
         !number_in(words[0]);
}

bool has_channel_samples(std::string_view head) {
  int found = 0;
  for (const std::string_view line : lines_of(head)) found += is_channel_sample(line) ? 1 : 0;
  return found >= 2;
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

bool is_csv_name(const std::string& file_name) {
  return lower(std::filesystem::path(file_name).extension().string()) == ".csv";
}

}  // namespace

std::string_view name_of(FileFormat format) {
  constexpr std::array<std::string_view, kFileFormats> kNames{"measurement CSV",
                                                              "Renishaw run file (.rtl .rta .rts)",
                                                              "Renishaw dynamic capture (.rtx)",
                                                              "Renishaw error compensation table (.REN)",
                                                              "API laser report (.pos)",
                                                              "SIOS environment log (.pos)",
                                                              "ISO 230-2 assignments (.dat)",
                                                              "hole positions of a plate",
                                                              "probed surface (bed mesh, height map)",
                                                              "log of channels (camonitor)",
                                                              "table by a mapping of columns"};
  return kNames[static_cast<std::size_t>(format)];
}

std::optional<FileFormat> format_of(std::string_view text, const std::string& file_name) {
  const std::string head = lower(text.substr(0, kHeadBytes));
  if (is_dynamic(head)) return FileFormat::renishaw_dynamic;
  if (has(head, "target data::") || has(head, "deviations::")) return FileFormat::renishaw_run;
  if (has(text, "REF_DATA_FWD[") || has(text, "REF_DATA_BWD[")) return FileFormat::iso230_assignments;
  if (has(head, "avg error") && has(head, "position")) return FileFormat::api_pos;
  if (has(head, "axis position") && has(head, "combined")) return FileFormat::renishaw_table;
  if (has(head, "meas x") && has(head, "nom x") && has(head, "err x")) return FileFormat::plate;
  if (has(text, "[bed_mesh ") || head.starts_with("reprapfirmware height map file")) return FileFormat::height_map;
  const std::string_view line = first_line(text);
  if (is_csv_header(line)) return FileFormat::measurement_csv;
  if (is_environment(line)) return FileFormat::sios_environment;
  if (is_probe_point(line)) return FileFormat::height_map;
  if (has_channel_samples(text.substr(0, kHeadBytes))) return FileFormat::channel_log;
  if (is_csv_name(file_name) && has(head, "axis") && has(head, "reading")) return FileFormat::measurement_csv;
  return std::nullopt;
}

}  // namespace ecs::laser
