#include "commissioning/utility/status_controller.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/memory/view.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "core/fault.hpp"

namespace ecs::commissioning {
namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenReadings = 1s;
constexpr int kRestPerReading = 3;  ///< a slow link is left to others for so many times as long as a reading took

}  // namespace

std::string_view meaning_of(UnitMode mode) {
  switch (mode) {
    case UnitMode::starting:
      return "the unit has just been switched on and looks for a host";
    case UnitMode::integration:
      return "every relay is open; the unit does what the screens tell it";
    case UnitMode::datuming:
      return "waits until the machine's control has referenced every axis; then it compensates";
    case UnitMode::compensating:
      return "relays closed: the machine is being corrected";
    case UnitMode::halted:
      return "a fatal fault: every relay is open, only switching off and on helps";
  }
  return "a mode this program does not know: update ecs";
}

Result<StatusFile> read_status_file(const std::string& path) {
  ECS_TRY(text, read_file(path));
  StatusFile file;
  file.name = std::filesystem::path(path).filename().string();
  if (const auto first = trimmed(text); !first.empty() && first.front() == '{') {
    ECS_TRY(snapshot, parse_snapshot(text, path));
    file.snapshot = std::move(snapshot);
    return file;
  }
  ECS_TRY(dump, dump_in(text, path));
  file.snapshot = dump.status;
  const std::string said = memory_cell(dump, decoded(dump), false).text;
  for (const std::string_view line : lines_of(said)) file.memory.emplace_back(line);
  return file;
}

StatusController::StatusController(std::shared_ptr<UnitConnection> connection)
    : connection_(std::move(connection)), watched_(connection_->snapshot()) {}

const StatusSnapshot* StatusController::snapshot() const {
  if (file_) return file_->snapshot ? &*file_->snapshot : nullptr;
  return read_ ? &read_->snapshot : nullptr;
}

std::optional<double> StatusController::age_s() const {
  if (!read_) return std::nullopt;
  return std::chrono::duration<double>(Clock::now() - read_at_).count();
}

std::string StatusController::lack() const { return !watched_.problem.empty() ? watched_.problem : problem_; }

bool StatusController::integrating() const { return read_ && read_->snapshot.status.mode == UnitMode::integration; }

void StatusController::open(const std::string& path) {
  if (opening_.running()) return;
  const auto work = [path](JobControl&) { return read_status_file(path); };
  opening_.start("opening", work, [this, path](Result<StatusFile> opened) {
    if (!opened) return message_.say(opened.error());
    file_ = std::move(*opened);
    opened_ = path;
  });
}

bool StatusController::may_act() {
  if (file_)
    message_.say("A file is shown: l goes back to the unit first.", Tone::warning);
  else if (!read_)
    message_.say("The unit has not answered yet.", Tone::warning);
  else if (busy())
    message_.say(work_.label() + " is under way: Esc gives it up.", Tone::warning);
  else
    return true;
  return false;
}

bool StatusController::may_change() {
  const std::string why = refusal_in(read_->snapshot.status.mode);
  if (!why.empty()) message_.say(why, Tone::warning);
  return why.empty();
}

void StatusController::start(std::string working_on, std::vector<std::string> words,
                             std::function<Result<std::string>(UnitLink&, JobControl&)> work) {
  work_.start(
      std::move(working_on),
      [connection = connection_, work = std::move(work)](JobControl& control) {
        return connection->with_link(control, [&](UnitLink& link) { return work(link, control); });
      },
      [this, words = std::move(words)](const Result<std::string>& done) {
        const bool refused = !done && done.error().kind == ProblemKind::refused;  // a memory test that failed
        if (done || (refused && words.back() == "ramtest")) note_on_unit(*connection_, words, done ? 0 : 1);
        say_done(done, work_.cancelled());
      });
}

void StatusController::test_memory() {
  start("memory test", {"utility", "ramtest"}, [](UnitLink& link, JobControl& control) -> Result<std::string> {
    ECS_TRY(result, link.client().run_ram_test(
                        [&control](const protocol::CommandResult& busy) { control.part = busy.per_mille / 1000.0; }));
    if (result.value == protocol::kUnused)
      return std::string("Every location of the axis memory holds what is written to it.");
    return problem(
        ProblemKind::refused,
        fmt::format(
            "The memory test failed at 0x{:06X}: replace that axis memory module, then send parameters and map again.",
            result.value));
  });
}

Question StatusController::clear_question() const {
  return {"Let the unit forget its fault?",
          "Fault, axis and address are lost: s saves them in a file first. The cause stays what it is; the unit does "
          "not change its mode.",
          "forget it", "keep it"};
}

void StatusController::clear_fault() {
  start("clearing the fault", {"utility", "clear"}, [](UnitLink& link, JobControl&) -> Result<std::string> {
    ECS_DO(link.client().clear_fault());
    return std::string("The fault is cleared.");
  });
}

Question StatusController::mode_question() const {
  if (integrating())
    return {"Go to compensation mode?",
            "The unit tests its memory and its map and forgets where its axes are. Then the machine's control must "
            "reference every axis. As soon as the last one is found every relay closes, and THE MACHINE IS MOVED by "
            "the compensation of each axis from then on. Keep clear of it.",
            "compensate", "stay"};
  std::string moved;
  if (const auto sample = connection_->newest(); sample && sample->mode == UnitMode::compensating)
    for (const Axis a : kAllAxes)
      if (const auto& axis = sample->axes[index_of(a)]; axis.present)
        moved += fmt::format("{}{} {:+.1f} um", moved.empty() ? "" : ", ", letter_of(a), -axis.compensation_um);
  return {"Go to integration mode?",
          "Every relay opens at once and the loop ends: what is being added is taken away" +
              (moved.empty() ? std::string(". ") : ", so THE MACHINE MOVES by about " + moved + ". ") +
              "Do it while no workpiece is being cut.",
          "integrate", "stay"};
}

void StatusController::change_mode() {
  if (!integrating()) {
    start("integration mode", {"utility", "mode", "integrate"}, [](UnitLink& link, JobControl&) -> Result<std::string> {
      ECS_DO(link.client().enter_integration());
      return std::string("Integration mode: every relay is open.");
    });
    return;
  }
  start("compensation mode", {"utility", "mode", "compensate", "--wait", "0"},
        [](UnitLink& link, JobControl&) -> Result<std::string> {
          ECS_DO(begin_compensation(link.client()));
          return fmt::format("Reference every axis of the machine now{}.",
                             link.is_emulator() ? ": g lets the emulated machine do it" : ", at its own control");
        });
}

void StatusController::reference() {
  if (!read_ || read_->workshop.empty())
    message_.say("This is a real unit: reference the axes at the machine's own control.", Tone::warning);
  else if (!reference_.running()) {
    message_.say("The emulated machine references its axes ...");
    reference_machine(reference_, read_->workshop, {}, message_);
  }
}

void StatusController::save(const std::string& path) {
  if (snapshot() == nullptr || writing_.running()) return;
  const auto work = [path, snapshot = *snapshot()](JobControl&) -> Result<std::string> {
    ECS_DO(write_snapshot(path, snapshot));
    return "written: " + path;
  };
  writing_.start("writing", work, [this, path, of_file = file_.has_value()](const Result<std::string>& done) {
    if (done && of_file)
      note_command({"utility", "status", "--from", path_word(opened_), "--save", path_word(path)});
    else if (done)
      note_on_unit(*connection_, {"utility", "status", "--save", path_word(path)});
    say_done(done, false);
  });
}

std::string StatusController::proposed_name() { return file_name_now("status", ".json"); }

void StatusController::cancel() {
  work_.cancel();
  reference_.cancel();
}

void StatusController::start_reading() {
  if (file_ || busy() || reading_.running()) return;
  const auto rest = std::max<Clock::duration>(kBetweenReadings, kRestPerReading * took_);
  if (!at_once_ && Clock::now() - std::max(read_at_, asked_at_) < rest) return;
  at_once_ = false;
  asked_at_ = Clock::now();
  const auto work = [connection = connection_](JobControl& control) {
    return connection->with_link(control, [](UnitLink& link) -> Result<Read> {
      ECS_TRY(snapshot, take_snapshot(link.client(), link.name(), protocol::kEventsInBlock));
      return Read{std::move(snapshot), link.workshop()};
    });
  };
  reading_.start("reading", work, [this](Result<Read> read) { take(std::move(read)); });
}

void StatusController::take(Result<Read> read) {
  took_ = Clock::now() - asked_at_;
  problem_ = read ? "" : to_text(read.error());
  if (!read) return;
  read_ = std::move(*read);
  read_at_ = Clock::now();
}

void StatusController::say_done(const Result<std::string>& done, bool given_up) {
  at_once_ = true;
  if (done)
    message_.say(*done);
  else
    say_failed(message_, done.error(), given_up);
}

bool StatusController::advance() {
  bool changed = connection_->changes() != changes_ && connection_->snapshot().problem != watched_.problem;
  changes_ = connection_->changes();
  watched_ = connection_->snapshot();
  start_reading();
  for (TaskRunner* task : {&reading_, &work_, &writing_, &opening_}) changed = task->advance() || changed;
  if (reference_.advance()) {
    changed = true;
    at_once_ = true;
    if (!message_.is_problem())
      message_.say("The emulated machine was driven onto its references: the unit's answer is above.");
  }
  const int age = static_cast<int>(age_s().value_or(0.0));
  changed = changed || busy() || age != shown_age_;
  shown_age_ = age;
  return changed;
}

}  // namespace ecs::commissioning
