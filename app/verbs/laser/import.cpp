// `ecs laser import`: what an instrument wrote, as a measurement file in our CSV or as another instrument's file.
// `ecs laser show`: conditions, measurement lines, and the means at every target.

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/measurements/files.hpp"
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

struct FileImportRequest {
  std::vector<std::string> files;
  std::string output, save_profile;
  bool force = false;
  ImportArguments import = ImportArguments().of_any_axis();
  static Fields<FileImportRequest> fields() {
    using R = FileImportRequest;
    return {{"FILE", &R::files, "measurement files; several are joined into one set", Need::required},
            {"-o,--output", &R::output, output_help(), Is::output},
            {"--save-profile", &R::save_profile, "save the import options under this name or path"},
            {"--force", &R::force, "overwrite an existing output file or profile"},
            &R::import};
  }
};

/// A plate or a probed surface has hundreds of lines; the first of them show what was read.
constexpr std::size_t kLinesShown = 20;

/// Of a table of columns, which no format recognises, the option that reads it.
std::string_view format_words(const laser::FileFormat& format) {
  return format.id == "mapped_columns" ? "table read with --columns" : format.title;
}

Cell file_cell(const std::string& file, const laser::Imported& imported) {
  AnswerFields fields = described("file"_is(file), "format"_is(imported.format->title, format_words(*imported.format)));
  append(fields, set_fields(imported.set, kLinesShown));
  const Cell records = cell_of(imported.environment.rows.size());
  fields.push_back("environment_records"_is(imported.environment.rows.empty() ? shown_cell(records.text) : records));
  fields.push_back("environment"_is(
      imported.environment.rows.empty() ? shown_cell() : conditions_cell(conditions_in(imported.environment), "rows")));
  return record_cell(imported.set.readings.empty()
                         ? "{file}: {format}\n  no readings; {environment_records} records of the environment; add "
                           "them with --environment\n{environment}{notes}"
                         : "{file}: {format}\n{lines}{notes}",
                     fields);
}

/// null where the files differ in format.
Cell format_cell(const Json& files) {
  for (const Json& file : files)
    if (file["format"] != files.front()["format"]) return null_cell();
  return {files.front()["format"], {}};
}

/// The format that the output's extension names; the measurement CSV for any other.
const laser::FileFormat& format_of(const std::string& output) {
  return laser::format_written_as(std::filesystem::path(output).extension().string());
}

/// Said where the extension promises another form than CSV.
std::string_view form_text(const std::string& output) {
  const std::string extension = lower(std::filesystem::path(output).extension().string());
  const bool as_named = extension.empty() || extension == ".csv" || extension == ".txt";
  return as_named || &format_of(output) != laser::file_formats().front() ? "" : " as measurement CSV";
}

Cell answer_cell(const Cell& files, const laser::MeasurementSet& set, const std::string& output,
                 const std::string& profile) {
  AnswerFields fields = described("format"_is(format_cell(files.json)));
  append(fields, set_fields(set));
  append(fields,
         "output"_is(output.empty() ? null_cell("not saved: give -o OUT.csv to save it\n")
                                    : Cell{output, fmt::format("{}{} readings written to {}{}\n",
                                                               format_of(output).writes_means ? "means of " : "",
                                                               set.readings.size(), output, form_text(output))}),
         "files"_is(files), "profile"_shown(profile));
  return record_cell("{files}{profile}{output}", fields);
}

Result<void> write_set(const std::string& output, const laser::MeasurementSet& set) {
  auto content = format_of(output).write(set, output);
  if (!content && !content.error().message.starts_with(output)) content.error().file = output;
  if (!content) return tl::unexpected(std::move(content.error()));
  return write_file(output, *content);
}

Result<Outcome> import(VerbContext& context, const FileImportRequest& request) {
  ECS_TRY(given, given_files(request.files));
  for (const std::string& note : given.notes) context.console.note(note);
  ECS_DO(check_output_not_input(request.output, given.files));
  std::vector<laser::MeasurementSet> sets;
  Cell files{Json::array(), {}};
  for (const std::string& file : given.files) {
    auto imported = read_measurements(file, request.import);
    if (!imported && imported.error().kind == ProblemKind::usage && !given.notes.empty())
      imported.error().message += ". Options apply to every file of a folder: import the files of each axis separately";
    if (!imported) return tl::unexpected(std::move(imported.error()));
    files.add(file_cell(file, *imported));
    sets.push_back(std::move(imported->set));
  }
  std::string profile;
  if (!request.save_profile.empty()) {
    ECS_TRY(kept, with_profile(request.import));
    ECS_TRY(saved, save_profile(request.save_profile, kept, request.force));
    profile = fmt::format("import options saved in {}\n", saved.string());
  }
  ECS_TRY(all, joined(sets));
  if (!request.output.empty()) {
    if (all.readings.empty()) return problem(ProblemKind::refused, "no readings to write");
    ECS_DO(write_set(request.output, all));
    for (const std::string& file : request.import.columns.empty() ? std::vector<std::string>() : given.files)
      remember_mapping(file, request.import);
  }
  return outcome_of(answer_cell(files, all, request.output, profile));
}

struct ShowRequest {
  std::string file;
  ImportArguments import = ImportArguments().of_any_axis();
  static Fields<ShowRequest> fields() {
    using R = ShowRequest;
    return {{"FILE", &R::file, "measurement file", Need::required}, &R::import};
  }
};

std::optional<double> reversal(const laser::TargetReadings& target) {
  const auto forward = laser::mean_of(target.forward), reverse = laser::mean_of(target.reverse);
  if (!forward || !reverse) return std::nullopt;
  return *forward - *reverse;
}

Cell mean_cell(const std::vector<double>& readings) { return number_cell(laser::mean_of(readings), 3); }
/// All of them in JSON, how many in the text.
Cell readings_cell(const std::vector<double>& readings) { return {readings, fmt::format("{}", readings.size())}; }

Cell target_cell(const laser::TargetReadings& t, bool rotary) {
  const char* const position = rotary ? "position_deg" : "position_mm";
  return record_cell(fmt::format("{{{}:>12}} ", position) +
                         "{mean_forward:>9} {forward:>8} {mean_reverse:>9} {reverse:>8} {mean_undirected:>9} "
                         "{undirected:>8} {reversal:>9}\n",
                     FieldKey(position)(t.position_mm, 4), "mean_forward"_is(mean_cell(t.forward)),
                     "forward"_is(readings_cell(t.forward)), "mean_reverse"_is(mean_cell(t.reverse)),
                     "reverse"_is(readings_cell(t.reverse)), "mean_undirected"_is(mean_cell(t.undirected)),
                     "undirected"_is(readings_cell(t.undirected)), "reversal"_shown(reversal(t), 3));
}

Cell targets_cell(const std::vector<laser::TargetReadings>& targets, bool rotary) {
  return list_cell(
      targets, [&](const laser::TargetReadings& t) { return target_cell(t, rotary); },
      fmt::format("{:>12} {:>18} {:>18} {:>18}\n{:>12} {:>9} {:>8} {:>9} {:>8} {:>9} {:>8} {:>9}\n", "", "forward",
                  "reverse", "approach unknown", fmt::format("target [{}]", laser::target_unit(rotary)), "mean",
                  "readings", "mean", "readings", "mean", "readings", "reversal"));
}

/// "circle XY ...: deviation of the radius"; "" off a path (docs/laser.md).
std::string path_text(const laser::Reading& reading) {
  const auto path = reading.text_extras.find("path");
  if (path == reading.text_extras.end()) return {};
  const bool circle = path->second.starts_with("circle ");
  if (!circle && !path->second.starts_with("diagonal ")) return {};
  return fmt::format("{}: deviation of the {}", path->second, circle ? "radius" : "distance from the start");
}

Result<Outcome> show(VerbContext&, const ShowRequest& request) {
  ECS_TRY(imported, read_measurements(request.file, request.import));
  const laser::MeasurementSet& set = imported.set;
  AnswerFields fields =
      described("file"_is(request.file), "format"_is(imported.format->title, format_words(*imported.format)));
  append(fields, set_fields(set));
  const Cell conditions = set.readings.empty() ? conditions_cell(conditions_in(imported.environment), "rows")
                                               : conditions_cell(conditions_in(set), "readings");
  fields.push_back("conditions"_is(conditions.json.empty() ? shown_cell() : conditions));
  Cell answer = record_cell("{file}: {format}, {readings} readings\n{metadata}{notes}{conditions}\n{lines}", fields);
  const auto groups = laser::groups_of(set);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Cell targets =
        targets_cell(laser::targets_of(set, groups[i], laser::target_tolerance_mm(set, groups[i])), groups[i].rotary);
    const laser::Reading& first = set.readings[groups[i].readings.front()];
    const std::string path = path_text(first);
    answer.text += path.empty() ? laid_out("\n{component} ({measured}), parked at {parked_mm} mm, in {unit}\n",
                                           measured_line_fields(groups[i]))
                                : fmt::format("\n{}, in um, by the coordinate of {}\n", path, letter_of(first.axis));
    answer.text += targets.text;
    answer.json["lines"][i]["by_target"] = targets.json;
  }
  return outcome_of(answer);
}

}  // namespace

extern const std::vector<Action> kLaserReading{
    action("laser import", "convert any instrument's file to a measurement file (CSV); reports the recognised format",
           "ecs laser import x_axis.rtl -o x_axis.csv --parked y=-1400,z=0\n"
           "  ecs laser import table.txt --columns \"x_mm=1[in],reading=2*25.4,approach=motion\" "
           "--skip 3 --save-profile gauge -o table.csv",
           import, {.logged = Logged::when_written, .kind = "measurement"}),
    action("laser show", "show conditions, lines, sensors and the mean at every target of a measurement file",
           "ecs laser show x_axis.csv", show)};

}  // namespace ecs::app
