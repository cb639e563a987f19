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

Result<model::LengthPlan> lengths_plan(const LengthsPlanAsked& asked, const std::function<bool()>& stopped) {
  ECS_TRY(machine, params::read_machine(asked.machine));
  ECS_TRY(settings, settings_of(asked));
  settings.stopped = stopped;
  auto plan = model::planned_lengths(machine.machine, settings);
  if (plan && stopped && stopped()) return problem(ProblemKind::refused, "stopped: there is no plan");
  return plan;
}

}  // namespace ecs::commissioning
