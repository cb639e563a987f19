// `ecs lengths plan`: which lengths to measure for a wanted uncertainty of the volume, in the fewest minutes.
#include "commissioning/lengths/plan.hpp"

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/lengths/view.hpp"
#include "commissioning/measurements/files.hpp"

namespace ecs::app {
namespace {

struct LengthsPlanArguments : VerbArguments {
  const std::string& machine = text("--machine", "machine file: chain, travels, datum", Need::required);
  const double& volume = number("--volume-um",
                                "wanted expanded uncertainty (k = 2) of the error vector, root mean "
                                "square over the volume and the tools [um]",
                                0.0, Need::required, 0.01, 1e6);
  const std::string& instrument =
      choice("--instrument", {"tracker", "interferometer", "ball_bar"}, "what measures", Need::optional, "tracker");
  const std::string& output = output_file("-o,--output", "the plan (.csv): for `ecs-emulator lengths`, or by hand");
  const std::string& tools = text("--tools", "offsets of the reflector: 0,0,0;0,0,-250;150,0,-120 [mm]", Need::optional,
                                  "0,0,0;0,0,-250;150,0,-120");
  const std::string& stations = text("--stations",
                                     "where the instrument may stand: -250,-200,-750;1450,800,-700 [mm]; "
                                     "by default around the volume, of a ball bar within it");
  const std::string& knots =
      text("--knots", "spacing of the curves' knots X,Y,Z [mm]; default: a twelfth of the travel");
  const int& reversal = integer("--reversal-degree", "of the reversal error as a polynomial", 1, 0, 6);
  const double& instrument_um =
      number("--instrument-um", "of a reading, standard deviation [um]", 0.2, Need::optional, 0.001);
  const double& scatter_um =
      number("--scatter-um", "of a stop of the machine, each axis and direction [um]", 1.0, Need::optional, 0.0);
  const double& scatter_angle = number("--scatter-um-per-m", "the same of its angles [um/m]", 0.5, Need::optional, 0.0);
  const double& scale = number("--scale", "of each set-up, standard uncertainty [um/m]", 0.1, Need::optional, 0.0);
  const double& ball_bar = number("--ball-bar-mm", "reach of a ball bar: its radius [mm]", 150.0, Need::optional, 1.0);
  const double& bar_um =
      number("--bar-um", "of a ball bar's length, standard uncertainty [um]; 0: not known", 1.0, Need::optional, 0.0);
  const double& bar_lowest = number("--bar-lowest-deg", "elevation below which the post of the ball is in the way",
                                    -20.0, Need::optional, -90.0, 0.0);
  const double& density =
      number("--targets", "of a line, between two knots (and four more)", 1.0, Need::optional, 0.1, 10.0);
  const double& feed = number("--feed", "between targets [mm/min]", 2000.0, Need::optional, 1.0);
  const double& dwell = number("--dwell", "before each reading [s]", 2.0, Need::optional, 0.0);
  const double& set_up = number("--set-up-minutes", "instrument to another station or line",
                                model::MeasuringTimes{}.line_minutes, Need::optional, 0.0);
  const double& tool = number("--tool-minutes", "another tool at the same station", 5.0, Need::optional, 0.0);

  [[nodiscard]] LengthsPlanAsked asked() const {
    return {machine,       volume,     instrument,    tools,  stations, knots,  reversal,
            instrument_um, scatter_um, scatter_angle, scale,  ball_bar, bar_um, bar_lowest,
            density,       feed,       dwell,         set_up, tool};
  }
};

Result<Outcome> plan_the_lengths(VerbContext&, const LengthsPlanArguments& a) {
  ECS_DO(check_output_not_input(a.output, {a.machine}));
  ECS_TRY(plan, lengths_plan(a.asked()));
  if (!a.output.empty()) ECS_DO(write_file(a.output, model::to_csv(plan.test, true)));
  return outcome_of(lengths_plan_cell(plan, a.volume, a.output), plan.reached ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kLengthsPlan = verb<LengthsPlanArguments>(
    "lengths plan", "the lengths with the fewest minutes for a wanted uncertainty of the volume, beside single set-ups",
    "ecs lengths plan --machine machine.toml --volume-um 2 -o plan.csv", plan_the_lengths);

}  // namespace ecs::app
