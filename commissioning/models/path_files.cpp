#include "commissioning/models/path_files.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/diagonals.hpp"
#include "model/data/path.hpp"

namespace ecs::commissioning {
namespace {

using laser::MeasurementSet;
using laser::Reading;

/// The first line that is neither empty nor a comment.
std::string_view header_of(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    const std::string_view words = trimmed(line);
    if (!words.empty() && words.front() != '#') return words;
  }
  return {};
}

bool names_all(std::string_view header, std::initializer_list<std::string_view> columns) {
  return std::all_of(columns.begin(), columns.end(),
                     [&](std::string_view column) { return header.find(column) != header.npos; });
}

}  // namespace

Result<std::optional<MeasurementSet>> read_path_file(const std::string& file) {
  const auto text = read_file(file);
  if (!text) return std::optional<MeasurementSet>();  // the readers of other formats say why
  const std::string_view header = header_of(*text);
  if (names_all(header, {"angle_deg", "deviation_um"})) {
    ECS_TRY(test, laser::parse_circle_test(*text, file));
    return std::optional(model::set_of_circle(test));
  }
  if (names_all(header, {"diagonal", "deviation_um"})) {
    ECS_TRY(test, laser::parse_diagonals(*text, file));
    ECS_TRY(set, model::set_of_diagonals(test));
    return std::optional(std::move(set));
  }
  return std::optional<MeasurementSet>();
}

Result<MeasurementSet> joined_with_paths(MeasurementSet lines, std::vector<MeasurementSet> paths) {
  if (paths.empty()) return lines;
  std::vector<MeasurementSet> heads;
  if (!lines.readings.empty()) heads.push_back(std::move(lines));
  for (const MeasurementSet& set : paths) {
    heads.push_back(set);
    heads.back().readings.clear();
  }
  auto all = joined(heads);
  if (!all) return all;
  std::map<std::string, int> last_run;  // by path
  for (MeasurementSet& set : paths) {
    std::map<std::string, int> last_of_set;
    for (Reading& reading : set.readings) {
      const std::string& path = reading.text_extras.find(model::kPathColumn)->second;
      int& last = last_of_set.try_emplace(path, 0).first->second;
      last = std::max(last, reading.run);
      reading.run += last_run[path];
      all->readings.push_back(std::move(reading));
    }
    for (const auto& [path, run] : last_of_set) {
      if (last_run[path] > 0)
        all->notes.push_back(fmt::format("{}: its runs of {} are numbered on from {}", set.source,
                                         path.substr(0, path.find(" radius")), last_run[path] + 1));
      last_run[path] += run;
    }
  }
  return all;
}

}  // namespace ecs::commissioning
