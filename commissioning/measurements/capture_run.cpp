#include "commissioning/measurements/capture_run.hpp"

#include <algorithm>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/measurements/capture_view.hpp"
#include "commissioning/measurements/device_choice.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::commissioning {
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
  std::string how = "type the value that the display shows";
  if (setup_.trigger_kind == TriggerKind::enter) how = "Enter takes a reading";
  if (setup_.trigger_kind == TriggerKind::device) how = "the trigger, or Enter, takes a reading";
  if (setup_.trigger_kind == TriggerKind::each) how = "readings are taken as they come";
  return how + "; u takes the last one back, s skips a target, q leaves (what was read is kept), ? helps";
}

void CaptureRun::tell_change(devices::PortChange change, const std::string& device, const std::string& hindrance,
                             const char* meanwhile) {
  if (change == devices::PortChange::lost) {
    ++unplugged_;
    record_.pause();
    settle();
    tell(CaptureNews::Kind::warning,
         fmt::format("{} was unplugged. Nothing is lost: {} reading{} {} safe{}. Plug it in again; {}", device,
                     record_.taken().size(), record_.taken().size() == 1 ? "" : "s",
                     record_.taken().size() == 1 ? "is" : "are",
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
                "Enter triggers meanwhile");
  }
  if (setup_.source) {
    const devices::PortChange change = setup_.source->look(now_s);
    tell_change(change, setup_.source->name(), setup_.source->hindrance(), "it is waited for");
    setup_.source->attend(now_s);
  }
  if (!setup_.environment) return;
  devices::Sensor& sensor = *setup_.environment;
  const devices::PortChange change = sensor.look(now_s);
  tell_change(change, name_of(sensor.port()), sensor.port().hindrance(), "readings go on without its values meanwhile");
  sensor.attend(now_s);
  if (sensor.silent() >= kSilentPolls && !silence_told_)
    tell(CaptureNews::Kind::warning,
         fmt::format("{} answers nothing of use: readings go on without its values. Is the probe plugged in, is its "
                     "description the right one? `ecs laser devices --try` shows what it says",
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
  if (asked_) return tell(CaptureNews::Kind::warning, "not taken: the last trigger still waits for its reading");
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
    tell(CaptureNews::Kind::warning, "not taken: " + shown.why);
}

void CaptureRun::take(double shown, double now_s) {
  const devices::Verdict verdict = record_.offer(shown, now_s - zero_s_, around(now_s));
  if (verdict.taken) {
    tell(CaptureNews::Kind::note, taken_text(record_));
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
    tell(CaptureNews::Kind::warning, fmt::format("{} could not be written ({}): the readings are only in memory. Make "
                                                 "room; it is tried again with the next reading",
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
    std::error_code ignored;
    std::filesystem::remove(setup_.part, ignored);
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
    tell(undone ? CaptureNews::Kind::note : CaptureNews::Kind::warning,
         undone ? "taken back" : "there is nothing to take back");
    if (undone) keep();
    return tell_due();
  }
  if (word == "s" || word == "skip") {
    const bool skipped = record_.skip();
    tell(CaptureNews::Kind::note, skipped ? "left without a reading" : "nothing is due");
    if (skipped) keep();
    return tell_due();
  }
  const auto value = number_in(word);
  if (value && !setup_.source) return take(*value, now_s);
  if (word.empty() || word == "?") return tell(CaptureNews::Kind::note, help());
  tell(CaptureNews::Kind::warning, value ? "readings come from " + setup_.source->name() + ": Enter takes one"
                                         : fmt::format("\"{}\" is no value and no command. {}", line, help()));
}

}  // namespace ecs::commissioning
