// Tables for other controls: what every export begins with (a map, the parameters it goes with, the travels, where the
// error is known from), files written together or not at all, the answer as text and JSON.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/cli/action.hpp"
#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/session/message.hpp"
#include "controllers/residual.hpp"
#include "controllers/tables.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// As typed; empty: not given.
struct ExportArguments {
  std::string map;
  bool unit = false;
  std::string params;
  std::string machine;
  std::string model;
  std::string output;
  bool force = false;          ///< files that are there are overwritten
  bool other_machine = false;  ///< although map and parameters name different machines
  static cli::Fields<ExportArguments> fields(const std::string& output_help);
};

struct ExportWork {
  controllers::ExportSource source;
  std::string map_name;             ///< the file, or "the unit"
  std::string errors_from;          ///< "the map", or the model file
  std::vector<std::string> notes;   ///< what was not given, and what that means
  std::vector<std::string> inputs;  ///< files that must not be written over
};

/// @param found  the map that the arguments name
/// Refused: a map whose header names another configuration than the parameters, or (unless
/// `other_machine`) another machine or serial number. Without --params those of the unit, else of --machine, else what
/// the header of the map says.
[[nodiscard]] Result<ExportWork> export_work(MessageSink& messages, const ExportArguments& arguments, FoundMap found);

/// The travels of the axes that the parameters name: those of the machine, else as far as the map reaches.
[[nodiscard]] PerAxis<std::optional<std::array<double, 2>>> travels_for(const laser::ErrorMap& map,
                                                                        const UnitParameters& parameters,
                                                                        const std::optional<params::Machine>& machine);

/// The error that a model predicts at places, each direction as its own axis arrived there.
/// @param file  as problems name it
[[nodiscard]] controllers::ErrorsAt errors_of_model(model::Model model, params::Machine machine, std::string file);

/// The error of the machine at places: from the model if one is given, else from the map.
/// @param work  must outlive what is returned
[[nodiscard]] Result<controllers::ErrorsAt> errors_for(MessageSink& messages, const ExportArguments& arguments,
                                                       const ExportWork& work);

struct OutputFile {
  std::string path;
  std::string content;
};

struct WrittenFile {
  std::string path;
  bool replaced = false;  ///< something of that name was there before
};

/// Writes every file beside its name, then renames them all. Where one cannot be written, or its name is a folder or a
/// device, no file was changed; where renaming fails in the middle, what was renamed before is taken back. The `output`
/// problem says what stands where. A single file may also be a device, and is then written into.
[[nodiscard]] Result<std::vector<WrittenFile>> write_together(const std::vector<OutputFile>& files);

/// Names of files in the folder that `is_ours` knows and that were not written now, sorted: an earlier export left them
/// there, with another map.
[[nodiscard]] std::vector<std::string> left_from_before(const std::string& folder,
                                                        const std::vector<WrittenFile>& written,
                                                        const std::function<bool(std::string_view)>& is_ours);

/// One export, for its report.
struct ExportReport {
  std::string control;  ///< "LinuxCNC"
  const ExportWork& work;
  const controllers::ControllerExport& made;
  const std::vector<controllers::ResidualRow>& residuals;
  std::vector<WrittenFile> written;  ///< empty: nothing was written
  std::string output_hint;           ///< how to have it written
};

[[nodiscard]] Cell export_cell(const ExportReport& report);

/// All paths in JSON; "written: a.comp" or "replaced: a.comp" in the text, a line each.
[[nodiscard]] Cell written_files_cell(const std::vector<WrittenFile>& files);
/// Paths that held something before; not shown.
[[nodiscard]] Cell replaced_files_cell(const std::vector<WrittenFile>& files);

}  // namespace ecs::commissioning
