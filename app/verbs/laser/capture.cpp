// `ecs laser capture`: guides through the targets of a measurement and takes its readings.
#include "commissioning/measurements/capture.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"

namespace ecs::app {
namespace {

Cell end_cell(const CaptureEnd& end) {
  const auto& readings = end.result.readings;
  std::size_t doubts = 0;
  std::string remarks;
  for (const auto& [key, value] : end.result.metadata) {
    doubts += key == "in doubt" ? 1U : 0U;
    if (key == "left out" || key == "in doubt") remarks += fmt::format("  {}: {}\n", key, value);
  }
  return record_cell(end.complete ? "{readings} readings of {targets} targets written to {output}\n{remarks}"
                                  : "left before the end: {kept}\n",
                     {{"complete", yes_cell(end.complete, "", "")},
                      {"output", text_cell(end.file)},
                      {"part", end.complete || readings.empty() ? null_cell() : Cell{end.part, {}}},
                      {"targets", {end.targets, fmt::format("{}", end.targets)}},
                      {"readings", count_cell(readings.size())},
                      {"left_out", {end.skipped, {}}},
                      {"in_doubt", count_cell(doubts)},
                      {"runs", {end.runs, {}}},
                      {"duration_s", readings.empty() ? null_cell() : Cell{number_or_null(readings.back().time_s), {}}},
                      {"unplugged", {end.unplugged, {}}},
                      {"remarks", shown_cell(remarks)},
                      {"kept", shown_cell(end.kept)}});
}

Result<Outcome> capture_verb(VerbContext& context, const CaptureChoice& choice) {
  ECS_TRY(end, capture(context.console, context.console.keyboard(), choice));
  return outcome_of(end_cell(end), end.complete ? kDone : kDoesNotHold);
}

void take_target_options(Verb& verb, CaptureTargets& arguments) {
  verb.choice("--axis", arguments.axis, {"X", "Y", "Z"}, "the axis that moves")
      .choice("--sense", arguments.sense, {"EX", "EY", "EZ", "EA", "EB", "EC"}, "what is measured")
      .number("--from", arguments.from_mm, "first target [mm]")
      .number("--to", arguments.to_mm, "last target [mm]")
      .number("--step", arguments.step_mm, "from target to target [mm]")
      .flag("--moved", arguments.moved, "targets off equal steps, as ISO 230-2 asks: no period hides behind the step")
      .integer("--runs", arguments.runs, "forward and back so many times (3)", 0, kMostRuns)
      .flag("--one-way", arguments.one_way, "no readings on the way back")
      .text("--parked", arguments.parked, "positions of the other axes, as in y=-1400,z=0 [mm]")
      .number("--feed", arguments.feed_mm_min, "feed between the targets [mm/min], for the record")
      .text("--targets", arguments.targets, "a target list (CSV), as `ecs model next --targets` writes it")
      .text("--plan", arguments.plan, "plan with [[measure]] rows, as `laser table` reads it")
      .text("--row", arguments.row, "with --plan: the name of the measurement")
      .text("--machine", arguments.machine, "machine file: its name goes into the record")
      .choice("--compensated", arguments.compensated, {"yes", "no"}, "whether the error map is active, for the record")
      .texts("--note", arguments.notes, "KEY=VALUE for the record, as in operator=AB; several");
}

}  // namespace

extern const VerbDefinition kLaserCapture = verb<CaptureChoice>(
    "laser capture", "guides through the targets of a measurement, forward and back, and takes its readings",
    "ecs laser capture --axis X --sense EX --from 0 --to 500 --step 50 --runs 3 -o exx.csv\n"
    "  ecs laser capture --plan plan.toml --row EXX --trigger foot_switch.toml --gauge gauge.toml --environment temper "
    "-o EXX.csv\n"
    "  ecs laser capture --resume EXX.csv.part --trigger foot_switch.toml --gauge gauge.toml",
    [](Verb& verb, CaptureChoice& arguments) {
      verb.output_file("-o,--output", arguments.output,
                       "the measurement CSV to write; OUT.csv.part until it is complete")
          .text("--resume", arguments.resume, "goes on with an unfinished FILE.part");
      take_target_options(verb, arguments.target);
      verb.text("--trigger", arguments.trigger,
                "what takes a reading: DEVICE.toml[@SERIAL], enter, or each (all that come)")
          .text("--gauge", arguments.gauge, "readings from an indicator gauge: DEVICE.toml[@SERIAL]")
          .text("--readings", arguments.readings, "readings from a file or FIFO: each trigger takes the next line")
          .text("--follow", arguments.follow,
                "readings from a file or FIFO that a display writes: the last line counts")
          .text("--display", arguments.display, "readings from a shell command that prints what the display shows")
          .choice("--shows", arguments.shows, {"error", "position"},
                  "what is read: the error, or the position of the axis [mm]")
          .number("--scale", arguments.scale, "times the reading makes um (um/m), or mm of a position (1)")
          .text("--environment", arguments.environment,
                "temper, or DEVICE.toml[@SERIAL]: temperatures into every reading")
          .number("--environment-every", arguments.environment_every_s, "seconds between its values", Need::optional,
                  0.1, 3600.0)
          .number("--min-interval", arguments.min_interval_s,
                  "a trigger sooner after a reading is a doubled one [s] (0.5)")
          .flag("--force", arguments.force, "overwrites an output file that is there");
    },
    capture_verb);

}  // namespace ecs::app
