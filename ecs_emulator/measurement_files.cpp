#include "ecs_emulator/measurement_files.hpp"

#include <map>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/measurement_writer.hpp"
#include "laser/renishaw_writer.hpp"

namespace ecs::emulator {
namespace {

/// The same set with metadata under the names of a Renishaw file.
laser::MeasurementSet in_renishaw_words(laser::MeasurementSet set) {
  const std::map<std::string, std::string> words{
      {"machine", "Machine"}, {"serial_number", "Serial No"}, {"date", "Date"}, {"engineer", "By"}, {"plan", "TITLE"}};
  for (auto& entry : set.metadata)
    if (const auto word = words.find(entry.key); word != words.end()) entry.key = word->second;
  return set;
}

}  // namespace

Result<void> write_measurement(const std::filesystem::path& path, const laser::MeasurementSet& set) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".csv") return laser::write_measurement_set(path, set);
  const std::string renishaw = laser::renishaw_extension(set);
  if (extension == renishaw) return laser::write_renishaw_run(path, in_renishaw_words(set));
  return problem(ProblemKind::usage, fmt::format("{}: expected a name that ends in .csv or {} for this measurement",
                                                 path.string(), renishaw));
}

}  // namespace ecs::emulator
