// `ecs export <format>`: the map as files that another controller reads, a verb for each format of the registry, its
// options fields of the request. `ecs export read`: a control's compensation tables back into a map CSV.

#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/module.hpp"
#include "app/cli/verb.hpp"
#include "app/verbs/map/unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/machine_map.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/map/csv.hpp"
#include "laser/text_decoding.hpp"
#include "modules/controllers/export.hpp"
#include "modules/controllers/format.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

/// What was typed for the options of formats, by their names.
struct FormatValues {
  std::map<std::string, std::variant<std::string, int, bool>> typed;
  [[nodiscard]] controllers::OptionValues values() const;
};

/// `--name`
Fields<FormatValues> field_of(const controllers::FormatOption& option, const std::string& help) {
  cli::Argument argument{"--" + std::string(option.name), {}, help};
  if (option.range)
    say(argument, Range{static_cast<double>(option.range->least), static_cast<double>(option.range->most)});
  if (!option.words.empty()) say(argument, Words(option.words.begin(), option.words.end()));
  return {std::move(argument), [option](FormatValues& formats) -> cli::Argument::Target {
            auto& value = formats.typed[std::string(option.name)];
            if (option.is_flag) return &value.emplace<bool>(false);
            if (option.range) return &value.emplace<int>(static_cast<int>(integer_in(option.fallback).value_or(0)));
            return &value.emplace<std::string>(option.fallback);
          }};
}

controllers::OptionValues FormatValues::values() const {
  controllers::OptionValues values;
  for (const auto& [name, value] : typed) {
    if (const auto* text = std::get_if<std::string>(&value)) values.set(name, *text);
    if (const auto* number = std::get_if<int>(&value)) values.set(name, std::to_string(*number));
    if (const auto* given = std::get_if<bool>(&value)) values.set(name, *given ? "1" : "");
  }
  return values;
}

Result<void> make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && std::filesystem::is_directory(folder, error)) return {};
  return problem(ProblemKind::output, "cannot make the folder {}: {}", folder,
                 error ? error.message() : "another file of that name exists");
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
      return problem(ProblemKind::usage, "{} already exists: give another name, or --force to overwrite it", file.path);
  if (folder) ECS_DO(make_folder(output));
  return write_together(files);
}

/// Directions that a model does not predict: the values there are what the compensation adds on its own.
void note_silent_directions(ExportWork& work, const std::vector<controllers::ResidualRow>& residuals) {
  for (const Axis axis : kAllAxes) {
    const std::size_t d = index_of(axis);
    const controllers::ResidualRow& volume = residuals.back();
    if (volume.before.largest_um[d] == 0.0 && volume.unit.largest_um[d] > 0.0)
      work.notes.push_back(fmt::format(
          "{} does not describe the error along {}: the remaining error there is only the added compensation",
          work.errors_from, letter_of(axis)));
  }
}

/// An export may be worse than none: the part of the map that it carries need not be of use without the rest.
void warn_if_worse(Console& console, const controllers::ResidualRow& volume, const PerAxis<bool>& present) {
  constexpr double kShown_um = 0.05;
  std::vector<std::string> worse;
  for (std::size_t d = 0; d <= kAxes; ++d)
    if ((d == kAxes || present[d]) && volume.control.rms_um[d] > volume.before.rms_um[d] + kShown_um)
      worse.push_back(fmt::format("{} {:.1f} instead of {:.1f} um rms",
                                  d == kAxes ? "vector" : std::string(1, letter_of(static_cast<Axis>(d))),
                                  volume.control.rms_um[d], volume.before.rms_um[d]));
  if (!worse.empty())
    console.warn(
        fmt::format("with this export, the predicted error in the volume is larger than without compensation: {}",
                    fmt::join(worse, ", ")));
}

/// A folder that holds files of two maps is named, nothing in it is taken away.
void note_left_from_before(ExportWork& work, const std::string& folder, const std::vector<WrittenFile>& written,
                           const controllers::ControllerFormat& format) {
  const auto left = left_from_before(folder, written, format.is_file);
  if (!left.empty())
    work.notes.push_back(fmt::format("from an earlier export, not from this one: {}", fmt::join(left, ", ")));
}

struct WriteRequest {
  ExportArguments from;
  FormatValues options;
};

Result<ExportWork> read_export_work(VerbContext& context, const ExportArguments& arguments) {
  if (!arguments.model.empty() && arguments.machine.empty())
    return problem(ProblemKind::usage,
                   "--model needs --machine: positions in the model count from the datum of each axis, which the "
                   "machine file states");
  ECS_TRY(found, found_map(context, arguments.map, arguments.unit));
  ECS_TRY(work, export_work(context.console, arguments, std::move(found)));
  std::vector<std::string> unknown;
  for (const Axis axis : kAllAxes)
    if (controllers::has_axis(work.source, axis) && !work.source.travel_mm[index_of(axis)])
      unknown.emplace_back(1, letter_of(axis));
  if (!unknown.empty())
    work.notes.push_back(
        fmt::format("the travel of {} is unknown, because the map has no table along {}: errors are predicted only "
                    "where the map was measured. State the travels with --machine",
                    fmt::join(unknown, " and "), unknown.size() == 1 ? "it" : "them"));
  for (std::string& note : left_to_machine(work.source.map.header)) work.notes.push_back(std::move(note));
  return work;
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
  warn_if_worse(context.console, residuals.back(), work.source.parameters.axis_present);
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

const std::vector<Action>& export_writers() {
  static const std::vector<Action> writers = [] {
    std::vector<Action> all;
    for (const controllers::ControllerFormat* format : controllers::controller_formats())
      if (format->write) all.push_back(writer_of(*format));
    return all;
  }();
  return writers;
}

std::vector<std::string> format_names() {
  std::vector<std::string> names{"auto"};
  for (const auto* format : controllers::controller_formats()) names.emplace_back(format->id);
  return names;
}

/// Every read option once, with what it means for each format that has it.
Fields<FormatValues> read_fields() {
  std::vector<const controllers::FormatOption*> options;
  std::map<std::string_view, std::string> help;
  for (const auto* format : controllers::controller_formats())
    for (const controllers::FormatOption& option : format->read_options) {
      std::string& words = help[option.name];
      if (words.empty()) options.push_back(&option);
      words += fmt::format("{}{}: {}", words.empty() ? "" : ". ", format->name, option.help);
    }
  Fields<FormatValues> fields;
  for (const auto* option : options) fields.add(field_of(*option, help[option->name]));
  return fields;
}

struct ReadRequest {
  std::vector<std::string> files;
  std::string output, params, params_out;
  std::string format = "auto";
  FormatValues options;
  static Fields<ReadRequest> fields() {
    using R = ReadRequest;
    return {{"FILE", &R::files, "files of one control", Need::required},
            {"-o,--output", &R::output, "map CSV to write", Is::output},
            {"--format", &R::format, "format of the file; default: recognised from its content", format_names()},
            {&R::options, read_fields()},
            {"--params", &R::params, "parameters of the machine: identity, measurement lines"},
            {"--params-out", &R::params_out, "parameter file to write, with the squareness that was read", Is::output}};
  }
};

struct ReadFiles {
  controllers::ControllerTables tables;
  const controllers::ControllerFormat* format = nullptr;
};

/// "rows of three numbers (LinuxCNC), … or kw.ssfk (TwinCAT)"
std::string marks_of_all() {
  std::vector<std::string> marks;
  for (const auto* format : controllers::controller_formats())
    marks.push_back(fmt::format("{} ({})", format->marks, format->name));
  const std::string last = std::move(marks.back());
  marks.pop_back();
  return fmt::format("{} or {}", fmt::join(marks, ", "), last);
}

Result<const controllers::ControllerFormat*> format_of(const ReadRequest& request, const std::string& file,
                                                       std::string_view text) {
  const auto* format =
      request.format == "auto" ? controllers::recognised_format(text) : controllers::controller_format(request.format);
  if (format) return format;
  return problem_at(file, 0, 0, "not a known compensation table: expected {}; give --format", marks_of_all());
}

Result<ReadFiles> read_files(const ReadRequest& request) {
  ReadFiles all;
  for (const std::string& file : request.files) {
    ECS_TRY(bytes, read_file(file));
    ECS_TRY(text, laser::decoded(bytes, file));
    ECS_TRY(format, format_of(request, file, text.text));
    if (all.format && format != all.format)
      return problem(ProblemKind::usage,
                     "{} is of format {}, the previous files of {}: read the files of one controller at a time", file,
                     format->id, all.format->id);
    all.format = format;
    ECS_TRY(tables, all.format->read({file, text.text, bytes, request.files.size() == 1, request.options.values()}));
    for (auto& source : tables.sources) source.name = std::filesystem::path(file).filename().string();
    ECS_DO(controllers::append(all.tables, std::move(tables), !all.format->tables_add_up));
  }
  return all;
}

/// The map with its header, on the lines of the parameters where the format counts from the machine zero.
struct Taken {
  controllers::ReadMap read;
  std::string levers_from;  ///< as read: "machine zero", "measurement lines"; empty: the format has no lever arms
  bool moved = false;       ///< from the machine zero to the measurement lines
  std::optional<params::ParametersFile> parameters;
  std::vector<std::string> notes;
};

/// "X at Y 50, Z 100 mm; …"
std::string lines_in_words(const UnitParameters& parameters) {
  std::vector<std::string> words;
  for (const Axis axis : kAllAxes) {
    if (!parameters.axis_present[index_of(axis)]) continue;
    std::vector<std::string> at;
    for (const Axis other : kAllAxes)
      if (other != axis && parameters.axis_present[index_of(other)])
        at.push_back(fmt::format("{} {:.6g}", letter_of(other),
                                 parameters.measurement_lines_mm[index_of(axis)][index_of(other)]));
    if (!at.empty()) words.push_back(fmt::format("{} at {}", letter_of(axis), fmt::join(at, ", ")));
  }
  return fmt::format("{} mm", fmt::join(words, "; "));
}

std::string levers_given(const ReadRequest& request) { return std::string(request.options.values().text("levers")); }

/// Where the lever arms of a file count from: as --levers says, else its head, else the machine zero.
Result<bool> levers_from_lines(const ReadRequest& request, const ReadFiles& files) {
  const auto& said = files.tables.levers_from_lines;
  const std::string given = levers_given(request);
  if (given.empty()) return said.value_or(false);
  const bool lines = given == "lines";
  if (said && *said != lines)
    return problem(ProblemKind::usage,
                   "--levers {} contradicts the file: it states that its lever arms count from the {}. Omit --levers",
                   given, *said ? "measurement lines" : "machine zero");
  return lines;
}

/// Curves onto the lines of the parameters, with a note whatever was done.
Result<void> bring_to_lines(const ReadRequest& request, const ReadFiles& files, Taken& made) {
  ECS_TRY(lines, levers_from_lines(request, files));
  const std::string by = !levers_given(request).empty() ? "as given by --levers"
                         : files.tables.levers_from_lines
                             ? "as stated in the head of the file"
                             : "assumed, because the file does not state it: if this is wrong, give --levers lines";
  made.levers_from = lines ? "measurement lines" : "machine zero";
  made.moved = !lines && made.parameters.has_value();
  std::string done;
  if (made.parameters) {
    const UnitParameters& parameters = made.parameters->parameters;
    made.read.map = files.format->at_measurement_lines(made.read.map, parameters, lines);
    done =
        lines ? fmt::format(
                    "The curves were not moved: the parameters must contain the measurement lines of these curves ({})",
                    lines_in_words(parameters))
              : fmt::format("The curves were moved from there to the measurement lines of the parameters ({})",
                            lines_in_words(parameters));
    made.read.map.header.processing.push_back(
        made.moved ? fmt::format("curves moved from the machine zero to {}", lines_in_words(parameters))
                   : "curves as on their measurement lines, not moved");
  } else {
    done = lines
               ? "The curves were not moved. The file does not contain their measurement lines: they must be in the "
                 "parameters"
               : "The curves were not moved: set measurement_line_mm to 0 in the parameters for this map. Or give the "
                 "parameters with --params: then the curves are moved to the measurement lines";
  }
  made.notes.push_back(fmt::format("lever arms count from the {} ({}). {}", made.levers_from, by, done));
  return {};
}

Result<Taken> taken(const ReadRequest& request, const ReadFiles& files) {
  Taken made;
  made.read = controllers::map_of(files.tables);
  made.notes = files.tables.notes;
  made.notes.insert(made.notes.end(), made.read.notes.begin(), made.read.notes.end());
  const bool has_levers = files.format->at_measurement_lines != nullptr;
  if (!levers_given(request).empty() && !has_levers)
    return problem(ProblemKind::usage, "--levers: the {} format has no lever arms", files.format->name);
  auto& header = made.read.map.header;
  if (!request.params.empty()) {
    ECS_TRY(file, request.params_out.empty() ? params::read_parameters(request.params)
                                             : params::read_whole_parameters(request.params));
    made.parameters = std::move(file);
    header.configuration = configuration_of(made.parameters->parameters);
    header.machine = made.parameters->identity.machine;
    header.serial_number = made.parameters->identity.serial_number;
  }
  header.processing.push_back(fmt::format("read from tables of a control ({})", files.format->id));
  if (has_levers) ECS_DO(bring_to_lines(request, files, made));
  return made;
}

/// The map and the parameters, as far as they were asked for.
std::vector<OutputFile> outputs_of(const ReadRequest& request, const Taken& made) {
  std::vector<OutputFile> files;
  if (!request.output.empty()) files.push_back({request.output, laser::to_map_csv(made.read.map)});
  if (request.params_out.empty()) return files;
  UnitParameters parameters = made.parameters->parameters;
  for (const Component square : made.read.squareness_found)
    squareness_um_per_m(parameters, square) = made.read.squareness[index_of(square)];
  files.push_back({request.params_out, params::parameters_toml(parameters, made.parameters->identity)});
  return files;
}

Cell squareness_of(const ReadRequest& request, const Taken& made) {
  std::vector<std::pair<Component, double>> values;
  for (const Component square : made.read.squareness_found)
    values.emplace_back(square, made.read.squareness[index_of(square)]);
  Cell cell = squareness_cell(values);
  if (!values.empty())
    cell.text +=
        request.params_out.empty()
            ? "squareness is stored in the parameters: add these values there, or give --params and --params-out\n"
            : fmt::format("squareness is in {}\n", request.params_out);
  return cell;
}

Cell read_cell(const ReadRequest& request, const ReadFiles& files, const Taken& made,
               const std::vector<WrittenFile>& written) {
  return record_cell(
      "{format}\n\n{tables}{squareness}{notes}{map}{written}", "format"_is(files.format->id),
      "map"_is(text_or_null(request.output), request.output.empty() ? "not saved: give -o map.csv to save it\n" : ""),
      "tables"_is(tables_cell(made.read.map.tables, false)), "squareness"_is(squareness_of(request, made)),
      "levers_from"_is(text_cell(made.levers_from)), "curves_moved"_is(made.moved),
      "written"_shown(written_files_cell(written).text), "replaced"_is(replaced_files_cell(written)),
      "warnings"_is(list_cell(files.tables.warnings,
                              [](const Problem& one) {
                                return Cell{problem_json(one), {}};
                              })),
      "notes"_is(paragraphs_cell(made.notes, "note: ")));
}

Result<Outcome> read(VerbContext& context, const ReadRequest& request) {
  if (!request.params_out.empty() && request.params.empty())
    return problem(ProblemKind::usage, "--params-out needs --params: the other parameters are copied from it");
  std::vector<std::string> inputs = request.files;
  inputs.push_back(request.params);
  for (const std::string& output : {request.output, request.params_out}) ECS_DO(check_output_not_input(output, inputs));
  if (!request.params_out.empty()) ECS_DO(check_output_not_input(request.params_out, {request.output}));
  ECS_TRY(files, read_files(request));
  const std::vector<Problem> warnings = files.tables.warnings;
  ECS_TRY(made, taken(request, files));
  for (const Problem& warning : warnings) context.console.warn(to_text(warning));
  ECS_TRY(written, write_together(outputs_of(request, made)));
  return outcome_of(read_cell(request, files, made, written));
}

const std::vector<Action> kExportReading{
    action("export read", "convert compensation tables of a control to a map CSV",
           "ecs export read x.comp y.comp z.comp --type 1 -o map.csv\n"
           "  ecs export read AX_EEC.INI NC_CEC.INI --params mill.toml --params-out read.toml -o map.csv",
           read, {.logged = Logged::when_written, .kind = "export", .logged_as = "export"})};

}  // namespace

extern const std::vector<Action> kProgramExport;

const Module& controllers_module() {
  static const Module module{
      .menus = {{"export",
                 "OTHER CONTROLS: the error map as their compensation tables, and back; corrected part programs"}},
      .verbs = {{"volume", &export_writers()}, {"volume", &kProgramExport}, {"volume", &kExportReading}},
      .synonyms = {{"MORE", "export siemens heidenhain twincat linuxcnc part program G code"}},
      .advice = {{kTableOfControl, "`ecs export read` converts it to a map"}}};
  return module;
}

}  // namespace ecs::app
