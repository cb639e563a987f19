// `ecs export linuxcnc`, `siemens`, `etalon`, `twincat`: the map as files that another control reads.
#include <filesystem>
#include <functional>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/verbs/export/axes.hpp"
#include "app/verbs/export/export_arguments.hpp"
#include "app/verbs/export/menu.hpp"
#include "commissioning/maps/export_files.hpp"
#include "commissioning/maps/export_view.hpp"
#include "commissioning/measurements/files.hpp"
#include "controllers/etalon.hpp"
#include "controllers/linuxcnc.hpp"
#include "controllers/siemens.hpp"
#include "controllers/twincat.hpp"

namespace ecs::app {
namespace {

using Maker = std::function<Result<controllers::ControllerExport>(const controllers::ExportSource&)>;

Result<void> make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && std::filesystem::is_directory(folder, error)) return {};
  return problem(ProblemKind::output, fmt::format("cannot make the folder {}: {}", folder,
                                                  error ? error.message() : "something else of that name is there"));
}

/// Into a folder, or the only file under the name given.
Result<std::vector<WrittenFile>> write_all(const controllers::ControllerExport& made, const std::string& output,
                                           bool folder, const std::vector<std::string>& inputs) {
  std::vector<OutputFile> files;
  if (output.empty()) return std::vector<WrittenFile>();
  for (const controllers::ExportFile& file : made.files)
    files.push_back({folder ? (std::filesystem::path(output) / file.name).string() : output, file.content});
  for (const OutputFile& file : files)
    if (const auto spared = check_output_not_input(file.path, inputs); !spared) return tl::unexpected(spared.error());
  if (folder)
    if (const auto done = make_folder(output); !done) return tl::unexpected(done.error());
  return write_together(files);
}

/// Directions of which a model says nothing: what stands there is what the compensation adds by itself.
void note_silent_directions(ExportWork& work, const std::vector<controllers::ResidualRow>& residuals) {
  for (const Axis axis : kAllAxes) {
    const std::size_t d = index_of(axis);
    const controllers::ResidualRow& volume = residuals.back();
    if (volume.before.largest_um[d] == 0.0 && volume.unit.largest_um[d] > 0.0)
      work.notes.push_back(fmt::format("{} has no error along {}: what is left there is what the compensation adds",
                                       work.errors_from, letter_of(axis)));
  }
}

struct Target {
  std::string control;
  bool (*is_its_file)(std::string_view name) = nullptr;  ///< of several, in a folder; none: one file of any name
  bool levers_from_line = false;
};

/// A folder that holds files of two maps is named, nothing in it is taken away.
void note_left_from_before(ExportWork& work, const std::string& folder, const std::vector<WrittenFile>& written,
                           const Target& target) {
  const auto left = left_from_before(folder, written, target.is_its_file);
  if (!left.empty())
    work.notes.push_back(fmt::format("left from before, not of this export: {}", fmt::join(left, ", ")));
}

Result<Outcome> exported(VerbContext& context, const ExportArguments& arguments, const Target& target,
                         const Maker& make) {
  auto work = read_export_work(context, arguments);
  if (!work) return tl::unexpected(work.error());
  const auto errors = errors_for(context.console, arguments, *work);
  if (!errors) return tl::unexpected(errors.error());
  auto made = make(work->source);
  if (!made) {
    Problem why = made.error();
    if (why.file.empty()) why.file = work->map_name;
    return tl::unexpected(std::move(why));
  }
  const MeasurementLines lines =
      target.levers_from_line ? work->source.parameters.measurement_lines_mm : MeasurementLines{};
  const auto residuals = controllers::residuals(work->source, made->applied, lines, *errors);
  if (!residuals) return tl::unexpected(residuals.error());
  note_silent_directions(*work, *residuals);
  const bool folder = target.is_its_file != nullptr;
  auto written = write_all(*made, arguments.output, folder, work->inputs);
  if (!written) return tl::unexpected(written.error());
  if (folder && !arguments.output.empty()) note_left_from_before(*work, arguments.output, *written, target);
  const ExportReport told{
      target.control, *work, *made, *residuals, std::move(*written), folder ? "-o FOLDER" : "-o FILE"};
  return Outcome{export_text(told), one_line(json_of(told)), kDone};
}

void add_linuxcnc(Menu& menu) {
  struct WriteArguments : ExportArguments {
    std::string type = "1";
    std::string units = "mm";
    int points = static_cast<int>(controllers::kLinuxCncMostPoints);
  };
  const auto arguments = std::make_shared<WriteArguments>();
  Verb verb = menu.verb("linuxcnc", "a screw compensation file for each joint: positioning, both approaches",
                        "ecs export linuxcnc map.csv --params mill.toml -o linuxcnc/");
  take_export_arguments(verb, *arguments, "folder for x.comp, y.comp, z.comp");
  verb.choice("--type", arguments->type, {"0", "1"}, "COMP_FILE_TYPE: 0 positions, 1 trims (the default)")
      .choice("--units", arguments->units, {"mm", "inch"}, "LINEAR_UNITS of the control; default mm")
      .integer("--points", arguments->points, "most points of a file; LinuxCNC takes 256", 2,
               static_cast<int>(controllers::kLinuxCncMostPoints))
      .runs([arguments](VerbContext& context) {
        const controllers::LinuxCncOptions options{
            arguments->type == "0" ? 0 : 1,
            arguments->units == "inch" ? controllers::MachineUnits::inch : controllers::MachineUnits::mm,
            static_cast<std::size_t>(arguments->points)};
        return exported(
            context, *arguments, {"LinuxCNC", controllers::is_linuxcnc_file, false},
            [&](const controllers::ExportSource& source) { return controllers::linuxcnc_export(source, options); });
      });
}

void add_siemens(Menu& menu) {
  struct WriteArguments : ExportArguments {
    SiemensArguments siemens;
    int points = 1000;
    int tables = 62;
  };
  const auto arguments = std::make_shared<WriteArguments>();
  Verb verb = menu.verb("siemens",
                        "SINUMERIK 840D: encoder error tables, and cross tables for straightness, "
                        "squareness and reversal",
                        "ecs export siemens map.csv --params mill.toml --points 200 --tables 8 -o sinumerik/");
  take_export_arguments(verb, *arguments, "folder for AX_EEC.INI and NC_CEC.INI");
  take_siemens_arguments(verb, arguments->siemens);
  verb.integer("--points", arguments->points, "most points of a table; default 1000, 828D has 200", 2, 5000)
      .integer("--tables", arguments->tables, "most cross tables; default 62, 828D has 8", 0, 200)
      .runs([arguments](VerbContext& context) -> Result<Outcome> {
        auto options = siemens_options(arguments->siemens);
        if (!options) return tl::unexpected(options.error());
        options->most_points = static_cast<std::size_t>(arguments->points);
        options->most_tables = static_cast<std::size_t>(arguments->tables);
        return exported(
            context, *arguments, {"SINUMERIK 840D", controllers::is_siemens_file, false},
            [&](const controllers::ExportSource& source) { return controllers::siemens_export(source, *options); });
      });
}

void add_etalon(Menu& menu) {
  struct WriteArguments : ExportArguments {
    std::string levers = "zero";
    int points = 0;
  };
  const auto arguments = std::make_shared<WriteArguments>();
  Verb verb = menu.verb("etalon", "the whole volumetric model in the Etalon exchange format (TwinCAT, ISG)",
                        "ecs export etalon map.csv --params mill.toml -o mill_errors.txt");
  take_export_arguments(verb, *arguments, "file to write");
  verb.choice("--levers", arguments->levers, {"zero", "lines"},
              "where the control counts lever arms from: the machine zero (default), or the measurement lines")
      .integer("--points", arguments->points, "most grid points of a function; default: all of the map", 2, 1'000'000)
      .runs([arguments](VerbContext& context) {
        const controllers::EtalonOptions options{"errors.txt", arguments->levers == "zero",
                                                 static_cast<std::size_t>(arguments->points)};
        return exported(
            context, *arguments, {"Etalon exchange format", nullptr, arguments->levers == "lines"},
            [&](const controllers::ExportSource& source) { return controllers::etalon_export(source, options); });
      });
}

void add_twincat(Menu& menu) {
  struct WriteArguments : ExportArguments {
    std::string axes;
    TwinCatArguments twincat;
    int points = static_cast<int>(controllers::kTwinCatMostPoints);
  };
  const auto arguments = std::make_shared<WriteArguments>();
  Verb verb =
      menu.verb("twincat", "TwinCAT CNC and ISG kernels: a leadscrew compensation list for each axis, both directions",
                "ecs export twincat map.csv --params mill.toml -o twincat/");
  take_export_arguments(verb, *arguments, "folder for achskw1.lis, achskw2.lis, achskw3.lis");
  take_twincat_arguments(verb, arguments->twincat);
  verb.text("--axes", arguments->axes, "logical axis numbers of the control; default X=1,Y=2,Z=3")
      .integer("--points", arguments->points, "most points of a list; default 1499", 2,
               static_cast<int>(controllers::kTwinCatMostPoints))
      .runs([arguments](VerbContext& context) -> Result<Outcome> {
        auto options = twincat_options(arguments->twincat, arguments->axes);
        if (!options) return tl::unexpected(options.error());
        options->most_points = static_cast<std::size_t>(arguments->points);
        return exported(
            context, *arguments, {"TwinCAT CNC, leadscrew compensation", controllers::is_twincat_file, false},
            [&](const controllers::ExportSource& source) { return controllers::twincat_export(source, *options); });
      });
}

}  // namespace

void add_export_writers(Menu& menu) {
  add_linuxcnc(menu);
  add_siemens(menu);
  add_etalon(menu);
  add_twincat(menu);
}

}  // namespace ecs::app
