// A map with all it goes with: the parameters, the travels; where the error of a machine is known from.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/session/message.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::cli {
template <class Request>
class Fields;
}

namespace ecs::commissioning {

/// A place of the machine, and how each axis came there; unknown: it is parked, the mean of both approaches counts.
struct MachinePlace {
  Vector3 position_mm{};
  PerAxis<Approach> approach{Approach::forward, Approach::forward, Approach::forward};
};

/// Errors (actual − target) at places, um.
using ErrorsAt = std::function<Result<std::vector<Vector3>>(const std::vector<MachinePlace>&)>;

/// What an export starts from.
struct ExportSource {
  laser::ErrorMap map;
  UnitParameters parameters;  ///< chain, lines, reference positions, squareness, interpolation
  PerAxis<std::optional<std::array<double, 2>>> travel_mm{};  ///< of the axes that exist; lower end, upper end
};

/// The squareness errors of parameters, by component.
[[nodiscard]] inline std::array<double, kComponents> squareness_of(const UnitParameters& parameters) {
  std::array<double, kComponents> values{};
  for (std::size_t i = kCurves; i < kComponents; ++i)
    values[i] = squareness_um_per_m(parameters, static_cast<Component>(i));
  return values;
}

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
  ExportSource source;
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

/// The parts of a map that no table of a control contains, a sentence each; none if the tables contain all of it.
[[nodiscard]] std::vector<std::string> left_to_machine(const laser::MapHeader& header);

/// The travels of the axes that the parameters name: those of the machine, else as far as the map reaches.
[[nodiscard]] PerAxis<std::optional<std::array<double, 2>>> travels_for(const laser::ErrorMap& map,
                                                                        const UnitParameters& parameters,
                                                                        const std::optional<params::Machine>& machine);

/// The error that a model predicts at places, each direction as its own axis arrived there.
/// @param file  as problems name it
[[nodiscard]] ErrorsAt errors_of_model(model::Model model, params::Machine machine, std::string file);

}  // namespace ecs::commissioning
