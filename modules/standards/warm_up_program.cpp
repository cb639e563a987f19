// `ecs test warm-up-program`: a part program that warms a machine by moving every axis over its travel (thesis 1.3,
// 6.3.2), for a stated time or for the time that a warm-up test found. In the dialect of thesis appendix B.
// Does not live here: the warm-up test (warm_up.hpp), programs that measure (model/planning/part_program.cpp).
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/measurements/files.hpp"
#include "modules/standards/warm_up.hpp"
#include "params/machine.hpp"

namespace ecs::app {
namespace {

constexpr double kMinutesPerHour = 60.0;
constexpr double kMostMinutes = 24.0 * 60.0;
constexpr double kMostCycles = 10'000'000.0;  ///< of a $REP (docs/unit.md)

struct WarmUpProgramRequest {
  std::string machine, readings, output;
  double feed_mm_min = 0.0, margin_mm = 5.0, window_h = 1.0, to_come_percent = 5.0;
  std::optional<double> minutes, spindle_rpm;
  bool together = false;
  ImportArguments import;
  static Fields<WarmUpProgramRequest> fields() {
    using R = WarmUpProgramRequest;
    return {
        {"--machine", &R::machine, "machine file: axes and travels", Need::required},
        {"--feed", &R::feed_mm_min, "feed of the motion [mm/min]", Need::required, Range{1.0, 1e6}},
        {"--minutes", &R::minutes, "duration of the program [min]", Range{0.1, kMostMinutes}},
        {"--readings", &R::readings, "warm-up test that gives the duration, in place of --minutes"},
        {"--to-come", &R::to_come_percent, "part of the warm-up that may remain afterwards [%]", Range{0.1, 90.0}},
        {"--window", &R::window_h, "length of the periods at the start and end of --readings that are compared [h]",
         Range{1e-3, 1e3}},
        {"--together", &R::together, "all axes move at once along the diagonal; default: one after the other"},
        {"--margin", &R::margin_mm, "distance kept from both ends of each travel [mm]", Range{0.0, 1e4}},
        {"--spindle", &R::spindle_rpm, "spindle speed during the program [rpm]; default: spindle off", Range{1.0, 1e6}},
        {"-o,--output", &R::output, "part program to write (.nc)", Is::output},
        &R::import};
  }
};

/// An axis as the program moves it.
struct WarmedAxis {
  Axis axis = Axis::X;
  double from_mm = 0.0, to_mm = 0.0;
  double duty = 0.0;          ///< part of the time in which it moves
  double speed_mm_min = 0.0;  ///< while it moves
  [[nodiscard]] double stroke_mm() const { return to_mm - from_mm; }
};

struct WarmUpPlan {
  std::vector<WarmedAxis> axes;
  double cycle_min = 0.0;
  int cycles = 0;
  [[nodiscard]] double minutes() const { return cycle_min * cycles; }
};

/// The longest time in which the exponential of a curve or difference comes near enough to its end.
Result<double> minutes_of(VerbContext& context, const WarmUpProgramRequest& request) {
  ECS_TRY(imported, read_with_notes(context.console, request.readings, request.import));
  ECS_TRY(test, laser::warm_up_test_of(imported.set, request.window_h));
  double longest_h = 0.0;
  const auto take = [&](const laser::WarmUpCurve& curve) {
    if (curve.settling) longest_h = std::max(longest_h, curve.settling->time_constant_h);
  };
  for (const laser::WarmUpCurve& curve : test.curves) take(curve);
  for (const laser::WarmUpDifference& difference : test.differences) take(difference.curve);
  if (longest_h == 0.0)
    return problem_at(request.readings, 0, 0,
                      "expected a curve that settles exponentially, found none: give --minutes, or test for longer");
  return longest_h * std::log(100.0 / request.to_come_percent) * kMinutesPerHour;
}

Result<WarmUpPlan> plan_of(const params::Machine& machine, const WarmUpProgramRequest& request, double minutes) {
  WarmUpPlan plan;
  double sum_mm = 0.0, squares = 0.0;
  for (const Axis axis : kAllAxes) {
    const auto& facts = machine.axes[index_of(axis)];
    if (!facts) continue;
    const WarmedAxis one{axis, facts->travel_mm[0] + request.margin_mm, facts->travel_mm[1] - request.margin_mm};
    if (!(one.stroke_mm() > 0.0))
      return problem(ProblemKind::usage,
                     "--margin: {:g} mm at both ends leave nothing of the travel of {}, {:g} to {:g} mm",
                     request.margin_mm, letter_of(axis), facts->travel_mm[0], facts->travel_mm[1]);
    sum_mm += one.stroke_mm();
    squares += one.stroke_mm() * one.stroke_mm();
    plan.axes.push_back(one);
  }
  if (plan.axes.empty())
    return problem_at(request.machine, 0, 0, "expected an axis with travel_mm, found none: no motion would be safe");
  const double path_mm = request.together ? std::sqrt(squares) : sum_mm;
  plan.cycle_min = 2.0 * path_mm / request.feed_mm_min;
  const double cycles = std::ceil(minutes / plan.cycle_min);
  if (cycles > kMostCycles)
    return problem(ProblemKind::usage, "--feed, --minutes: {:g} cycles, more than a program may repeat ({:g})", cycles,
                   kMostCycles);
  plan.cycles = std::max(1, static_cast<int>(cycles));
  for (WarmedAxis& one : plan.axes) {
    one.duty = request.together ? 1.0 : one.stroke_mm() / path_mm;
    one.speed_mm_min = request.together ? request.feed_mm_min * one.stroke_mm() / path_mm : request.feed_mm_min;
  }
  return plan;
}

std::string word(Axis axis, double mm) { return fmt::format("{}{:.3f}", letter_of(axis), mm == 0.0 ? 0.0 : mm); }

std::string program_text(const WarmUpPlan& plan, const params::Machine& machine, const WarmUpProgramRequest& request) {
  std::string text = fmt::format("; warm-up cycle{}: {:.1f} min, {} cycles of {:.1f} s\n",
                                 machine.name.empty() ? "" : " of " + machine.name, plan.minutes(), plan.cycles,
                                 60.0 * plan.cycle_min);
  for (const WarmedAxis& one : plan.axes)
    text += fmt::format("; {}: {:g} to {:g} mm at {:.0f} mm/min, moves {:.0f} % of the time\n", letter_of(one.axis),
                        one.from_mm, one.to_mm, one.speed_mm_min, 100.0 * one.duty);
  text += "; every block begins with >; $REP n ... $END is a loop: translate these words for another control\n";
  text += "; check that tool, workpiece and optics clear every motion before starting\n";
  if (request.spindle_rpm) text += fmt::format("> M03S{:g}\n", *request.spindle_rpm);
  for (const WarmedAxis& one : plan.axes)
    text += fmt::format("> G90G01{}F{:g}\n", word(one.axis, one.from_mm), request.feed_mm_min);
  text += fmt::format("$REP {}\n", plan.cycles);
  std::string there = "> ", back = "> ";
  for (const WarmedAxis& one : plan.axes) {
    there += word(one.axis, one.to_mm);
    back += word(one.axis, one.from_mm);
    if (!request.together) {
      text += fmt::format("{}\n{}\n", there, back);
      there = back = "> ";
    }
  }
  if (request.together) text += fmt::format("{}\n{}\n", there, back);
  return text + "$END\n" + (request.spindle_rpm ? "> M05\n" : "") + "> M30\n";
}

Cell axis_cell_of(const WarmedAxis& one) {
  return record_cell("  {axis}: {from_mm} to {to_mm} mm at {speed_mm_min} mm/min, moves {percent} % of the time\n",
                     "axis"_is(std::string(1, letter_of(one.axis))),
                     "from_mm"_is(one.from_mm, fmt::format("{:g}", one.from_mm)),
                     "to_mm"_is(one.to_mm, fmt::format("{:g}", one.to_mm)), "speed_mm_min"_is(one.speed_mm_min, 0),
                     "duty"_is(one.duty), "percent"_shown(fmt::format("{:.0f}", 100.0 * one.duty)));
}

Result<Outcome> warm_up_program(VerbContext& context, const WarmUpProgramRequest& request) {
  if (request.minutes.has_value() != request.readings.empty())
    return problem(ProblemKind::usage, "expected --minutes or --readings, and not both");
  ECS_DO(check_output_not_input(request.output, {request.machine, request.readings}));
  ECS_TRY(machine, params::read_machine(request.machine));
  double minutes = request.minutes.value_or(0.0);
  if (!request.minutes) {
    ECS_TRY(found, minutes_of(context, request));
    minutes = found;
  }
  ECS_TRY(plan, plan_of(machine.machine, request, minutes));
  const std::string program = program_text(plan, machine.machine, request);
  if (!request.output.empty()) ECS_DO(write_file(request.output, program));
  std::vector<std::string> notes;
  if (!machine.machine.rotary_configuration.empty()) notes.push_back("the rotary axes do not move in this program");
  return outcome_of(
      record_cell("{shown} min: {cycles} cycles of {cycle} s, acceleration not counted\n{of}{axes}{notes}{output}",
                  "minutes"_is(plan.minutes()), "shown"_shown(fmt::format("{:.1f}", plan.minutes())),
                  "of"_shown(request.readings.empty()
                                 ? std::string()
                                 : fmt::format("  afterwards, {:g} % of the warm-up measured in {} is still to come\n",
                                               request.to_come_percent, request.readings)),
                  "cycles"_is(plan.cycles), "cycle_s"_is(60.0 * plan.cycle_min),
                  "cycle"_shown(fmt::format("{:.1f}", 60.0 * plan.cycle_min)),
                  "axes"_is(list_cell(plan.axes, axis_cell_of)), "notes"_is(lines_cell(notes, "note: ")),
                  "program"_is(Json(program)), "output"_is(written_cell("program", request.output, program))));
}

}  // namespace

extern const std::vector<Action> kWarmUpProgram{
    action("test warm-up-program", "write a part program that warms the machine by moving every axis over its travel",
           "ecs test warm-up-program --machine machine.toml --feed 6000 --minutes 60 -o warm_up.nc\n  ecs test "
           "warm-up-program --machine machine.toml --feed 6000 --readings warm_up.csv --to-come 5",
           warm_up_program)};

}  // namespace ecs::app
