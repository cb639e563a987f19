#include "laser/import/renishaw_file.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

/// `NAME::` alone on a line.
std::optional<std::string> section_in(std::string_view line) {
  const std::string_view text = trimmed(line);
  if (text.size() < 3 || !text.ends_with("::")) return std::nullopt;
  const std::string_view name = trimmed(text.substr(0, text.size() - 2));
  if (name.empty() || name.find(':') != std::string_view::npos) return std::nullopt;
  return lower(name);
}

std::optional<MetadataEntry> entry_in(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  return MetadataEntry{std::string(trimmed(line.substr(0, colon))), std::string(trimmed(line.substr(colon + 1)))};
}

/// Walks the lines, one section at a time.
class SectionReader {
 public:
  SectionReader(RunFile& file, Findings& findings) : file_(file), findings_(findings) {}

  void take(std::string_view line, int number) {
    if (trimmed(line).empty()) return;
    if (auto section = section_in(line)) {
      section_ = std::move(*section);
      in_targets_ = false;
      if (section_ == "eof") file_.has_end = true;
    } else if (section_ == "header") {
      take_entry(line, file_.header);
    } else if (section_ == "target data") {
      take_target_data(line, number);
    } else if (section_ == "user-text") {
      take_entry(line, file_.user_text);
    } else if (section_ == "equipment") {
      take_entry(line, file_.equipment);
    } else if (section_ == "environment") {
      take_entry(line, file_.environment);
    } else if (section_ == "runs") {
      take_run_count(line, number);
    } else if (section_ == "deviations") {
      take_point(line, number);
    }
  }

 private:
  static void take_entry(std::string_view line, std::vector<MetadataEntry>& entries) {
    if (auto entry = entry_in(line)) entries.push_back(std::move(*entry));
  }

  void take_targets(std::string_view line, std::string_view part, int number) {
    for (const std::string_view word : words_of(part)) {
      const auto target = number_or_comma(word);
      if (target)
        file_.targets.push_back(*target);
      else
        findings_.add(number, column_of(line, word), "Targets: expected a position, found " + in_quotes(word));
    }
  }

  void take_target_data(std::string_view line, int number) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) {
      if (in_targets_) take_targets(line, line, number);
      return;
    }
    const MetadataEntry entry = *entry_in(line);
    const std::string key = lower(entry.key);
    in_targets_ = key == "targets";
    if (in_targets_) {
      take_targets(line, line.substr(colon + 1), number);
    } else if (key == "target-count") {
      file_.target_count = count_in(entry, number);
    } else if (key == "flags") {
      for (const std::string_view word : words_of(line.substr(colon + 1)))
        file_.flags.push_back(integer_in(word).value_or(-1));
    } else {
      file_.header.push_back(entry);
    }
  }

  std::optional<long long> count_in(const MetadataEntry& entry, int number) {
    const auto count = integer_in(entry.value);
    if (!count || *count < 1)
      findings_.add(number, 1,
                    fmt::format("{}: expected a whole number above 0, found {}", entry.key, in_quotes(entry.value)));
    return count;
  }

  void take_run_count(std::string_view line, int number) {
    const auto entry = entry_in(line);
    if (entry && lower(entry->key) == "run-count") file_.run_count = count_in(*entry, number);
  }

  void take_point(std::string_view line, int number) {
    if (line.find(':') != std::string_view::npos) return;  // the line "Run Target Data:"
    const auto words = words_of(line);
    const auto run = integer_in(words[0]);
    const auto target = words.size() > 1 ? integer_in(words[1]) : std::nullopt;
    const auto deviation = words.size() > 2 ? number_or_comma(words[2]) : std::nullopt;
    const auto known = [](std::optional<long long> value) { return value && *value >= 1 && *value <= 1'000'000; };
    if (words.size() != 3 || !known(run) || !known(target) || !deviation) {
      findings_.add(number, column_of(line, words[0]),
                    "DEVIATIONS: expected run number, target number and deviation, found " + in_quotes(trimmed(line)));
      return;
    }
    file_.points.push_back({number, static_cast<int>(*run), static_cast<int>(*target), *deviation});
  }

  RunFile& file_;
  Findings& findings_;
  std::string section_;
  bool in_targets_ = false;
};

void check_points(const RunFile& file, Findings& findings) {
  std::set<std::pair<int, int>> seen;
  for (const RunPoint& point : file.points) {
    if (static_cast<std::size_t>(point.target) > file.targets.size())
      findings.add(
          point.line, 0,
          fmt::format("DEVIATIONS: expected a target number up to {}, found {}", file.targets.size(), point.target));
    if (file.run_count && point.run > *file.run_count)
      findings.add(
          point.line, 0,
          fmt::format("DEVIATIONS: expected a run number up to {} (Run-count), found {}", *file.run_count, point.run));
    if (!seen.emplace(point.run, point.target).second)
      findings.add(
          point.line, 0,
          fmt::format("DEVIATIONS: expected each point once, found run {} target {} again", point.run, point.target));
  }
}

void check_whole(const RunFile& file, Findings& findings) {
  constexpr std::string_view kCutShort = ": the file is cut short; --accept-truncated reads the rest";
  if (file.target_count && static_cast<std::size_t>(*file.target_count) != file.targets.size())
    findings.add(0, 0,
                 fmt::format("Targets: expected {} (Target-count), found {}", *file.target_count, file.targets.size()));
  int passes = 0;
  for (const RunPoint& point : file.points) passes = std::max(passes, point.run);
  if (file.run_count && *file.run_count != passes)
    findings.add(
        0, 0, fmt::format("DEVIATIONS: expected {} runs (Run-count), found {}{}", *file.run_count, passes, kCutShort));
  std::set<int> present;
  for (const RunPoint& point : file.points) present.insert(point.run);
  const std::size_t expected = present.size() * file.targets.size();
  if (file.points.size() != expected)
    findings.add(0, 0,
                 fmt::format("DEVIATIONS: expected {} points ({} runs of {} targets), found {}{}", expected,
                             present.size(), file.targets.size(), file.points.size(), kCutShort));
}

}  // namespace

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlanks = " \t\r\n\f\v";
  for (;;) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return words;
    text.remove_prefix(first);
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(text))
    if (const auto number = number_or_comma(word)) numbers.push_back(*number);
  return numbers;
}

std::optional<std::string> value_of(const std::vector<MetadataEntry>& entries, std::string_view key) {
  for (const MetadataEntry& entry : entries)
    if (lower(entry.key) == lower(key) && !entry.value.empty()) return entry.value;
  return std::nullopt;
}

Result<RunFile> run_file_in(std::string_view text, const std::string& file_name, bool accept_truncated) {
  RunFile file;
  Findings findings(file_name);
  SectionReader reader(file, findings);
  int number = 0;
  for (const std::string_view line : lines_of(text)) {
    if (file.has_end) break;
    reader.take(line, ++number);
  }
  if (file.targets.empty()) findings.add(0, 0, "TARGET DATA: expected target positions, found none");
  if (file.points.empty()) findings.add(0, 0, "DEVIATIONS: expected points, found none");
  if (findings.empty()) check_points(file, findings);
  if (findings.empty() && !accept_truncated) check_whole(file, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return file;
}

}  // namespace ecs::laser
