#include "commissioning/laser_session/prepared_lines.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/laser_session/curves.hpp"
#include "commissioning/session/commands.hpp"

namespace ecs::commissioning {
namespace {

std::string with_reason(std::string what, const std::string& reason) {
  return reason.empty() ? what : fmt::format("{} ({})", what, reason);
}

/// The line that one of its files states so; null: there is none.
const LaserLine* line_stated(const std::vector<LaserLine>& lines, const std::string& stated) {
  if (stated.empty()) return lines.size() == 1 ? &lines.front() : nullptr;
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const LaserLine& line) {
    return line.key == stated || std::find(line.stated.begin(), line.stated.end(), stated) != line.stated.end();
  });
  return found == lines.end() ? nullptr : &*found;
}

Problem no_such_line(const std::vector<LaserLine>& lines, const std::string& sought) {
  std::vector<std::string> keys;
  for (const LaserLine& line : lines) keys.push_back(fmt::format("\"{}\"", line.key));
  return {ProblemKind::usage,
          fmt::format("--line: expected one of the lines that were measured, {}; found {}", fmt::join(keys, ", "),
                      sought.empty() ? std::string("none") : fmt::format("\"{}\"", sought)),
          {},
          0,
          0,
          {}};
}

/// What is left out must be there: else it is probably a typing error.
Result<void> all_there(const LaserLine& line, const LaserLineChoice& left_out) {
  std::set<int> runs;
  for (const laser::Reading& reading : line.set->readings) runs.insert(reading.run);
  for (const auto& [run, reason] : left_out.runs)
    if (!runs.contains(run))
      return problem(ProblemKind::usage,
                     fmt::format("--leave-out-run {}: there is no such run; there are {}", run, fmt::join(runs, ", ")));
  for (const auto& [place, reason] : left_out.readings)
    if (place >= line.set->readings.size())
      return problem(ProblemKind::usage, fmt::format("--leave-out-reading {}: the line has {} readings", place + 1,
                                                     line.set->readings.size()));
  return {};
}

std::string with_equals(const std::string& number, const std::string& reason) {
  return reason.empty() ? number : number + "=" + reason;
}

}  // namespace

laser::MeasurementSet prepared_set(const LaserLine& line, const LaserLineChoice& choice) {
  laser::MeasurementSet set = line_result(line, choice).chosen;
  for (const std::string& file : line.files)
    set.metadata.push_back({"prepared_from", std::filesystem::path(file).filename().string()});
  for (const auto& [run, reason] : choice.runs)
    set.metadata.push_back({"left_out", with_reason(fmt::format("run {}", run), reason)});
  for (const auto& [place, reason] : choice.readings) {
    if (place >= line.set->readings.size()) continue;
    const laser::Reading& reading = line.set->readings[place];
    set.metadata.push_back(
        {"left_out",
         with_reason(fmt::format("run {} at {} mm", reading.run, shortest(laser::target_mm(reading))), reason)});
  }
  return set;
}

Result<laser::MeasurementSet> prepared_line(const PreparedLineRequest& request) {
  LaserChoices choices;
  for (const std::string& file : request.files) choices.files.push_back({file, request.import});
  const auto read = [&choices] {
    std::vector<LaserFile> files;
    for (const LaserFileChoice& choice : choices.files) files.push_back(read_laser_file(choice));
    return files;
  };
  std::vector<LaserFile> files = read();
  for (const LaserFile& file : files)
    if (!file.set) return problem(ProblemKind::bad_input, file.problem);
  std::vector<LaserLine> lines = laser_lines(files);
  const LaserLine* line = line_stated(lines, request.line);
  if (line == nullptr) return tl::unexpected(no_such_line(lines, request.line));
  if (!request.place.empty()) {
    const std::string stated = line->stated.front();
    ECS_DO(correct_place(choices, *line, request.place));
    lines = laser_lines(read());
    line = line_stated(lines, stated);
    if (line == nullptr) return tl::unexpected(no_such_line(lines, stated));
  }
  ECS_DO(all_there(*line, request.left_out));
  return prepared_set(*line, request.left_out);
}

std::optional<std::vector<std::string>> prepare_words(const LaserLine& line, const LaserLineChoice& left_out,
                                                      const std::vector<LaserFileChoice>& files,
                                                      const std::string& output) {
  std::vector<std::string> words{"laser", "prepare"}, import;
  std::string place;
  for (std::size_t k = 0; k < line.files.size(); ++k) {
    const auto file = std::find_if(files.begin(), files.end(), [&](const auto& f) { return f.path == line.files[k]; });
    if (file == files.end()) return std::nullopt;
    const auto corrected = file->places.find(line.stated[k]);
    const std::string place_here = corrected == file->places.end() ? std::string() : corrected->second;
    const auto import_here = import_words(file->answers);
    if (k > 0 && (place_here != place || import_here != import || line.stated[k] != line.stated.front()))
      return std::nullopt;
    place = place_here;
    import = import_here;
    words.push_back(path_word(file->path));
  }
  words.insert(words.end(), {"--line", line.stated.front()});
  if (!place.empty()) words.insert(words.end(), {"--place", place});
  for (const auto& [run, reason] : left_out.runs)
    words.insert(words.end(), {"--leave-out-run", with_equals(std::to_string(run), reason)});
  for (const auto& [at, reason] : left_out.readings)
    words.insert(words.end(), {"--leave-out-reading", with_equals(std::to_string(at + 1), reason)});
  words.insert(words.end(), import.begin(), import.end());
  words.insert(words.end(), {"-o", path_word(output)});
  return words;
}

}  // namespace ecs::commissioning
