// `ecs laser import`: what an instrument wrote, as a measurement set in our CSV or as another instrument's file.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/measurements/given_files.hpp"
#include "commissioning/measurements/import_profile.hpp"
#include "laser/import/format.hpp"

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
  const std::string& output = output_file("-o,--output", output_help());
  const std::string& save_profile = text("--save-profile", "keep the import options given, under this name or path");
  const bool& force = flag("--force", "overwrites an output file or a profile that is there");
  RotaryImportOptions import{*this};
};

/// A plate or a probed surface has hundreds of lines; the first of them show what was read.
constexpr std::size_t kLinesShown = 20;

Cell file_cell(const std::string& file, const laser::Imported& imported) {
  AnswerFields fields{{"file", word_cell(file)}, {"format", word_cell(imported.format->title)}};
  append(fields, set_fields(imported.set, kLinesShown));
  const Cell records = count_cell(imported.environment.rows.size());
  fields.push_back({"environment_records", imported.environment.rows.empty() ? shown_cell(records.text) : records});
  fields.push_back({"environment", imported.environment.rows.empty()
                                       ? shown_cell({})
                                       : conditions_cell(conditions_in(imported.environment), "rows")});
  return record_cell(imported.set.readings.empty()
                         ? "{file}: {format}\n  no readings; {environment_records} records of the environment, to be "
                           "joined by --environment\n{environment}{notes}"
                         : "{file}: {format}\n{lines}{notes}",
                     fields);
}

/// null where the files differ in format.
Cell format_cell(const Json& files) {
  for (const Json& file : files)
    if (file["format"] != files.front()["format"]) return null_cell();
  return {files.front()["format"], {}};
}

Cell answer_cell(const Cell& files, const laser::MeasurementSet& set, const std::string& output,
                 const std::string& profile) {
  AnswerFields fields{{"format", format_cell(files.json)}};
  append(fields, set_fields(set));
  append(fields, {{"output", output.empty() ? null_cell("nothing written: give -o OUT.csv to keep it\n")
                                            : Cell{output, fmt::format("{} readings written to {}\n",
                                                                       set.readings.size(), output)}},
                  {"files", files},
                  {"profile", shown_cell(profile)}});
  return record_cell("{files}{profile}{output}", fields);
}

/// The set in the form that the output's extension names; the measurement CSV for any other.
Result<void> write_set(const std::string& output, const laser::MeasurementSet& set) {
  const auto& format = laser::format_written_as(std::filesystem::path(output).extension().string());
  ECS_TRY(content, format.write(set, output));
  return write_file(output, content);
}

Result<Outcome> import(VerbContext& context, const FileImportArguments& arguments) {
  ECS_TRY(given, given_files(arguments.files));
  for (const std::string& note : given.notes) context.console.note(note);
  ECS_DO(check_output_not_input(arguments.output, given.files));
  std::vector<laser::MeasurementSet> sets;
  Cell files{Json::array(), {}};
  for (const std::string& file : given.files) {
    ECS_TRY(imported, read_measurements(file, arguments.import));
    files.add(file_cell(file, imported));
    sets.push_back(std::move(imported.set));
  }
  std::string profile;
  if (!arguments.save_profile.empty()) {
    ECS_TRY(kept, with_profile(arguments.import));
    ECS_TRY(saved, save_profile(arguments.save_profile, kept, arguments.force));
    profile = fmt::format("import options kept in {}\n", saved.string());
  }
  ECS_TRY(all, joined(sets));
  if (!arguments.output.empty()) {
    if (all.readings.empty()) return problem(ProblemKind::refused, "no readings: there is nothing to write");
    ECS_DO(write_set(arguments.output, all));
  }
  return outcome_of(answer_cell(files, all, arguments.output, profile));
}

}  // namespace

extern const VerbDefinition kLaserImport = verb<FileImportArguments>(
    "laser import", "any instrument's file as a measurement set (CSV); names the format it recognised",
    "ecs laser import x_axis.rtl -o x_axis.csv --parked y=-1400,z=0\n"
    "  ecs laser import table.txt --columns \"x_mm=1[in],reading=2*25.4,approach=motion\" "
    "--skip 3 --save-profile gauge -o table.csv",
    import);

}  // namespace ecs::app
