// `ecs export read`: a control's compensation tables back into a map CSV.
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/axis_argument.hpp"
#include "app/verbs/export/axes.hpp"
#include "app/verbs/export/menu.hpp"
#include "base/file.hpp"
#include "base/paragraph.hpp"
#include "base/text.hpp"
#include "commissioning/maps/export_files.hpp"
#include "commissioning/maps/view.hpp"
#include "commissioning/measurements/files.hpp"
#include "controllers/etalon.hpp"
#include "controllers/linuxcnc.hpp"
#include "controllers/twincat.hpp"
#include "laser/map/csv.hpp"
#include "laser/text_decoding.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct ReadArguments {
  std::vector<std::string> files;
  std::string output;
  std::string format = "auto";
  std::string axis;
  std::string type;
  std::string units = "mm";
  bool as_loaded = false;
  std::string levers;
  SiemensArguments siemens;
  TwinCatArguments twincat;
  std::string params;
  std::string params_out;
};

/// The first line that says something begins with a number.
bool is_numbers(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == ';') continue;
    return number_in(content.substr(0, content.find_first_of(" \t"))).has_value();
  }
  return false;
}

/// By what stands in it; empty: nothing that is known here.
std::string format_of(const std::string& wanted, std::string_view text) {
  if (wanted != "auto") return wanted;
  const std::string plain = lower(text);
  if (plain.find("$aa_enc_comp") != std::string::npos || plain.find("$an_cec") != std::string::npos) return "siemens";
  if (plain.find("kw.ssfk.") != std::string::npos) return "twincat";
  const bool sections = plain.find('[') != std::string::npos;
  if (sections && (plain.find("gridpoints") != std::string::npos || plain.find("value") != std::string::npos))
    return "etalon";
  return is_numbers(text) ? "linuxcnc" : "";
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// "x.comp", "mill_y.comp", "screwcompZ.dat": a letter of its own at the end of the name.
std::optional<Axis> axis_in_name(const std::string& file) {
  const std::string stem = std::filesystem::path(file).stem().string();
  if (stem.empty()) return std::nullopt;
  const char last = stem.back();
  const bool capital = last >= 'A' && last <= 'Z';
  const bool apart = stem.size() == 1 || !is_letter(stem[stem.size() - 2]) ||
                     (capital && stem[stem.size() - 2] >= 'a' && stem[stem.size() - 2] <= 'z');
  return apart ? axis_of(capital ? last : static_cast<char>(last - 'a' + 'A')) : std::nullopt;
}

/// What --axis says; nothing if it was not given.
Result<std::optional<Axis>> axis_given(const ReadArguments& arguments) {
  if (arguments.axis.empty()) return std::nullopt;
  if (arguments.files.size() > 1)
    return problem(ProblemKind::usage, "--axis names the axis of one file; several are told apart by what they say");
  const auto axis = axis_named(arguments.axis);
  if (!axis) return tl::unexpected(axis.error());
  return *axis;
}

Result<controllers::ControllerTables> read_twincat(const ReadArguments& arguments, const std::string& file,
                                                   const std::string& text) {
  const auto options = twincat_options(arguments.twincat, arguments.siemens.axes);
  if (!options) return tl::unexpected(options.error());
  const auto axis = axis_given(arguments);
  if (!axis) return tl::unexpected(axis.error());
  return controllers::parse_twincat(text, file, *options, *axis);
}

Result<controllers::ControllerTables> read_linuxcnc(const ReadArguments& arguments, const std::string& file,
                                                    const std::string& bytes) {
  controllers::LinuxCncReadOptions options;
  const auto given = axis_given(arguments);
  if (!given) return tl::unexpected(given.error());
  if (*given) {
    options.axis = **given;
  } else {
    const auto axis = axis_in_name(file);
    if (!axis)
      return problem(ProblemKind::usage,
                     fmt::format("{}: which axis is it? Its name does not end in x, y or z: give --axis", file));
    options.axis = *axis;
  }
  if (!arguments.type.empty()) options.type = arguments.type == "0" ? 0 : 1;
  options.units = arguments.units == "inch" ? controllers::MachineUnits::inch : controllers::MachineUnits::mm;
  options.as_loaded = arguments.as_loaded;
  return controllers::parse_linuxcnc(bytes, file, options);
}

struct ReadFiles {
  controllers::ControllerTables tables;
  std::string format;
};

Result<ReadFiles> read_files(const ReadArguments& arguments) {
  const auto siemens = siemens_options(arguments.siemens);
  if (!siemens) return tl::unexpected(siemens.error());
  ReadFiles all;
  for (const std::string& file : arguments.files) {
    const auto bytes = read_file(file);
    if (!bytes) return tl::unexpected(bytes.error());
    const auto text = laser::decoded(*bytes, file);
    if (!text) return tl::unexpected(text.error());
    const std::string format = format_of(arguments.format, text->text);
    if (format.empty())
      return problem_at(file, 0, 0,
                        "no compensation table that is known here: expected rows of three numbers (LinuxCNC), "
                        "$AA_ENC_COMP or $AN_CEC (SINUMERIK), kw.ssfk (TwinCAT), or sections such as [EXX] (Etalon); "
                        "--format says which");
    if (!all.format.empty() && format != all.format)
      return problem(ProblemKind::usage,
                     fmt::format("{} is of format {}, the files before it of {}: read one control at a time", file,
                                 format, all.format));
    all.format = format;
    auto tables = format == "siemens"   ? controllers::parse_siemens(text->text, file, *siemens)
                  : format == "etalon"  ? controllers::parse_etalon(text->text, file)
                  : format == "twincat" ? read_twincat(arguments, file, text->text)
                                        : read_linuxcnc(arguments, file, *bytes);
    if (!tables) return tl::unexpected(tables.error());
    for (auto& source : tables->sources) source.name = std::filesystem::path(file).filename().string();
    if (const auto done = controllers::append(all.tables, std::move(*tables), format != "siemens"); !done)
      return tl::unexpected(done.error());
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

/// Where the lever arms of an Etalon file count from: as --levers says, else its head, else the machine zero.
Result<bool> levers_from_lines(const ReadArguments& arguments, const ReadFiles& files) {
  const auto& said = files.tables.levers_from_lines;
  if (arguments.levers.empty()) return said.value_or(false);
  const bool lines = arguments.levers == "lines";
  if (said && *said != lines)
    return problem(ProblemKind::usage,
                   fmt::format("--levers {}: the file says of itself that its lever arms count from the {}",
                               arguments.levers, *said ? "measurement lines" : "machine zero"));
  return lines;
}

/// Etalon curves onto the lines of the parameters, and a word on it whatever was done.
Result<void> bring_to_lines(const ReadArguments& arguments, const ReadFiles& files, Taken& made) {
  const auto lines = levers_from_lines(arguments, files);
  if (!lines) return tl::unexpected(lines.error());
  const std::string by = !arguments.levers.empty()        ? "as --levers says"
                         : files.tables.levers_from_lines ? "as the head of the file says"
                                                          : "the file does not say it: --levers lines if it is not so";
  made.levers_from = *lines ? "measurement lines" : "machine zero";
  made.moved = !*lines && made.parameters.has_value();
  std::string done;
  if (made.parameters) {
    const UnitParameters& parameters = made.parameters->parameters;
    made.read.map = controllers::at_measurement_lines(made.read.map, parameters, *lines);
    done = *lines
               ? fmt::format("the curves were not moved; the parameters must hold the lines they were measured on ({})",
                             lines_in_words(parameters))
               : fmt::format("the curves were moved from there to the measurement lines of the parameters ({})",
                             lines_in_words(parameters));
    made.read.map.header.processing.push_back(
        made.moved ? fmt::format("curves moved from the machine zero to {}", lines_in_words(parameters))
                   : "curves as on their measurement lines, not moved");
  } else {
    done = *lines ? "the curves were not moved; the file does not hold the lines: the parameters must have those they "
                    "were measured on"
                  : "the curves were not moved: set measurement_line_mm to 0 in the parameters, or give --params to "
                    "have them brought to its measurement lines";
  }
  made.notes.push_back(fmt::format("lever arms count from the {} ({}); {}", made.levers_from, by, done));
  return {};
}

Result<Taken> taken(const ReadArguments& arguments, const ReadFiles& files) {
  Taken made;
  made.read = controllers::map_of(files.tables);
  made.notes = files.tables.notes;
  made.notes.insert(made.notes.end(), made.read.notes.begin(), made.read.notes.end());
  if (!arguments.levers.empty() && files.format != "etalon")
    return problem(ProblemKind::usage, "--levers is for the Etalon format: no other has lever arms");
  auto& header = made.read.map.header;
  if (!arguments.params.empty()) {
    auto file = params::read_parameters(arguments.params);
    if (!file) return tl::unexpected(file.error());
    made.parameters = std::move(*file);
    header.configuration = configuration_of(made.parameters->parameters);
    header.machine = made.parameters->identity.machine;
    header.serial_number = made.parameters->identity.serial_number;
  }
  header.processing.push_back(fmt::format("read from tables of a control ({})", files.format));
  if (files.format == "etalon")
    if (const auto done = bring_to_lines(arguments, files, made); !done) return tl::unexpected(done.error());
  return made;
}

/// The map and the parameters, as far as they were asked for.
std::vector<OutputFile> outputs_of(const ReadArguments& arguments, const Taken& made) {
  std::vector<OutputFile> files;
  if (!arguments.output.empty()) files.push_back({arguments.output, laser::to_map_csv(made.read.map)});
  if (arguments.params_out.empty()) return files;
  UnitParameters parameters = made.parameters->parameters;
  for (const Component square : made.read.squareness_found) {
    const double value = made.read.squareness[index_of(square)];
    (square == Component::C0Y   ? parameters.C0Y_um_per_m
     : square == Component::B0Z ? parameters.B0Z_um_per_m
                                : parameters.A0Z_um_per_m) = value;
  }
  files.push_back({arguments.params_out, params::parameters_toml(parameters, made.parameters->identity)});
  return files;
}

std::string text_of(const ReadArguments& arguments, const ReadFiles& files, const Taken& made) {
  std::string text = fmt::format("{}\n\n", files.format) + tables_text(made.read.map.tables);
  for (const Component square : made.read.squareness_found)
    text += fmt::format("compensation.squareness.{}_um_per_m = {:.4f}\n", name_of(square),
                        made.read.squareness[index_of(square)]);
  if (!made.read.squareness_found.empty())
    text += arguments.params_out.empty()
                ? "squareness lives in the parameters: put these there, or give --params and --params-out\n"
                : fmt::format("squareness is in {}\n", arguments.params_out);
  for (const std::string& note : made.notes) text += paragraph("note: " + note, 0, 6);
  return text + (arguments.output.empty() ? "no map written: give -o map.csv to keep it\n" : "");
}

Json json_of_read(const ReadArguments& arguments, const ReadFiles& files, const Taken& made,
                  const std::vector<WrittenFile>& written) {
  Json tables = Json::array(), squareness = Json::object(), warnings = Json::array(), replaced = Json::array();
  for (const WrittenFile& file : written)
    if (file.replaced) replaced.push_back(file.path);
  for (const laser::MapTable& table : made.read.map.tables) tables.push_back(json_of(table, false));
  for (const Component square : made.read.squareness_found)
    squareness[fmt::format("{}_um_per_m", name_of(square))] = number_or_null(made.read.squareness[index_of(square)]);
  for (const Problem& warning : files.tables.warnings) warnings.push_back(json_of(warning));
  return {{"format", files.format},
          {"map", text_or_null(arguments.output)},
          {"tables", std::move(tables)},
          {"squareness", std::move(squareness)},
          {"levers_from", text_or_null(made.levers_from)},
          {"curves_moved", made.moved},
          {"replaced", std::move(replaced)},
          {"warnings", std::move(warnings)},
          {"notes", made.notes}};
}

Result<Outcome> read(VerbContext& context, const ReadArguments& arguments) {
  if (!arguments.params_out.empty() && arguments.params.empty())
    return problem(ProblemKind::usage, "--params-out needs --params: the rest of the parameters is taken from there");
  std::vector<std::string> inputs = arguments.files;
  inputs.push_back(arguments.params);
  for (const std::string& output : {arguments.output, arguments.params_out})
    if (const auto spared = check_output_not_input(output, inputs); !spared) return tl::unexpected(spared.error());
  if (!arguments.params_out.empty())
    if (const auto spared = check_output_not_input(arguments.params_out, {arguments.output}); !spared)
      return tl::unexpected(spared.error());
  auto files = read_files(arguments);
  if (!files) return tl::unexpected(files.error());
  const std::vector<Problem> warnings = files->tables.warnings;
  const auto made = taken(arguments, *files);
  if (!made) return tl::unexpected(made.error());
  for (const Problem& warning : warnings) context.console.warn(to_text(warning));
  const auto written = write_together(outputs_of(arguments, *made));
  if (!written) return tl::unexpected(written.error());
  return Outcome{text_of(arguments, *files, *made) + to_text(*written),
                 one_line(json_of_read(arguments, *files, *made, *written)), kDone};
}

}  // namespace

void add_export_read(Menu& menu) {
  const auto arguments = std::make_shared<ReadArguments>();
  Verb verb = menu.verb("read", "the compensation tables of a control as a map CSV",
                        "ecs export read x.comp y.comp z.comp --type 1 -o map.csv\n"
                        "ecs export read AX_EEC.INI NC_CEC.INI --params mill.toml --params-out read.toml -o map.csv");
  verb.texts("FILE", arguments->files, "files of one control", Need::required)
      .text("-o,--output", arguments->output, "map CSV to write")
      .choice("--format", arguments->format, {"auto", "linuxcnc", "siemens", "etalon", "twincat"},
              "default: by its content")
      .text("--axis", arguments->axis, "LinuxCNC, TwinCAT: the axis; default from the file's name, from what it says")
      .choice("--type", arguments->type, {"0", "1"}, "LinuxCNC: COMP_FILE_TYPE; default by the numbers")
      .choice("--units", arguments->units, {"mm", "inch"}, "LinuxCNC: LINEAR_UNITS; default mm")
      .choice("--levers", arguments->levers, {"zero", "lines"},
              "Etalon: where its lever arms count from; default as its head says, else zero")
      .flag("--as-loaded", arguments->as_loaded, "LinuxCNC: only the rows that it would take itself")
      .text("--params", arguments->params, "parameters of the machine: identity, measurement lines")
      .text("--params-out", arguments->params_out, "the same with the squareness that was read");
  take_siemens_arguments(verb, arguments->siemens);
  take_twincat_arguments(verb, arguments->twincat);
  verb.runs([arguments](VerbContext& context) { return read(context, *arguments); });
}

}  // namespace ecs::app
