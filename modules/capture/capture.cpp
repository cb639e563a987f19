#include "modules/capture/capture.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "commissioning/session/commands.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::commissioning {
namespace {

void add(std::string& text, const std::string& part) { text += (text.empty() ? "" : ", ") + part; }

std::string start_of_pass(const laser::Reading& stop) {
  const bool forward = stop.approach == Approach::forward;
  return fmt::format("; start {} it, so that it is approached {}", forward ? "below" : "above",
                     forward ? "forward (rising)" : "in reverse (falling)");
}

}  // namespace

std::string due_text(const devices::CaptureRecord& record) {
  const laser::Reading* stop = record.due();
  if (stop == nullptr) return {};
  const auto place = record.place();
  return fmt::format("next: {} {} to {} mm (target {} of {}, run {} of {}, reading {} of {}){}", letter_of(stop->axis),
                     stop->approach == Approach::forward ? "forward" : "reverse", laser::target_mm(*stop), place.number,
                     place.of, stop->run, record.runs(), record.next() + 1, record.plan().stops.size(),
                     place.first_of_pass ? start_of_pass(*stop) : "");
}

std::string around_text(const devices::Values& values) {
  std::string text;
  constexpr WordTable<devices::Quantity, 5> kShown{
      {"air {:.2f} degC", "material {:.2f} degC", "{:.1f} hPa", "{:.1f} %RH", "{:.2f} um"}};
  for (const auto& [quantity, value] : values) add(text, fmt::format(fmt::runtime(kShown.of(quantity)), value));
  return text;
}

std::string around_text(const laser::Reading& reading) {
  devices::Values values;
  const auto put = [&](devices::Quantity quantity, const char* column) {
    if (const auto found = reading.sensors_degC.find(column); found != reading.sensors_degC.end())
      values[quantity] = found->second;
  };
  put(devices::Quantity::air_degC, "t_air_degC");
  put(devices::Quantity::material_degC, "t_material_degC");
  if (reading.pressure_hPa) values[devices::Quantity::pressure_hPa] = *reading.pressure_hPa;
  if (reading.humidity_pct) values[devices::Quantity::humidity_pct] = *reading.humidity_pct;
  return around_text(values);
}

std::string taken_text(const devices::CaptureRecord& record) {
  const laser::Reading& last = record.taken().back();
  const std::string around = around_text(last);
  return fmt::format("{:.2f} {} at {} {} mm ({:.1f} s{})", last.error, laser::unit_of(last.sense), letter_of(last.axis),
                     laser::target_mm(last), last.time_s.value_or(0.0), around.empty() ? "" : ", " + around);
}

namespace {

constexpr int kSilentPolls = 3;
constexpr double kOldestEnvironment_s = 60.0;

}  // namespace

CaptureRun::CaptureRun(devices::CaptureRecord record, CaptureSetup setup, double now_s)
    : record_(std::move(record)), setup_(std::move(setup)), zero_s_(now_s - setup_.begun_s) {
  record_.pause();
  tell_due();
}

void CaptureRun::tell(CaptureNews::Kind kind, std::string text) { news_.push_back({kind, std::move(text)}); }

void CaptureRun::tell_due() {
  if (const std::string text = due_text(record_); !text.empty()) tell(CaptureNews::Kind::note, text);
}

std::vector<CaptureNews> CaptureRun::take_news() { return std::exchange(news_, {}); }

devices::Values CaptureRun::around(double now_s) const {
  if (!setup_.environment) return {};
  return setup_.environment->values(now_s, std::max(kOldestEnvironment_s, 3.0 * setup_.environment_every_s));
}

std::string CaptureRun::help() const {
  std::string how = "type the value shown on the display";
  if (setup_.trigger_kind == TriggerKind::enter) how = "Enter takes a reading";
  if (setup_.trigger_kind == TriggerKind::device) how = "the trigger, or Enter, takes a reading";
  if (setup_.trigger_kind == TriggerKind::each) how = "readings are recorded as they arrive";
  return how + "; u: undo the last one, s: skip a target, q: quit (readings are saved), ?: help";
}

void CaptureRun::tell_change(devices::PortChange change, const std::string& device, const std::string& hindrance,
                             const char* meanwhile) {
  if (change == devices::PortChange::lost) {
    ++unplugged_;
    record_.pause();
    settle();
    tell(CaptureNews::Kind::warning,
         fmt::format("{} was unplugged. {} reading{} {} saved{}. Plug it in again; {}", device, record_.taken().size(),
                     record_.taken().size() == 1 ? "" : "s", record_.taken().size() == 1 ? "is" : "are",
                     setup_.part.empty() || record_.taken().empty() ? "" : " in " + setup_.part, meanwhile));
  }
  if (change == devices::PortChange::back) {
    record_.pause();
    tell(CaptureNews::Kind::note, fmt::format("{} is back", device));
    tell_due();
  }
  if (hindrance.empty() || hindrance == hindrance_told_) return;
  hindrance_told_ = hindrance;
  tell(CaptureNews::Kind::warning, hindrance);
}

void CaptureRun::look_after_devices(double now_s) {
  if (setup_.trigger) {
    const devices::PortChange change = setup_.trigger->look(now_s);
    tell_change(change, name_of(setup_.trigger->port()), setup_.trigger->port().hindrance(),
                "until then press Enter to trigger");
  }
  if (setup_.source) {
    const devices::PortChange change = setup_.source->look(now_s);
    tell_change(change, setup_.source->name(), setup_.source->hindrance(), "the program waits for it");
    setup_.source->attend(now_s);
  }
  if (!setup_.environment) return;
  devices::Sensor& sensor = *setup_.environment;
  const devices::PortChange change = sensor.look(now_s);
  tell_change(change, name_of(sensor.port()), sensor.port().hindrance(),
              "until then readings continue without its values");
  sensor.attend(now_s);
  if (sensor.silent() >= kSilentPolls && !silence_told_)
    tell(CaptureNews::Kind::warning,
         fmt::format("{} gives no usable answer: readings continue without its values. Check that the probe is plugged "
                     "in and that its description is right; `ecs laser devices --try` shows its answers",
                     name_of(sensor.port())));
  silence_told_ = sensor.silent() >= kSilentPolls;
}

void CaptureRun::step(std::chrono::milliseconds wait, double now_s) {
  using Clock = std::chrono::steady_clock;
  look_after_devices(now_s);
  if (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) settle();
  if (done() || left_ || !stuck_.empty()) return;
  const auto begin = Clock::now();
  const bool listening = setup_.trigger && setup_.trigger->port().present();
  const bool pressed = listening && setup_.trigger->pressed(wait, now_s);
  if (!listening && !asked_ && setup_.trigger_kind != TriggerKind::each) std::this_thread::sleep_for(wait);
  if (!listening && asked_) std::this_thread::sleep_for(std::min(wait, std::chrono::milliseconds(2)));
  now_s += std::chrono::duration<double>(Clock::now() - begin).count();
  if (pressed || (setup_.trigger_kind == TriggerKind::each && !asked_)) fire(now_s);
  if (asked_) ask_source(now_s);
}

void CaptureRun::fire(double now_s) {
  if (done()) return;
  if (!setup_.source)
    return tell(CaptureNews::Kind::warning, "the display's value has to be typed: type it and press Enter");
  if (asked_)
    return tell(CaptureNews::Kind::warning, "not accepted: the last trigger is still waiting for its reading");
  if (std::string why = record_.doubled(now_s - zero_s_); !why.empty())
    return tell(CaptureNews::Kind::warning, std::move(why));
  asked_ = true;
  setup_.source->ask(now_s);
}

void CaptureRun::ask_source(double now_s) {
  const Shown shown = setup_.source->shown(now_s);
  if (shown.kind == Shown::Kind::not_yet) return;
  asked_ = false;
  if (shown.kind == Shown::Kind::ended)
    stuck_ = shown.why;
  else if (shown.kind == Shown::Kind::value)
    take(shown.value, now_s);
  else if (shown.kind != Shown::Kind::late || setup_.trigger_kind != TriggerKind::each)
    tell(CaptureNews::Kind::warning, "not accepted: " + shown.why);
}

void CaptureRun::take(double shown, double now_s) {
  const devices::Verdict verdict = record_.offer(shown, now_s - zero_s_, around(now_s));
  if (verdict.taken) {
    tell(CaptureNews::Kind::note, taken_text(record_));
    if (setup_.source) record_.read_lines(setup_.source->name(), setup_.source->lines_read());
    keep();
  }
  if (!verdict.warning.empty()) tell(CaptureNews::Kind::warning, verdict.warning);
  if (verdict.taken) tell_due();
}

/// The outcome of the writing under way, once. A part that cannot be written is said at once, and tried again with the
/// next reading.
void CaptureRun::settle() {
  if (!writing_.valid()) return;
  const Result<void> written = writing_.get();
  part_is_safe_ = written.has_value();
  if (!part_is_safe_)
    tell(CaptureNews::Kind::warning, fmt::format("{} could not be written ({}): the readings are only in memory. Free "
                                                 "some space; writing is tried again with the next reading",
                                                 setup_.part, written.error().message));
}

bool CaptureRun::part_is_safe() {
  settle();
  return part_is_safe_;
}

void CaptureRun::keep() {
  if (setup_.part.empty()) return;
  settle();
  if (record_.taken().empty()) {
    disc::remove(setup_.part);
    return;
  }
  writing_ = std::async(std::launch::async,
                        [path = setup_.part, set = record_.part()] { return laser::write_measurement_set(path, set); });
}

void CaptureRun::typed(const std::string& line, double now_s) {
  const std::string word = lower(trimmed(line));
  if (word.empty() && setup_.trigger_kind != TriggerKind::typed) return fire(now_s);
  if (word == "q" || word == "quit") {
    left_ = true;
    return;
  }
  if (word == "u" || word == "undo") {
    const bool undone = record_.undo();
    tell(undone ? CaptureNews::Kind::note : CaptureNews::Kind::warning, undone ? "undone" : "no reading to undo");
    if (undone) keep();
    return tell_due();
  }
  if (word == "s" || word == "skip") {
    const bool skipped = record_.skip();
    tell(CaptureNews::Kind::note, skipped ? "skipped" : "no reading is due");
    if (skipped) keep();
    return tell_due();
  }
  const auto value = number_in(word);
  if (value && !setup_.source) return take(*value, now_s);
  if (word.empty() || word == "?") return tell(CaptureNews::Kind::note, help());
  tell(CaptureNews::Kind::warning,
       value ? "readings come from " + setup_.source->name() + ": press Enter to take one"
             : fmt::format("\"{}\" is neither a value (with a decimal point) nor a command. {}", line, help()));
}

namespace {

using devices::DeviceKind;

constexpr std::chrono::milliseconds kCaptureStep{20};
constexpr double kNeverMissed = 1e9;

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

/// The command that goes on, with the same devices.
std::string resuming(const CaptureChoice& choice, const std::string& part) {
  std::vector<std::string> words{"ecs", "laser", "capture", "--resume", part};
  for (const auto& [option, given] : {std::pair{"--trigger", &choice.trigger},
                                      {"--gauge", &choice.gauge},
                                      {"--readings", &choice.readings},
                                      {"--follow", &choice.follow},
                                      {"--display", &choice.display},
                                      {"--environment", &choice.environment}})
    if (!given->empty()) words.insert(words.end(), {option, *given});
  return shell_command(words);
}

Result<void> output_is_free(const CaptureChoice& choice, const std::string& output, const std::string& part) {
  if (disc::exists(part) && choice.resume.empty())
    return problem(ProblemKind::usage, "{} contains an unfinished capture: continue with `{}`, or remove it", part,
                   resuming(choice, part));
  if (disc::exists(output) && !choice.force)
    return problem(ProblemKind::usage, "{} already exists: give another name, or --force to overwrite it", output);
  const auto folder = std::filesystem::absolute(part).parent_path();
  if (::access(folder.c_str(), W_OK) != 0)
    return problem(ProblemKind::output, "{} cannot be written: {} is not a folder with write permission", output,
                   folder.string());
  return {};
}

Result<devices::CaptureRules> rules_of(const CaptureChoice& choice, bool each) {
  devices::CaptureRules rules;
  rules.shows = choice.shows == "position" ? devices::Shows::position : devices::Shows::error;
  rules.scale = choice.scale.value_or(1.0);
  rules.min_interval_s = choice.min_interval_s.value_or(each ? 0.0 : rules.min_interval_s);
  if (rules.scale == 0.0) return problem(ProblemKind::usage, "--scale: expected a number other than 0");
  if (rules.min_interval_s < 0.0) return problem(ProblemKind::usage, "--min-interval: expected at least 0 s");
  if (each) rules.missed_factor = kNeverMissed;
  return rules;
}

Result<Begun> begun_anew(const CaptureChoice& choice, bool each) {
  if (choice.output.empty()) return problem(ProblemKind::usage, "-o OUT.csv is missing: the file for the readings");
  ECS_TRY(plan, capture_plan(choice.target));
  ECS_TRY(rules, rules_of(choice, each));
  for (const laser::Reading& stop : plan.stops)
    if (rules.shows == devices::Shows::position && static_cast<int>(stop.sense) != static_cast<int>(stop.axis))
      return problem(ProblemKind::usage, "--shows position is for positioning: EX of X, EY of Y, EZ of Z");
  const std::string part = part_of(choice.output);
  ECS_DO(output_is_free(choice, choice.output, part));
  Begun begun{devices::CaptureRecord(std::move(plan), rules), choice.output, part, 0.0};
  begun.record.note("date", now_utc());
  return begun;
}

Result<Begun> resumed(const CaptureChoice& choice) {
  const CaptureTargets& target = choice.target;
  if (!target.axis.empty() || !target.sense.empty() || target.from_mm || target.to_mm || target.step_mm ||
      !target.targets.empty() || !target.plan.empty())
    return problem(ProblemKind::usage, "--resume continues with the targets of its file: give no others");
  ECS_TRY(part, laser::read_measurement_set(choice.resume));
  ECS_TRY(record, devices::CaptureRecord::from_part(part));
  Begun begun{std::move(record), choice.output, choice.resume, 0.0};
  if (begun.output.empty()) {
    const std::filesystem::path path(choice.resume);
    if (path.extension() != ".part") return problem(ProblemKind::usage, "-o OUT.csv is missing");
    begun.output = (path.parent_path() / path.stem()).string();
  }
  ECS_DO(output_is_free(choice, begun.output, begun.part));
  const double last_s = begun.record.taken().back().time_s.value_or(0.0);
  begun.begun_s = std::max(last_s, age_s(begun.record.noted("date").value_or("")).value_or(last_s));
  begun.record.note("resumed", now_utc());
  return begun;
}

Result<std::unique_ptr<ReadingSource>> source_of(const CaptureChoice& choice) {
  const int given = static_cast<int>(!choice.gauge.empty()) + static_cast<int>(!choice.readings.empty()) +
                    static_cast<int>(!choice.follow.empty()) + static_cast<int>(!choice.display.empty());
  if (given > 1)
    return problem(ProblemKind::usage, "readings have only one source: --gauge, --readings, --follow or --display");
  if (!choice.readings.empty()) return file_source(choice.readings);
  if (!choice.follow.empty()) return following_source(choice.follow);
  if (!choice.display.empty()) return command_source(choice.display);
  if (choice.gauge.empty()) return std::unique_ptr<ReadingSource>();
  ECS_TRY(port, opened_device(choice.gauge, DeviceKind::gauge));
  return gauge_source(std::move(port));
}

TriggerKind trigger_kind(const CaptureChoice& choice, bool typed) {
  if (choice.trigger == "each") return TriggerKind::each;
  if (choice.trigger.empty()) return typed ? TriggerKind::typed : TriggerKind::enter;
  return choice.trigger == "enter" ? TriggerKind::enter : TriggerKind::device;
}

Result<void> check_keyboard(const Keyboard* keyboard, TriggerKind kind, bool typed) {
  if (typed && kind != TriggerKind::typed)
    return problem(ProblemKind::usage,
                   "--trigger sets only the time of a reading: give its source as well (--gauge, --readings, --follow "
                   "or --display); without a trigger, values are typed");
  if (keyboard == nullptr && (kind == TriggerKind::typed || kind == TriggerKind::enter))
    return problem(ProblemKind::usage,
                   "stdin is not a terminal: give --trigger DEVICE.toml, or --trigger each with --readings");
  return {};
}

Result<CaptureSetup> setup_of(const Keyboard* keyboard, const CaptureChoice& choice) {
  CaptureSetup setup;
  ECS_TRY(source, source_of(choice));
  setup.source = std::move(source);
  setup.trigger_kind = trigger_kind(choice, setup.source == nullptr);
  ECS_DO(check_keyboard(keyboard, setup.trigger_kind, setup.source == nullptr));
  if (setup.trigger_kind == TriggerKind::device) {
    ECS_TRY(port, opened_device(choice.trigger, DeviceKind::trigger));
    setup.trigger.emplace(std::move(port));
  }
  if (choice.environment.empty()) return setup;
  ECS_TRY(port, opened_device(choice.environment, DeviceKind::environment));
  setup.environment_every_s = choice.environment_every_s;
  setup.environment.emplace(std::move(port), choice.environment_every_s);
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

/// A file of readings is continued after the lines that were read before the interruption.
Result<void> continue_in(MessageSink& messages, ReadingSource& source, const devices::CaptureRecord& record) {
  const std::size_t lines = record.lines_read(source.name());
  if (!source.leave_out(lines))
    return problem(ProblemKind::bad_input,
                   "{}: expected at least the {} lines read before the interruption; give the whole file, "
                   "or the rest under another name",
                   source.name(), lines);
  if (lines > 0) messages.note(fmt::format("{}: continued after line {}", source.name(), lines));
  return {};
}

void show_news(MessageSink& messages, CaptureRun& run) {
  for (const CaptureNews& news : run.take_news())
    if (news.kind == CaptureNews::Kind::warning)
      messages.warn(news.text);
    else
      messages.note(news.text);
}

/// The first temperatures, before the first reading needs them.
void wait_for_environment(MessageSink& messages, CaptureRun& run, bool has_environment) {
  constexpr int kMostSteps = 150;
  if (!has_environment) return;
  for (int k = 0; k < kMostSteps && run.around(steady_s()).empty() && !interrupted(); ++k) {
    run.warm_up(steady_s());
    show_news(messages, run);
    std::this_thread::sleep_for(kCaptureStep);
  }
}

void go_through(MessageSink& messages, Keyboard* keyboard, CaptureRun& run, bool needs_keyboard) {
  while (!run.done() && !run.left() && run.stuck().empty() && !interrupted()) {
    run.step(kCaptureStep, steady_s());
    if (keyboard != nullptr) {
      while (!run.done() && !run.left()) {
        const auto line = keyboard->line();
        if (!line) break;
        run.typed(*line, steady_s());
        show_news(messages, run);
      }
      if (keyboard->ended() && needs_keyboard && !run.left())
        run.strand("stdin has ended, and no other trigger is available");
    }
    show_news(messages, run);
  }
}

std::string kept_text(const CaptureChoice& choice, CaptureRun& run) {
  if (run.record().taken().empty()) return "no readings were taken";
  if (!run.part_is_safe()) return fmt::format("the last write to {} failed: the newest readings are lost", run.part());
  return fmt::format("{} of {} readings are saved in {}; continue with `{}`", run.record().taken().size(),
                     run.record().plan().stops.size(), run.part(), resuming(choice, run.part()));
}

Result<CaptureEnd> ended(const CaptureChoice& choice, CaptureRun& run, const std::string& output) {
  CaptureEnd end{run.done(),
                 run.record().result(),
                 run.record().plan().stops.size(),
                 run.record().skipped(),
                 run.record().runs(),
                 run.unplugged(),
                 run.part(),
                 {},
                 {}};
  if (!run.done()) {
    end.kept = kept_text(choice, run);
    if (interrupted()) return problem(ProblemKind::refused, end.kept);
    if (!run.stuck().empty()) return problem(ProblemKind::bad_input, "{}: {}", run.stuck(), end.kept);
    return end;
  }
  if (end.result.readings.empty()) return problem(ProblemKind::refused, "no target has a reading: no file is written");
  if (const auto written = laser::write_measurement_set(output, end.result); !written) {
    Problem why = written.error();
    why.message += "; " + kept_text(choice, run);
    return tl::unexpected(std::move(why));
  }
  end.file = output;
  static_cast<void>(run.part_is_safe());  // it is being written no more
  disc::remove(run.part());
  return end;
}

}  // namespace

cli::Fields<CaptureChoice> CaptureChoice::fields() {
  using A = CaptureChoice;
  return {
      {"-o,--output", &A::output, "measurement CSV to write; named OUT.csv.part until it is complete", cli::Is::output},
      {"--resume", &A::resume, "continue an unfinished FILE.part"},
      &A::target,
      {"--trigger", &A::trigger,
       "trigger of a reading: a device file (DEVICE.toml, with @SERIAL if several are connected), enter (the key), "
       "or "
       "each (every value that arrives)"},
      {"--gauge", &A::gauge, "read from an indicator gauge: DEVICE.toml[@SERIAL]"},
      {"--readings", &A::readings, "file with the readings in order: each trigger takes the next line"},
      {"--follow", &A::follow, "file to which a display keeps writing: each trigger takes the last line"},
      {"--display", &A::display, "read from a shell command that prints the displayed value"},
      {"--shows", &A::shows, "quantity shown: the error, or the position of the axis [mm]",
       cli::Words{"error", "position"}},
      {"--scale", &A::scale, "factor that converts the reading to um (um/m), or a position to mm; default 1"},
      {"--environment", &A::environment,
       "thermometer of which the latest value is recorded with every reading: temper (a USB thermometer TEMPer), or a "
       "device file "
       "DEVICE.toml[@SERIAL]"},
      {"--environment-every", &A::environment_every_s, "time between the values of the thermometer [s]",
       cli::Range{0.1, 3600.0}},
      {"--min-interval", &A::min_interval_s,
       "shortest time between triggers; an earlier one is ignored [s]; default 0.5"},
      {"--force", &A::force, "overwrite an existing output file"}};
}

Result<CaptureEnd> capture(MessageSink& messages, Keyboard* keyboard, const CaptureChoice& choice) {
  const bool each = choice.trigger == "each";
  ECS_TRY(begun, choice.resume.empty() ? begun_anew(choice, each) : resumed(choice));
  ECS_TRY(setup, setup_of(keyboard, choice));
  note_devices(setup, begun.record);
  if (setup.source) ECS_DO(continue_in(messages, *setup.source, begun.record));
  const bool needs_keyboard = setup.trigger_kind == TriggerKind::typed || setup.trigger_kind == TriggerKind::enter;
  const bool has_environment = setup.environment.has_value();
  setup.part = begun.part;
  setup.begun_s = begun.begun_s;
  CaptureRun run(std::move(begun.record), std::move(setup), steady_s());
  messages.note(run.help());
  wait_for_environment(messages, run, has_environment);
  go_through(messages, keyboard, run, needs_keyboard);
  return ended(choice, run, begun.output);
}

}  // namespace ecs::commissioning
