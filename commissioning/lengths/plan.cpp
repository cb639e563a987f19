#include "commissioning/lengths/plan.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/lengths/work.hpp"

namespace ecs::commissioning {
namespace {

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

Result<model::LengthPlanSettings> settings_of(const LengthsPlanAsked& a) {
  model::LengthPlanSettings s;
  s.volume_U_um = a.volume_um;
  s.instrument = a.instrument == "tracker"          ? model::LengthInstrument::tracker
                 : a.instrument == "interferometer" ? model::LengthInstrument::interferometer
                                                    : model::LengthInstrument::ball_bar;
  ECS_TRY(knots, three_lengths_in(a.knots, "--knots"));
  s.knots_mm = knots;
  ECS_TRY(tools, places_in(a.tools, "--tools"));
  if (!tools.empty()) s.tools_mm = tools;
  ECS_TRY(stations, places_in(a.stations, "--stations"));
  s.stations_mm = stations;
  s.reversal_degree = a.reversal_degree;
  s.instrument_um = a.instrument_um;
  s.scatter_um = a.scatter_um;
  s.scatter_um_per_m = a.scatter_um_per_m;
  s.scale_um_per_m = a.scale_um_per_m;
  s.ball_bar_mm = a.ball_bar_mm;
  s.bar_um = a.bar_um;
  s.bar_lowest_deg = a.bar_lowest_deg;
  s.targets_an_interval = a.targets_an_interval;
  s.feed_mm_min = a.feed_mm_min;
  s.dwell_s = a.dwell_s;
  s.times.line_minutes = s.times.align_minutes = a.set_up_minutes;
  s.tool_minutes = a.tool_minutes;
  return s;
}

}  // namespace

cli::Fields<LengthsPlanAsked> LengthsPlanAsked::fields() {
  using A = LengthsPlanAsked;
  using cli::Is, cli::Need, cli::Range, cli::Words;
  return {{"--machine", &A::machine, "machine file: chain, travels, datum", Need::required},
          {"--volume-um", &A::volume_um,
           "wanted expanded uncertainty (k = 2) of the error vector, root mean "
           "square over the volume and the tools [um]",
           Need::required, Range{0.01, 1e6}},
          {"--instrument", &A::instrument, "what measures", Words{"tracker", "interferometer", "ball_bar"}},
          {"-o,--output", &A::output, "the plan (.csv): for `ecs-emulator lengths`, or by hand", Is::output},
          {"--tools", &A::tools, "offsets of the reflector: 0,0,0;0,0,-250;150,0,-120 [mm]"},
          {"--stations", &A::stations,
           "where the instrument may stand: -250,-200,-750;1450,800,-700 [mm]; "
           "by default around the volume, of a ball bar within it"},
          {"--knots", &A::knots, "spacing of the curves' knots X,Y,Z [mm]; default: a twelfth of the travel"},
          {"--reversal-degree", &A::reversal_degree, "of the reversal error as a polynomial", Range{0, 6}},
          {"--instrument-um", &A::instrument_um, "of a reading, standard deviation [um]", Range{0.001}},
          {"--scatter-um", &A::scatter_um, "of a stop of the machine, each axis and direction [um]", Range{0.0}},
          {"--scatter-um-per-m", &A::scatter_um_per_m, "the same of its angles [um/m]", Range{0.0}},
          {"--scale", &A::scale_um_per_m, "of each set-up, standard uncertainty [um/m]", Range{0.0}},
          {"--ball-bar-mm", &A::ball_bar_mm, "reach of a ball bar: its radius [mm]", Range{1.0}},
          {"--bar-um", &A::bar_um, "of a ball bar's length, standard uncertainty [um]; 0: not known", Range{0.0}},
          {"--bar-lowest-deg", &A::bar_lowest_deg, "elevation below which the post of the ball is in the way",
           Range{-90.0, 0.0}},
          {"--targets", &A::targets_an_interval, "of a line, between two knots (and four more)", Range{0.1, 10.0}},
          {"--feed", &A::feed_mm_min, "between targets [mm/min]", Range{1.0}},
          {"--dwell", &A::dwell_s, "before each reading [s]", Range{0.0}},
          {"--set-up-minutes", &A::set_up_minutes, "instrument to another station or line", Range{0.0}},
          {"--tool-minutes", &A::tool_minutes, "another tool at the same station", Range{0.0}}};
}

Result<model::LengthPlan> lengths_plan(const LengthsPlanAsked& asked, const std::function<bool()>& stopped) {
  ECS_TRY(machine, params::read_machine(asked.machine));
  ECS_TRY(settings, settings_of(asked));
  settings.stopped = stopped;
  auto plan = model::planned_lengths(machine.machine, settings);
  if (plan && stopped && stopped()) return problem(ProblemKind::refused, "stopped: there is no plan");
  return plan;
}

}  // namespace ecs::commissioning
