#include "ecs_emulator/instruments/measurement_files.hpp"

#include <map>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/writers/measurement_writer.hpp"
#include "laser/writers/renishaw_writer.hpp"
#include "laser/writers/table_writers.hpp"

namespace ecs::emulator {
namespace {

/// The same set with metadata under the names of a Renishaw file.
laser::MeasurementSet in_renishaw_words(laser::MeasurementSet set) {
  const std::map<std::string, std::string> words{{"machine", "Machine"}, {"serial_number", "Serial No"},
                                                 {"date", "Date"},       {"engineer", "By"},
                                                 {"plan", "TITLE"},      {"feed_mm_min", "Velocity"}};
  for (auto& entry : set.metadata)
    if (const auto word = words.find(entry.key); word != words.end()) entry.key = word->second;
  return set;
}

Result<void> write_text(const std::filesystem::path& path, const Result<std::string>& text) {
  if (text) return write_file(path, *text);
  Problem problem = text.error();
  problem.message = fmt::format("{}: {}", path.string(), problem.message);
  return tl::unexpected(std::move(problem));
}

}  // namespace

Result<void> write_measurement(const std::filesystem::path& path, const laser::MeasurementSet& set) {
  const std::string name = lower(path.filename().string());
  const std::string extension = lower(path.extension().string());
  if (extension == ".csv") return laser::write_measurement_set(path, set);
  if (extension == ".ren") return write_text(path, laser::to_renishaw_table(set));
  if (extension == ".dat") return write_text(path, laser::to_iso230_assignments(set));
  if (name.ends_with(".env.pos")) return write_text(path, laser::to_sios_environment(laser::environment_of(set)));
  if (extension == ".pos") return write_text(path, laser::to_api_pos(set));
  if (extension == ".rtx")
    return write_text(path, laser::to_renishaw_dynamic(in_renishaw_words(set), path.filename().string()));
  const std::string renishaw = laser::renishaw_extension(set);
  if (extension == renishaw) return write_text(path, laser::to_renishaw_run(in_renishaw_words(set)));
  return problem(ProblemKind::usage,
                 fmt::format("{}: expected a name that ends in .csv, {}, .ren, .pos, .dat, .rtx or .env.pos for this "
                             "measurement",
                             path.string(), renishaw));
}

}  // namespace ecs::emulator
