// `ecs volume`: the error vector over the working volume, before and after compensation, with its uncertainty.

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/volume/view.hpp"
#include "commissioning/volume/work.hpp"

namespace ecs::app {
namespace {

Result<Outcome> volume_verb(VerbContext& context, const VolumeArguments& request) {
  ECS_TRY(work, volume_work(context.console, request));
  for (const std::string& output : {request.picture, request.values})
    ECS_DO(check_output_not_input(output, work.inputs));
  if (!request.picture.empty()) {
    ECS_DO(plot_format_of(request.picture));
    ECS_TRY(figure, volume_figure(work));
    ECS_DO(write_plot(request.picture, figure));
  }
  if (!request.values.empty()) ECS_DO(write_file(request.values, values_csv(work)));
  return outcome_of(volume_cell(work, request.picture, request.values));
}

}  // namespace

extern const std::vector<Action> kVolume{action(
    "volume", "compute the error anywhere in the working volume, before and after compensation, with its uncertainty",
    "ecs volume map.csv --params parameters.toml -o volume.svg\n"
    "  ecs volume map.csv --params parameters.toml --at -1000,-200,-350 --tool-length 250\n"
    "  ecs volume map.csv --params parameters.toml --machine five_axes.toml --rotary rotary.csv",
    volume_verb)};

}  // namespace ecs::app
