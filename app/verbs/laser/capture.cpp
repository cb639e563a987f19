// `ecs laser capture`: guides through the targets of a measurement and takes its readings.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/capture_targets.hpp"
#include "base/clock.hpp"
#include "base/interrupt.hpp"
#include "base/json.hpp"
#include "commissioning/measurements/capture_run.hpp"
#include "commissioning/measurements/device_choice.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::app {
namespace {

using devices::DeviceKind;

constexpr std::chrono::milliseconds kCaptureStep{20};
constexpr double kNeverMissed = 1e9;

struct CaptureArguments {
  TargetArguments target;
  std::string output;
  std::string resume;
  std::string trigger;
  std::string gauge;
  std::string readings;
  std::string follow;
  std::string display;
  std::string shows = "error";
  std::optional<double> scale;
  std::string environment;
  double environment_every_s = 5.0;
  std::optional<double> min_interval_s;
  bool force = false;
};

struct Begun {
  devices::CaptureRecord record;
  std::string output;
  std::string part;
  double begun_s = 0.0;
};

/// Seconds since a time that now_utc() wrote; nothing if it is none.
std::optional<double> age_s(const std::string& utc) {
  std::tm parts{};
  const char* end = ::strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  if (end == nullptr || *end != '\0') return std::nullopt;
  return std::difftime(std::time(nullptr), ::timegm(&parts));
}

std::string part_of(const std::string& output) { return output + ".part"; }

bool exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

Result<void> output_is_free(const CaptureArguments& arguments, const std::string& output, const std::string& part) {
  if (exists(part) && arguments.resume.empty())
    return problem(ProblemKind::usage,
                   fmt::format("{} holds an unfinished capture: go on with `ecs laser capture --resume "
                               "{}`, or remove it",
                               part, part));
  if (exists(output) && !arguments.force)
    return problem(ProblemKind::usage,
                   fmt::format("{} is there already: give another -o, or --force to replace it", output));
  const auto folder = std::filesystem::absolute(part).parent_path();
  if (::access(folder.c_str(), W_OK) != 0)
    return problem(ProblemKind::output, fmt::format("{} cannot be written: {} is no folder that you may write into",
                                                    output, folder.string()));
  return {};
}

Result<devices::CaptureRules> rules_of(const CaptureArguments& arguments, bool each) {
  devices::CaptureRules rules;
  rules.shows = arguments.shows == "position" ? devices::Shows::position : devices::Shows::error;
  rules.scale = arguments.scale.value_or(1.0);
  rules.min_interval_s = arguments.min_interval_s.value_or(each ? 0.0 : rules.min_interval_s);
  if (rules.scale == 0.0) return problem(ProblemKind::usage, "--scale: expected a number other than 0");
  if (rules.min_interval_s < 0.0) return problem(ProblemKind::usage, "--min-interval: expected at least 0 s");
  if (each) rules.missed_factor = kNeverMissed;
  return rules;
}

Result<Begun> begun_anew(const CaptureArguments& arguments, bool each) {
  if (arguments.output.empty()) return problem(ProblemKind::usage, "-o OUT.csv is missing: the file for the readings");
  auto plan = capture_plan(arguments.target);
  if (!plan) return tl::unexpected(plan.error());
  const auto rules = rules_of(arguments, each);
  if (!rules) return tl::unexpected(rules.error());
  for (const laser::Reading& stop : plan->stops)
    if (rules->shows == devices::Shows::position && static_cast<int>(stop.sense) != static_cast<int>(stop.axis))
      return problem(ProblemKind::usage, "--shows position is for positioning: EX of X, EY of Y, EZ of Z");
  const std::string part = part_of(arguments.output);
  if (const auto is_free = output_is_free(arguments, arguments.output, part); !is_free)
    return tl::unexpected(is_free.error());
  Begun begun{devices::CaptureRecord(std::move(*plan), *rules), arguments.output, part, 0.0};
  begun.record.note("date", now_utc());
  return begun;
}

Result<Begun> resumed(const CaptureArguments& arguments) {
  const TargetArguments& target = arguments.target;
  if (!target.axis.empty() || !target.sense.empty() || target.from_mm || target.to_mm || target.step_mm ||
      !target.targets.empty() || !target.plan.empty())
    return problem(ProblemKind::usage, "--resume continues with the targets of its file: give no others");
  const auto part = laser::read_measurement_set(arguments.resume);
  if (!part) return tl::unexpected(part.error());
  auto record = devices::CaptureRecord::from_part(*part);
  if (!record) return tl::unexpected(record.error());
  Begun begun{std::move(*record), arguments.output, arguments.resume, 0.0};
  if (begun.output.empty()) {
    const std::filesystem::path path(arguments.resume);
    if (path.extension() != ".part") return problem(ProblemKind::usage, "-o OUT.csv is missing");
    begun.output = (path.parent_path() / path.stem()).string();
  }
  if (const auto is_free = output_is_free(arguments, begun.output, begun.part); !is_free)
    return tl::unexpected(is_free.error());
  const double last_s = begun.record.taken().back().time_s.value_or(0.0);
  begun.begun_s = std::max(last_s, age_s(begun.record.noted("date").value_or("")).value_or(last_s));
  begun.record.note("resumed", now_utc());
  return begun;
}

Result<std::unique_ptr<ReadingSource>> source_of(const CaptureArguments& arguments) {
  const int given = static_cast<int>(!arguments.gauge.empty()) + static_cast<int>(!arguments.readings.empty()) +
                    static_cast<int>(!arguments.follow.empty()) + static_cast<int>(!arguments.display.empty());
  if (given > 1)
    return problem(ProblemKind::usage, "readings come from one place: --gauge, --readings, --follow or --display");
  if (!arguments.readings.empty()) return file_source(arguments.readings);
  if (!arguments.follow.empty()) return following_source(arguments.follow);
  if (!arguments.display.empty()) return command_source(arguments.display);
  if (arguments.gauge.empty()) return std::unique_ptr<ReadingSource>();
  auto port = opened_device(arguments.gauge, DeviceKind::gauge);
  if (!port) return tl::unexpected(port.error());
  return gauge_source(std::move(*port));
}

TriggerKind trigger_kind(const CaptureArguments& arguments, bool typed) {
  if (arguments.trigger == "each") return TriggerKind::each;
  if (arguments.trigger.empty()) return typed ? TriggerKind::typed : TriggerKind::enter;
  return arguments.trigger == "enter" ? TriggerKind::enter : TriggerKind::device;
}

Result<void> check_keyboard(const VerbContext& context, TriggerKind kind, bool typed) {
  if (typed && kind != TriggerKind::typed)
    return problem(ProblemKind::usage,
                   "--trigger sets only the time of a reading: give its source as well (--gauge, --readings, "
                   "--follow or --display); without a trigger, values are typed");
  if (context.console.keyboard() == nullptr && (kind == TriggerKind::typed || kind == TriggerKind::enter))
    return problem(ProblemKind::usage,
                   "nobody can type here: give --trigger DEVICE.toml, or --trigger each with --readings");
  return {};
}

Result<CaptureSetup> setup_of(VerbContext& context, const CaptureArguments& arguments) {
  CaptureSetup setup;
  auto source = source_of(arguments);
  if (!source) return tl::unexpected(source.error());
  setup.source = std::move(*source);
  setup.trigger_kind = trigger_kind(arguments, setup.source == nullptr);
  if (const auto can = check_keyboard(context, setup.trigger_kind, setup.source == nullptr); !can)
    return tl::unexpected(can.error());
  if (setup.trigger_kind == TriggerKind::device) {
    auto port = opened_device(arguments.trigger, DeviceKind::trigger);
    if (!port) return tl::unexpected(port.error());
    setup.trigger.emplace(std::move(*port));
  }
  if (arguments.environment.empty()) return setup;
  auto port = opened_device(arguments.environment, DeviceKind::environment);
  if (!port) return tl::unexpected(port.error());
  setup.environment_every_s = arguments.environment_every_s;
  setup.environment.emplace(std::move(*port), arguments.environment_every_s);
  return setup;
}

void note_devices(const CaptureSetup& setup, devices::CaptureRecord& record) {
  record.note("instrument", setup.source ? setup.source->name() : "display, values typed");
  if (setup.trigger) record.note("trigger", name_of(setup.trigger->port()));
  if (!setup.environment) return;
  record.note("environment", name_of(setup.environment->port()));
  if (!setup.environment->port().device().source.empty())
    record.note("environment described by", setup.environment->port().device().source);
}

void show_news(VerbContext& context, CaptureRun& run) {
  for (const CaptureNews& news : run.take_news())
    if (news.kind == CaptureNews::Kind::warning)
      context.console.warn(news.text);
    else
      context.console.note(news.text);
}

/// The first temperatures, before the first reading needs them.
void wait_for_environment(VerbContext& context, CaptureRun& run, bool has_environment) {
  constexpr int kMostSteps = 150;
  if (!has_environment) return;
  for (int k = 0; k < kMostSteps && run.around(steady_s()).empty() && !interrupted(); ++k) {
    run.warm_up(steady_s());
    show_news(context, run);
    std::this_thread::sleep_for(kCaptureStep);
  }
}

void go_through(VerbContext& context, CaptureRun& run, bool needs_keyboard) {
  Keyboard* keyboard = context.console.keyboard();
  while (!run.done() && !run.left() && run.stuck().empty() && !interrupted()) {
    run.step(kCaptureStep, steady_s());
    if (keyboard != nullptr) {
      while (!run.done() && !run.left()) {
        const auto line = keyboard->line();
        if (!line) break;
        run.typed(*line, steady_s());
        show_news(context, run);
      }
      if (keyboard->ended() && needs_keyboard && !run.left())
        run.strand("stdin has ended, and nothing else can trigger");
    }
    show_news(context, run);
  }
}

Json json_of_run(const CaptureRun& run, const std::string& output, bool complete) {
  const auto result = run.record().result();
  int doubts = 0;
  for (const laser::MetadataEntry& entry : result.metadata) doubts += entry.key == "in doubt" ? 1 : 0;
  return Json{{"complete", complete},
              {"output", complete ? Json(output) : Json(nullptr)},
              {"part", complete || result.readings.empty() ? Json(nullptr) : Json(run.part())},
              {"targets", run.record().plan().stops.size()},
              {"readings", result.readings.size()},
              {"left_out", run.record().skipped()},
              {"in_doubt", doubts},
              {"runs", run.record().runs()},
              {"duration_s", result.readings.empty() ? Json(nullptr) : number_or_null(result.readings.back().time_s)},
              {"unplugged", run.unplugged()}};
}

std::string kept_text(CaptureRun& run) {
  if (run.record().taken().empty()) return "nothing was read";
  if (!run.part_is_safe()) return fmt::format("{} could not be written last: the newest readings are lost", run.part());
  return fmt::format(
      "{} of {} readings are safe in {}; go on with `ecs laser capture --resume {}` and the same devices",
      run.record().taken().size(), run.record().plan().stops.size(), run.part(), run.part());
}

Result<Outcome> ended(CaptureRun& run, const std::string& output) {
  if (!run.done()) {
    if (interrupted()) return problem(ProblemKind::refused, kept_text(run));
    if (!run.stuck().empty())
      return problem(ProblemKind::bad_input, fmt::format("{}: {}", run.stuck(), kept_text(run)));
    return Outcome{"left before the end: " + kept_text(run) + "\n", one_line(json_of_run(run, output, false)),
                   kDoesNotHold};
  }
  const auto result = run.record().result();
  if (result.readings.empty()) return problem(ProblemKind::refused, "no target has a reading: nothing is written");
  if (const auto written = laser::write_measurement_set(output, result); !written) {
    Problem why = written.error();
    why.message += "; " + kept_text(run);
    return tl::unexpected(std::move(why));
  }
  static_cast<void>(run.part_is_safe());  // it is being written no more
  std::error_code ignored;
  std::filesystem::remove(run.part(), ignored);
  std::string text = fmt::format("{} readings of {} targets written to {}\n", result.readings.size(),
                                 run.record().plan().stops.size(), output);
  for (const laser::MetadataEntry& entry : result.metadata)
    if (entry.key == "left out" || entry.key == "in doubt") text += fmt::format("  {}: {}\n", entry.key, entry.value);
  return Outcome{text, one_line(json_of_run(run, output, true)), kDone};
}

Result<Outcome> capture(VerbContext& context, const CaptureArguments& arguments) {
  const bool each = arguments.trigger == "each";
  auto begun = arguments.resume.empty() ? begun_anew(arguments, each) : resumed(arguments);
  if (!begun) return tl::unexpected(begun.error());
  auto setup = setup_of(context, arguments);
  if (!setup) return tl::unexpected(setup.error());
  note_devices(*setup, begun->record);
  const bool needs_keyboard = setup->trigger_kind == TriggerKind::typed || setup->trigger_kind == TriggerKind::enter;
  const bool has_environment = setup->environment.has_value();
  setup->part = begun->part;
  setup->begun_s = begun->begun_s;
  CaptureRun run(std::move(begun->record), std::move(*setup), steady_s());
  context.console.note(run.help());
  wait_for_environment(context, run, has_environment);
  go_through(context, run, needs_keyboard);
  return ended(run, begun->output);
}

}  // namespace

extern const VerbDefinition kLaserCapture = verb<CaptureArguments>(
    "laser capture", "guides through the targets of a measurement, forward and back, and takes its readings",
    "ecs laser capture --axis X --sense EX --from 0 --to 500 --step 50 --runs 3 -o exx.csv\n"
    "  ecs laser capture --plan plan.toml --row EXX --trigger foot_switch.toml --gauge gauge.toml "
    "--environment temper -o EXX.csv\n"
    "  ecs laser capture --resume EXX.csv.part --trigger foot_switch.toml --gauge gauge.toml",
    [](Verb& verb, CaptureArguments& arguments) {
      verb.text("-o,--output", arguments.output, "the measurement CSV to write; OUT.csv.part until it is complete")
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
          .flag("--force", arguments.force, "replaces an output file that is there");
    },
    capture);

}  // namespace ecs::app
