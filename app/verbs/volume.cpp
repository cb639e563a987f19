// `ecs volume`: the error vector over the working volume, before and after compensation, with its uncertainty.
#include <optional>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/volume/figures.hpp"
#include "commissioning/volume/view.hpp"
#include "commissioning/volume/work.hpp"

namespace ecs::app {
namespace {

constexpr volume::UncertaintySettings kUsual{};

struct VolumeOptions : VerbArguments {
  const std::string& map = text("MAP", "error map (.csv)", Need::required);
  const std::string& params = text("--params", "parameters that the map goes with", Need::required);
  const std::string& errors =
      text("--errors", "true errors of an emulated machine (errors file of ecs-emulator) in place of the map's");
  const std::string& model = text("--model", "a fitted error model in place of the map's errors; needs the machine");
  const std::string& machine =
      text("--machine", "machine file: travels, datum; by default machine.toml beside the parameters");
  const bool& other_machine = flag("--other-machine", "although map and parameters name different machines");
  const int& points = integer("--points", "places in the volume, at most", static_cast<int>(kUsualPlaces), 8,
                              static_cast<int>(volume::kMostPlaces));
  const std::optional<double>& tool_length =
      optional_number("--tool-length",
                      "along -Z from the point at which the curves were measured [mm]; the unit "
                      "compensates for the tool of its parameters");
  const std::string& tool_offset = text("--tool-offset", "the same along X, Y, Z: 0,0,-250");
  const std::string& rotary =
      text("--rotary", "errors of the rotary axes of the machine file (.csv: component, approach, p_deg, error)");
  const std::string& at = text("--at", "one place as well: -1000,-200,-350; with rotary axes angles behind it");
  const std::string& slice =
      choice("--slice", {"XY", "XZ", "YZ"}, "the error in a plane through the place of the largest, as numbers");
  const bool& between =
      flag("--between", "the largest error between the places as well, on lines along each axis through the largest");
  const std::string& output = output_file("-o,--output", "picture (.svg or .png)");
  const std::string& values = output_file("--values", "CSV of every value of the map with its standard uncertainty");
  const std::optional<double>& repeatability =
      optional_number("--repeatability",
                      "standard uncertainty of every map value [um, um/m]; by default as the header "
                      "states, else from the roughness of each table");
  const double& instrument = number("--instrument", "of positioning, standard uncertainty [um/m]",
                                    kUsual.instrument_um_per_m, Need::optional, 0.0);
  const double& temperature = number("--temperature", "of the scale while it was measured, standard uncertainty [degC]",
                                     kUsual.temperature_degC, Need::optional, 0.0);
  const double& expansion = number("--expansion", "that makes a length of it [um/m/degC]",
                                   kUsual.expansion_um_per_m_degC, Need::optional, 0.0);
  const double& zero = number("--zero-uncertainty", "of a component declared zero, standard [um, um/m]",
                              kUsual.declared_zero, Need::optional, 0.0);
  const double& square = number("--square-uncertainty", "of the squareness reference, standard [um/m]",
                                kUsual.squareness_um_per_m, Need::optional, 0.0);
  const int& draws = integer("--draws", "maps drawn for the 95 % bound", static_cast<int>(kUsual.draws), 20, 100'000);
  const int& seed = integer("--seed", "of the draws", static_cast<int>(kUsual.seed), 0, 1'000'000'000);

  [[nodiscard]] VolumeArguments arguments() const {
    VolumeArguments a{map,         params,      errors, model, machine, other_machine, static_cast<std::size_t>(points),
                      tool_length, tool_offset, rotary, at,    slice,   between,       {}};
    a.settings = {repeatability,
                  instrument,
                  temperature,
                  expansion,
                  zero,
                  square,
                  static_cast<std::size_t>(draws),
                  static_cast<std::uint64_t>(seed)};
    return a;
  }
};

Result<Outcome> volume_verb(VerbContext& context, const VolumeOptions& options) {
  ECS_TRY(work, volume_work(context.console, options.arguments()));
  for (const std::string& output : {options.output, options.values})
    ECS_DO(check_output_not_input(output, work.inputs));
  if (!options.output.empty()) {
    ECS_DO(plot_format_of(options.output));
    ECS_TRY(figure, volume_figure(work));
    ECS_DO(write_plot(options.output, figure));
  }
  if (!options.values.empty()) ECS_DO(write_file(options.values, values_csv(work)));
  return outcome_of(volume_cell(work, options.output, options.values));
}

}  // namespace

extern const VerbDefinition kVolume = verb<VolumeOptions>(
    "volume", "the error anywhere in the working volume, before and after compensation, and how certain it is",
    "ecs volume map.csv --params parameters.toml -o volume.svg\n"
    "  ecs volume map.csv --params parameters.toml --at -1000,-200,-350 --tool-length 250\n"
    "  ecs volume map.csv --params parameters.toml --machine five_axes.toml --rotary rotary.csv",
    volume_verb);

}  // namespace ecs::app
