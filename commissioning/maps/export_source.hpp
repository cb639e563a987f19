// What every export begins with: a map, the parameters it goes with, the travels, and where the error is known from.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "commissioning/maps/source.hpp"
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

}  // namespace ecs::commissioning
