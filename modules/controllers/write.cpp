// `ecs export <format>`: the map as files that another controller reads, a verb for each format of the registry.
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/verbs/map/unit.hpp"
#include "base/answer_table.hpp"
#include "base/overwriting.hpp"
#include "commissioning/measurements/files.hpp"
#include "modules/controllers/export.hpp"
#include "modules/controllers/format.hpp"
#include "modules/controllers/format_arguments.hpp"

namespace ecs::app {
namespace {

Result<void> make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && std::filesystem::is_directory(folder, error)) return {};
  return problem(ProblemKind::output, fmt::format("cannot make the folder {}: {}", folder,
                                                  error ? error.message() : "something else of that name is there"));
}

/// Into a folder, or the only file under the name given.
Result<std::vector<WrittenFile>> write_all(const controllers::ControllerExport& made, const std::string& output,
                                           bool folder, const std::vector<std::string>& inputs, bool force) {
  std::vector<OutputFile> files;
  if (output.empty()) return std::vector<WrittenFile>();
  for (const controllers::ExportFile& file : made.files)
    files.push_back({folder ? (std::filesystem::path(output) / file.name).string() : output, file.content});
  for (const OutputFile& file : files) ECS_DO(check_output_not_input(file.path, inputs));
  for (const OutputFile& file : files)
    if (!force && would_overwrite(file.path))
      return problem(ProblemKind::usage,
                     fmt::format("{} exists already: give another name, or --force to overwrite it", file.path));
  if (folder) ECS_DO(make_folder(output));
  return write_together(files);
}

/// Directions that a model does not predict: the values there are what the compensation adds by itself.
void note_silent_directions(ExportWork& work, const std::vector<controllers::ResidualRow>& residuals) {
  for (const Axis axis : kAllAxes) {
    const std::size_t d = index_of(axis);
    const controllers::ResidualRow& volume = residuals.back();
    if (volume.before.largest_um[d] == 0.0 && volume.unit.largest_um[d] > 0.0)
      work.notes.push_back(fmt::format("{} has no error along {}: what is left there is what the compensation adds",
                                       work.errors_from, letter_of(axis)));
  }
}

/// A folder that holds files of two maps is named, nothing in it is taken away.
void note_left_from_before(ExportWork& work, const std::string& folder, const std::vector<WrittenFile>& written,
                           const controllers::ControllerFormat& format) {
  const auto left = left_from_before(folder, written, format.is_file);
  if (!left.empty())
    work.notes.push_back(fmt::format("left from before, not of this export: {}", fmt::join(left, ", ")));
}

struct WriteRequest {
  ExportArguments from;
  FormatValues options;
};

Result<ExportWork> read_export_work(VerbContext& context, const ExportArguments& arguments) {
  if (!arguments.model.empty() && arguments.machine.empty())
    return problem(ProblemKind::usage, "--model needs --machine: the model counts from the datum of its axes");
  ECS_TRY(found, found_map(context, arguments.map, arguments.unit));
  return export_work(context.console, arguments, std::move(found));
}

Result<Outcome> exported(VerbContext& context, const WriteRequest& request,
                         const controllers::ControllerFormat& format) {
  const ExportArguments& arguments = request.from;
  const controllers::OptionValues options = request.options.values();
  ECS_TRY(work, read_export_work(context, arguments));
  ECS_TRY(errors, errors_for(context.console, arguments, work));
  auto made = format.write(work.source, options);
  if (!made) {
    Problem why = made.error();
    if (why.file.empty() && why.kind != ProblemKind::usage) why.file = work.map_name;
    return tl::unexpected(std::move(why));
  }
  const MeasurementLines lines =
      options.text("levers") == "lines" ? work.source.parameters.measurement_lines_mm : MeasurementLines{};
  ECS_TRY(residuals, controllers::residuals(work.source, made->applied, lines, errors));
  note_silent_directions(work, residuals);
  const bool folder = format.is_file != nullptr;
  ECS_TRY(written, write_all(*made, arguments.output, folder, work.inputs, arguments.force));
  if (folder && !arguments.output.empty()) note_left_from_before(work, arguments.output, written, format);
  const ExportReport report{std::string(format.title),       work, *made, residuals, std::move(written),
                            folder ? "-o FOLDER" : "-o FILE"};
  return outcome_of(export_cell(report));
}

Action writer_of(const controllers::ControllerFormat& format) {
  const auto fields = [&format] {
    Fields<WriteRequest> all(&WriteRequest::from, ExportArguments::fields(std::string(format.output_help)));
    for (const controllers::FormatOption& option : format.write_options)
      all.add({&WriteRequest::options, field_of(option, std::string(option.help))});
    return all;
  };
  return cli::action<VerbContext, WriteRequest, Outcome>(
      fmt::format("export {}", format.id), std::string(format.summary), std::string(format.example),
      [&format](VerbContext& context, const WriteRequest& request) { return exported(context, request, format); },
      {.link = Link::reads, .logged = Logged::when_written, .kind = "export", .logged_as = "export"}, fields);
}

}  // namespace

const std::vector<Action>& export_writers() {
  static const std::vector<Action> writers = [] {
    std::vector<Action> all;
    for (const controllers::ControllerFormat* format : controllers::controller_formats())
      if (format->write) all.push_back(writer_of(*format));
    return all;
  }();
  return writers;
}

}  // namespace ecs::app
