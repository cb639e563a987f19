// `ecs laser import`: what an instrument wrote, as a measurement set in our CSV or as another instrument's file.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/import_profile.hpp"
#include "commissioning/measurements/json.hpp"
#include "laser/import/registry.hpp"

namespace ecs::app {
namespace {

/// "the file to write: CSV, or .rtl .rta …"
std::string output_help() {
  std::vector<std::string_view> extensions;
  for (const auto* format : laser::file_formats().subspan(1))  // the first is the CSV
    extensions.insert(extensions.end(), format->written_extensions.begin(), format->written_extensions.end());
  return fmt::format("the file to write: CSV, or {}", fmt::join(extensions, " "));
}

struct FileImportArguments : VerbArguments {
  const std::vector<std::string>& files = texts("FILE", "measurement files; several are joined", Need::required);
  const std::string& output = text("-o,--output", output_help());
  const std::string& save_profile = text("--save-profile", "keep the import options given, under this name or path");
  ImportOptions import{*this};
};

Json json_of_file(const std::string& file, const laser::Imported& imported) {
  Json object{{"file", file}, {"format", imported.format->title}};
  object.update(json_of(imported.set));
  if (!imported.environment.empty()) object["environment_records"] = imported.environment.size();
  return object;
}

/// A plate or a probed surface has hundreds of lines; the first of them show what was read.
std::string shortened_table(std::vector<LineSummary> lines) {
  constexpr std::size_t kShown = 20;
  const std::size_t more = lines.size() - std::min(lines.size(), kShown);
  lines.resize(lines.size() - more);
  return lines_table(lines) + (more > 0 ? fmt::format("and {} more measurement lines\n", more) : "");
}

std::string text_of_file(const std::string& file, const laser::Imported& imported) {
  std::string text = fmt::format("{}: {}\n", file, imported.format->title);
  if (imported.set.readings.empty())
    text += fmt::format("  no readings; {} records of the environment\n", imported.environment.size());
  else
    text += shortened_table(lines_in(imported.set));
  for (const std::string& note : imported.set.notes) text += fmt::format("  assumed: {}\n", note);
  return text;
}

Json whole(const std::vector<Json>& files, const laser::MeasurementSet& set, const std::string& output) {
  Json format = files.front()["format"];
  for (const Json& file : files)
    if (file["format"] != format) format = nullptr;
  Json object{{"format", std::move(format)}};
  object.update(json_of(set));
  object["output"] = text_or_null(output);
  object["files"] = files;
  return object;
}

/// The set in the form that the output's extension names; the measurement CSV for any other.
Result<void> write_set(const std::string& output, const laser::MeasurementSet& set) {
  const auto& format = laser::format_written_as(std::filesystem::path(output).extension().string());
  const auto content = format.write(set, output);
  if (!content) return tl::unexpected(content.error());
  return write_file(output, *content);
}

Result<Outcome> import(VerbContext&, const FileImportArguments& arguments) {
  if (const auto distinct = check_output_not_input(arguments.output, arguments.files); !distinct)
    return tl::unexpected(distinct.error());
  std::vector<laser::MeasurementSet> sets;
  std::vector<Json> files;
  std::string text;
  for (const std::string& file : arguments.files) {
    auto imported = read_measurements(file, arguments.import);
    if (!imported) return tl::unexpected(imported.error());
    text += text_of_file(file, *imported);
    files.push_back(json_of_file(file, *imported));
    sets.push_back(std::move(imported->set));
  }
  if (!arguments.save_profile.empty()) {
    const auto kept = with_profile(arguments.import);
    if (!kept) return tl::unexpected(kept.error());
    const auto saved = save_profile(arguments.save_profile, *kept);
    if (!saved) return tl::unexpected(saved.error());
    text += fmt::format("import options kept in {}\n", saved->string());
  }
  auto all = joined(sets);
  if (!all) return tl::unexpected(all.error());
  if (arguments.output.empty()) {
    text += "nothing written: give -o OUT.csv to keep it\n";
  } else {
    if (all->readings.empty()) return problem(ProblemKind::refused, "no readings: there is nothing to write");
    if (const auto written = write_set(arguments.output, *all); !written) return tl::unexpected(written.error());
    text += fmt::format("{} readings written to {}\n", all->readings.size(), arguments.output);
  }
  return Outcome{text, one_line(whole(files, *all, arguments.output)), kDone};
}

}  // namespace

extern const VerbDefinition kLaserImport = verb<FileImportArguments>(
    "laser import", "any instrument's file as a measurement set (CSV); names the format it recognised",
    "ecs laser import x_axis.rtl -o x_axis.csv --parked y=-1400,z=0\n"
    "  ecs laser import table.txt --columns \"x_mm=1[in],reading=2*25.4,approach=motion\" "
    "--skip 3 --save-profile gauge -o table.csv",
    import);

}  // namespace ecs::app
