// `ecs lengths plan`: which lengths to measure for a wanted uncertainty of the volume, in the fewest minutes.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/lengths/work.hpp"
#include "commissioning/measurements/files.hpp"
#include "model/lengths/plan_lengths.hpp"

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
};

/// "0,0,0;0,0,-250"
Result<std::vector<Vector3>> places_in(const std::string& text, std::string_view option) {
  std::vector<Vector3> out;
  if (text.empty()) return out;
  for (const std::string_view part : split(text, ';')) {
    const auto words = split(part, ',');
    Vector3 place{};
    bool right = words.size() == kAxes;
    for (std::size_t a = 0; a < kAxes && right; ++a) {
      const auto number = number_in(trimmed(words[a]));
      right = number.has_value();
      place[a] = number.value_or(0.0);
    }
    if (!right)
      return problem(ProblemKind::usage,
                     fmt::format("{}: expected X,Y,Z;X,Y,Z in mm, such as 0,0,0;0,0,-250, got \"{}\"", option, text));
    out.push_back(place);
  }
  return out;
}

Result<model::LengthPlanSettings> settings_of(const LengthsPlanArguments& a) {
  model::LengthPlanSettings s;
  s.volume_U_um = a.volume;
  s.instrument = a.instrument == "tracker"          ? model::LengthInstrument::tracker
                 : a.instrument == "interferometer" ? model::LengthInstrument::interferometer
                                                    : model::LengthInstrument::ball_bar;
  const auto knots = three_lengths_in(a.knots, "--knots");
  if (!knots) return tl::unexpected(knots.error());
  s.knots_mm = *knots;
  const auto tools = places_in(a.tools, "--tools");
  if (!tools) return tl::unexpected(tools.error());
  if (!tools->empty()) s.tools_mm = *tools;
  const auto stations = places_in(a.stations, "--stations");
  if (!stations) return tl::unexpected(stations.error());
  s.stations_mm = *stations;
  s.reversal_degree = a.reversal;
  s.instrument_um = a.instrument_um;
  s.scatter_um = a.scatter_um;
  s.scatter_um_per_m = a.scatter_angle;
  s.scale_um_per_m = a.scale;
  s.ball_bar_mm = a.ball_bar;
  s.bar_um = a.bar_um;
  s.bar_lowest_deg = a.bar_lowest;
  s.targets_an_interval = a.density;
  s.feed_mm_min = a.feed;
  s.dwell_s = a.dwell;
  s.times.line_minutes = s.times.align_minutes = a.set_up;
  s.tool_minutes = a.tool;
  return s;
}

Cell single_cell(const model::SingleSetUps& single, double U_um, double minutes) {
  return record_cell(
      "single set-ups for {wanted} um: {set_ups} of {runs} runs of {targets} targets{not_reached}, {minutes} minutes; "
      "ratio {ratio}\n",
      {{"wanted", shown_cell(number_cell(U_um, 3).text)},
       {"set_ups", integer_cell(single.set_ups)},
       {"runs", integer_cell(single.runs)},
       {"targets", integer_cell(single.targets)},
       {"minutes", number_cell(single.minutes, 1)},
       {"volume_U_um", number_cell(single.volume_U_um, 3)},
       {"reached", yes_cell(single.reached, "", "")},
       {"ratio", number_cell(minutes / single.minutes, 3)},
       {"not_reached", shown_cell(single.reached ? "" : " (not reached)")}});
}

Cell plan_cell(const model::LengthPlan& plan, const LengthsPlanArguments& a) {
  const auto set_up = [&](const model::LengthSetUp& one) {
    return record_cell(
        "  {name}: {instrument} {place}\n",
        {{"name", word_cell(one.name)},
         {"instrument", word_cell(word_of(one.instrument))},
         {"place",
          {Json(one.place), fmt::format("{:.6g}, {:.6g}, {:.6g}", one.place[0], one.place[1], one.place[2])}}});
  };
  return record_cell(
      "{reached_text}: U = {volume_U_um} um over the volume and the tools (wanted {wanted_U_um}), {first_tool_U_um} um "
      "with the first tool\n"
      "{minutes} minutes, {set_up_minutes} of them set-ups: {set_ups} set-ups, {paths} paths, {readings} poses\n"
      "{stations}{notes}{single}  with the first tool alone: {single_first_tool}{plan}",
      {{"reached_text", shown_cell(plan.reached ? "reached" : "NOT REACHED with three runs of every path")},
       {"reached", yes_cell(plan.reached, "", "")},
       {"wanted_U_um", number_cell(a.volume, 3)},
       {"volume_U_um", number_cell(plan.volume_U_um, 3)},
       {"first_tool_U_um", number_cell(plan.first_tool_U_um, 3)},
       {"minutes", number_cell(plan.minutes, 1)},
       {"set_up_minutes", number_cell(plan.set_up_minutes, 1)},
       {"set_ups", count_cell(plan.set_ups)},
       {"paths", count_cell(plan.paths)},
       {"readings", count_cell(plan.test.readings.size())},
       {"stations", list_cell(plan.test.set_ups, set_up)},
       {"not_determined", {Json(plan.undetermined), {}}},
       {"notes", lines_cell(plan.notes, "note: ")},
       {"single", single_cell(plan.single, plan.volume_U_um, plan.minutes)},
       {"single_first_tool", single_cell(plan.single_first_tool, plan.first_tool_U_um, plan.minutes)},
       {"plan", written_cell("plan", a.output, "plan not written: give -o plan.csv\n")}});
}

Result<Outcome> plan_the_lengths(VerbContext&, const LengthsPlanArguments& a) {
  if (const auto distinct = check_output_not_input(a.output, {a.machine}); !distinct)
    return tl::unexpected(distinct.error());
  const auto machine = params::read_machine(a.machine);
  if (!machine) return tl::unexpected(machine.error());
  const auto settings = settings_of(a);
  if (!settings) return tl::unexpected(settings.error());
  const auto plan = model::planned_lengths(machine->machine, *settings);
  if (!plan) return tl::unexpected(plan.error());
  if (!a.output.empty())
    if (auto done = write_file(a.output, model::to_csv(plan->test, true)); !done) return tl::unexpected(done.error());
  return outcome_of(plan_cell(*plan, a), plan->reached ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kLengthsPlan = verb<LengthsPlanArguments>(
    "lengths plan", "the lengths with the fewest minutes for a wanted uncertainty of the volume, beside single set-ups",
    "ecs lengths plan --machine machine.toml --volume-um 2 -o plan.csv", plan_the_lengths);

}  // namespace ecs::app
