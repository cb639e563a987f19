#include "commissioning/maps/machine_map.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/cli/action.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/unit/transfer.hpp"
#include "model/fit/fit.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
namespace {

/// From the first to the last position of any table of the axis.
std::optional<std::array<double, 2>> extent_of(const laser::ErrorMap& map, Axis axis) {
  std::optional<std::array<double, 2>> extent;
  for (const laser::MapTable& table : map.tables) {
    if (moving_axis(table.component) != axis || table.position_mm.empty()) continue;
    if (!extent) extent = {table.position_mm.front(), table.position_mm.back()};
    (*extent)[0] = std::min((*extent)[0], table.position_mm.front());
    (*extent)[1] = std::max((*extent)[1], table.position_mm.back());
  }
  if (extent && (*extent)[0] == (*extent)[1]) return std::nullopt;
  return extent;
}

/// What the map alone tells: its configuration, its axes.
UnitParameters parameters_of(const laser::ErrorMap& map, std::vector<std::string>& notes) {
  UnitParameters parameters;
  const std::string& configuration = map.header.configuration;
  if (chain_of(configuration) && configuration.size() < parameters.configuration.size()) {
    parameters.configuration.fill(0);
    std::copy(configuration.begin(), configuration.end(), parameters.configuration.begin());
  }
  const auto chain = chain_of(configuration_of(parameters));
  for (const Axis axis : kAllAxes)
    parameters.axis_present[index_of(axis)] = chain->has(axis) && extent_of(map, axis).has_value();
  notes.push_back(
      "without --params: squareness is taken as 0, reference positions and measurement lines are at the machine zero");
  return parameters;
}

struct Found {
  UnitParameters parameters;
  params::Identity identity;
};
Result<Found> parameters_for(const ExportArguments& arguments, const FoundMap& found,
                             const std::optional<params::Machine>& machine, ExportWork& work) {
  if (!arguments.params.empty()) {
    ECS_TRY(file, params::read_parameters(arguments.params));
    work.inputs.push_back(arguments.params);
    return Found{file.parameters, file.identity};
  }
  if (found.parameters) return Found{*found.parameters, {}};
  if (machine) {
    work.notes.push_back("without --params: squareness is taken as 0");
    return Found{params::default_parameters_for(*machine), {}};
  }
  return Found{parameters_of(found.map, work.notes), {}};
}

Result<void> check_configuration(const laser::MapHeader& header, const UnitParameters& parameters,
                                 const std::string& map_name) {
  const std::string_view configuration = configuration_of(parameters);
  if (header.configuration.empty() || header.configuration == configuration) return {};
  Problem why{ProblemKind::refused,
              fmt::format("the map was made for {}, the parameters say {}: lever arms would have other signs",
                          header.configuration, configuration),
              map_name,
              0,
              0,
              {}};
  return tl::unexpected(std::move(why));
}

/// Whose map it is, against the parameters, or against the machine file where there are none.
std::vector<std::string> objections_to_owner(const laser::MapHeader& header, const Found& with,
                                             const ExportArguments& arguments,
                                             const std::optional<params::Machine>& machine) {
  std::vector<std::string> objections = other_machine(header, with.identity);
  if (arguments.params.empty() && !arguments.unit && machine && !header.machine.empty() && !machine->name.empty() &&
      header.machine != machine->name)
    objections.push_back(fmt::format(
        "the map was made for machine \"{}\", {} is of \"{}\": use the right file, or give --other-machine to confirm",
        header.machine, arguments.machine, machine->name));
  return objections;
}

}  // namespace

cli::Fields<ExportArguments> ExportArguments::fields(const std::string& output_help) {
  using A = ExportArguments;
  return {
      {"FILE", &A::map, "map CSV; or give --unit"},
      {"--unit", &A::unit, "use the map in the unit, with its parameters"},
      {"--params", &A::params, "parameters of the map: squareness, reference positions, measurement lines"},
      {"--machine", &A::machine, "machine file with the travels of the axes"},
      {"--model", &A::model, "predict the remaining error from this model instead of from the map; needs --machine"},
      {"--other-machine", &A::other_machine, "export even if map and parameters name different machines"},
      {"-o,--output", &A::output, output_help},
      {"--force", &A::force, "overwrite existing output files"}};
}

Result<ExportWork> export_work(MessageSink& messages, const ExportArguments& arguments, FoundMap found) {
  ECS_TRY(machine, machine_in(messages, arguments.machine));
  ExportWork work;
  ECS_TRY(with, parameters_for(arguments, found, machine, work));
  work.source.parameters = with.parameters;
  work.map_name = found.name;
  work.errors_from = arguments.model.empty() ? "the map" : arguments.model;
  ECS_DO(check_configuration(found.map.header, with.parameters, found.name));
  if (!arguments.other_machine)
    if (const auto why = refused_map(objections_to_owner(found.map.header, with, arguments, machine), found.name))
      return tl::unexpected(*why);
  work.source.map = std::move(found.map);
  work.source.travel_mm = travels_for(work.source.map, with.parameters, machine);
  if (auto left = laser::squareness_left_behind(work.source.map.header, work.source.parameters))
    work.notes.push_back(std::move(*left));
  for (const std::string& input : {arguments.map, arguments.machine, arguments.model})
    if (!input.empty()) work.inputs.push_back(input);
  return work;
}

std::vector<std::string> left_to_machine(const laser::MapHeader& header) {
  std::vector<std::string> notes;
  if (!header.thermal.empty())
    notes.push_back(fmt::format("{} {} of the map {} not exported: the tables of a control have no place for such rows",
                                header.thermal.size(), header.thermal.size() == 1 ? "thermal row" : "thermal rows",
                                header.thermal.size() == 1 ? "is" : "are"));
  if (!header.rotary.empty())
    notes.push_back(
        fmt::format("the errors of the rotary axes of the map ({}) are neither exported nor included in the predicted "
                    "error: they remain uncorrected",
                    header.rotary_configuration));
  return notes;
}

PerAxis<std::optional<std::array<double, 2>>> travels_for(const laser::ErrorMap& map, const UnitParameters& parameters,
                                                          const std::optional<params::Machine>& machine) {
  PerAxis<std::optional<std::array<double, 2>>> travel_mm{};
  for (const Axis axis : kAllAxes) {
    if (!parameters.axis_present[index_of(axis)]) continue;
    const bool known = machine && machine->axes[index_of(axis)];
    travel_mm[index_of(axis)] = known ? machine->axes[index_of(axis)]->travel_mm : extent_of(map, axis);
  }
  return travel_mm;
}

ErrorsAt errors_of_model(model::Model model, params::Machine machine, std::string file) {
  return [model = std::move(model), machine = std::move(machine),
          file = std::move(file)](const std::vector<MachinePlace>& places) -> Result<std::vector<Vector3>> {
    laser::MeasurementSet set;
    const auto exists = [&](Axis axis) { return machine.axes[index_of(axis)].has_value(); };
    for (const MachinePlace& place : places)
      for (const Axis direction : kAllAxes) {  // each direction as its own axis arrived there
        laser::Reading reading;
        reading.axis = exists(direction) ? direction : *std::find_if(kAllAxes.begin(), kAllAxes.end(), exists);
        reading.sense = static_cast<Sense>(direction);
        reading.position_mm = place.position_mm;
        reading.approach = place.approach[index_of(direction)];
        reading.row = static_cast<int>(set.readings.size()) + 1;
        set.readings.push_back(reading);
      }
    const model::Observations at = model::observations_of(set, model, machine);
    ECS_TRY(values, in_file(model::predicted(model, at), file));
    std::vector<Vector3> errors(places.size());
    for (std::size_t k = 0; k < at.size(); ++k) {
      const auto row = static_cast<std::size_t>(at.row[k] - 1);
      errors[row / kAxes][row % kAxes] = (values)[k];
    }
    return errors;
  };
}

}  // namespace ecs::commissioning
