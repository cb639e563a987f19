#include "commissioning/laser_session/controller.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/link/not_armed.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {
namespace {

// What became of the map of a draft, in its words.
constexpr const char* kSavedKey = "saved";
constexpr const char* kSentTo = ", sent to unit ";

/// As the time of a draft: "2026-05-04 14:05".
std::string written_at(const std::string& file) {
  struct stat facts {};
  if (::stat(file.c_str(), &facts) != 0) return {};
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(facts.st_mtime));
}

std::string absolute(const std::string& path) {
  return path.empty() ? path : disc::absolute(path).lexically_normal().string();
}

/// The machine that work belongs to: as the header, the parameters or a measured file name it, else the files' folder.
std::string owner_of(const LaserChoices& choices) {
  if (!choices.recipe.machine.empty()) return choices.recipe.machine;
  if (const auto read = params::read_parameters(choices.params_file); read && !read->identity.machine.empty())
    return read->identity.machine;
  if (choices.files.empty()) return {};
  const LaserFile file = read_laser_file(choices.files.front());
  if (file.set)
    if (const auto named = laser::measured_machine(file.set->metadata); !named.name.empty()) return named.name;
  return "files of " + std::filesystem::path(choices.files.front().path).parent_path().string();
}

LaserMark done_unless(bool doubtful) { return doubtful ? LaserMark::doubtful : LaserMark::done; }

}  // namespace

LaserController::LaserController(std::shared_ptr<UnitConnection> unit)
    : unit_(std::move(unit)), edited_("laser"), work_(std::make_shared<const LaserWork>()) {
  offer(offered_draft(edited_.draft()));
}

LaserController::~LaserController() {
  for (TaskRunner* task : {&working_out_, &task_, &looking_}) task->cancel();
}

// --- choices --------------------------------------------------------------------------------------------------------

void LaserController::change(const std::string& what, const std::function<void(LaserChoices&)>& how) {
  LaserChoices next = choices();
  how(next);
  if (!edited_.did(what, std::move(next))) return;
  keep();
  work_out();
}

void LaserController::open_map(const std::string& file, const std::string& parameters) {
  change(fmt::format("the map {} opened", std::filesystem::path(file).filename().string()), [&](LaserChoices& c) {
    c.opened_map = file;
    c.map_file = file;
    c.files.clear();
    const std::string beside = files_of_map(file).parameters;
    if (!parameters.empty())
      c.params_file = parameters;
    else if (disc::exists(beside))
      c.params_file = beside;
  });
  message_.say(choices().params_file.empty()
                   ? "map opened; press p to choose the parameters of the unit; step 8 sends both"
                   : fmt::format("map opened, with the parameters {}; step 8 sends both", choices().params_file));
}

void LaserController::undo() { stepped("undone: ", edited_.undo(), "nothing to undo"); }
void LaserController::redo() { stepped("redone: ", edited_.redo(), "nothing to redo"); }

void LaserController::stepped(const char* how, const std::optional<std::string>& what, const char* nothing) {
  if (!what) return message_.say(nothing, Tone::warning);
  message_.say(how + *what);
  keep();
  work_out();
}

void LaserController::keep() {
  changed_ = true;
  ready_.reset();
  sent_earlier_.clear();
  keep_as("");
}

void LaserController::keep_as(const std::string& saved) {
  LaserChoices whole = choices();  // the draft may be taken up from another folder
  for (std::string* path : {&whole.params_file, &whole.map_file, &whole.opened_map}) *path = absolute(*path);
  for (LaserFileChoice& file : whole.files) file.path = absolute(file.path);
  Json draft = Json::parse(choices_text(whole));
  if (!saved.empty()) draft[kSavedKey] = saved;
  if (const auto kept = edited_.keep(one_line(draft)); !kept) message_.say(kept.error());
}

void LaserController::take_up_offered() {
  if (!offered_) return;
  edited_.take_up(choices_in(offered_->text).value_or(LaserChoices{}), {});
  message_.say("restored: work of " + offered_->kept);
  if (const std::size_t sent = offered_saved_.find(kSentTo); sent != std::string::npos)
    sent_earlier_ = offered_saved_.substr(sent + std::string_view(kSentTo).size());
  if (!offered_saved_.empty()) saved_earlier_csv_ = read_file(choices().map_file).value_or("");
  warn_of_newer_files(offered_->kept);
  offered_.reset();
  changed_ = true;
  work_out();
}

void LaserController::offer(std::optional<Draft> draft) {
  const auto choices = draft ? choices_in(draft->text) : std::nullopt;
  offered_ = choices ? std::move(draft) : std::nullopt;
  offered_of_ = choices ? owner_of(*choices) : "";
  offered_saved_ = choices ? Json::parse(offered_->text).value(kSavedKey, "") : "";
}

void LaserController::drop_offered() {
  drop_draft(edited_.draft());
  offer(offered_draft(edited_.draft()));
}

void LaserController::set_offered_aside() {
  offered_.reset();
  set_draft_aside(edited_.draft());
}

void LaserController::offer_another() {
  exchange_draft(edited_.draft());
  offer(draft_of(edited_.draft()));
}

/// Single readings are known by their place in the file: a file written again may hold others there.
void LaserController::warn_of_newer_files(const std::string& than) {
  for (const auto& [key, line] : choices().lines) {
    if (line.readings.empty()) continue;
    for (const LaserFileChoice& file : choices().files)
      if (written_at(file.path) > than) {
        message_.say(fmt::format("{} was written after readings were excluded: check step 3 again", file.path),
                     Tone::warning);
        return;
      }
  }
}

void LaserController::read_again() {
  for (const LaserFile& file : work_->files)
    if (file.stamp != stamp_of(file.choice.path)) {
      warn_of_newer_files("");
      break;
    }
  work_out();
}

void LaserController::work_out() {
  pending_ = working_out_.running();
  if (pending_) return working_out_.cancel();
  const auto work = [choices = choices(), before = work_](JobControl& control) {
    return worked_out(choices, before, control);
  };
  working_out_.start("computing", work, [this](LaserWorkPtr done) {
    work_ = std::move(done);
    take_saved_earlier();
    const auto& parameters = work_->map.parameters;
    mismatch_ = parameters ? mismatch_of(*parameters, work_->lines) : "";
    other_unit_ = parameters ? other_unit_for(parameters->parameters, unit_->snapshot()) : "";
    if (pending_) work_out();
  });
}

/// A map that was saved before the work was continued counts as saved where its file is still the same.
void LaserController::take_saved_earlier() {
  const std::string csv = std::exchange(saved_earlier_csv_, {});
  if (csv.empty() || csv != work_->map.csv) return;
  saved_csv_ = csv;
  saved_file_ = choices().map_file;
  changed_ = false;
}

// --- how the steps stand --------------------------------------------------------------------------------------------

LaserMark LaserController::mark(LaserStep step) const {
  const LaserWork& w = *work_;
  switch (step) {
    case LaserStep::files:
      if (w.files.empty()) return w.choices.opened_map.empty() ? LaserMark::open : LaserMark::done;
      return done_unless(std::ranges::any_of(w.files, [](const LaserFile& f) { return !f.set; }));
    case LaserStep::lines:
      if (w.lines.empty()) return LaserMark::open;
      return done_unless(std::ranges::any_of(w.lines, [](const LaserLine& line) {
        return line.group.compensated.value_or(false) || !line.summary.forward || !line.summary.reverse ||
               !line.place_unknown.empty();
      }));
    case LaserStep::leave_out: {
      if (w.lines.empty()) return LaserMark::open;
      bool doubtful = false;
      for (std::size_t k = 0; k < w.lines.size(); ++k) {
        const LaserLineResult& result = w.results[k];
        doubtful = doubtful || !result.problem.empty();
        for (const std::size_t i : w.lines[k].suspects)
          doubtful = doubtful || !left_out(result.choice, *w.lines[k].set, i);
      }
      return done_unless(doubtful);
    }
    case LaserStep::curves:
      if (w.curves.empty()) return LaserMark::open;
      return done_unless(std::ranges::any_of(w.curves, &LaserCurve::doubtful));
    case LaserStep::iso:
      if (w.results.empty()) return LaserMark::open;
      return done_unless(
          std::ranges::any_of(w.results, [](const auto& result) { return !result.iso || !result.iso->notes.empty(); }));
    case LaserStep::map:
      if (!w.map.parameters && w.map.parameters_problem.empty()) return LaserMark::open;
      return done_unless(!w.map.complete() || !w.map.findings().empty());
    case LaserStep::header:
      if (!w.map.made) return LaserMark::open;
      return done_unless(!laser::missing_in(w.map.made->map.map.header).empty());
    case LaserStep::send:
      if (sent_is_current()) return LaserMark::done;
      return sent_ || failed_ || saved() ? LaserMark::doubtful : LaserMark::open;
    case LaserStep::verify:
      if (!found_) return LaserMark::open;
      return done_unless(!verified());
  }
  return LaserMark::open;
}

std::string LaserController::unsaved() const {
  LaserChoices opened;  // a map from a file, unchanged: nothing would be lost
  opened.opened_map = opened.map_file = choices().opened_map;
  opened.params_file = choices().params_file;
  if (!changed_ || !edited_.unsaved() || opened == choices()) return {};
  return "PROCESS LASER DATA: the map with these choices is not saved (they are kept and offered again)";
}

// --- disc and unit --------------------------------------------------------------------------------------------------

bool LaserController::would_overwrite() const {
  const MapFiles files = files_of_map(choices().map_file);
  if (saved_file_ == choices().map_file) return false;
  const bool opened = choices().opened_map == files.map;  // with it the parameters beside it are changed in place
  const std::vector<std::string> own =
      opened ? std::vector{files.map, choices().params_file} : std::vector<std::string>{};
  return ecs::would_overwrite(files.map, own) || ecs::would_overwrite(files.parameters, own) ||
         (!opened && ecs::would_overwrite(files.recipe));
}

bool LaserController::idle() {
  if (!task_.running()) return true;
  message_.say(fmt::format("{}: wait, or press Esc to stop", task_.label()), Tone::warning);
  return false;
}

bool LaserController::can_save() {
  if (!idle()) return false;
  if (working())
    message_.say("The map is still being computed. Try again in a moment.", Tone::warning);
  else if (!work_->map.made)
    message_.say("no map to save yet: step 6 lists the missing components", Tone::bad);
  else if (choices().map_file.empty())
    message_.say("enter a file name for the map", Tone::bad);
  else
    return true;
  return false;
}

void LaserController::say_failed(const std::string& what, const Problem& why) {
  message_.say(what + ": " + to_text(why), Tone::bad);
}

void LaserController::take_saved(const SavedMap& saved, const LaserChoices& choices, const LaserWork& work) {
  if (saved_csv_ != saved.csv || saved_file_ != saved.files.map) note_saved_map(saved, choices, work.lines);
  saved_csv_ = saved.csv;
  saved_file_ = saved.files.map;
  if (work_->map.csv != saved.csv) return;
  changed_ = false;
  keep_as(fmt::format("saved in {}", std::filesystem::path(saved_file_).filename().string()));
}

void LaserController::save_and(bool check) {
  if (!can_save()) return;
  ready_.reset();
  using Saved = std::pair<Result<SavedMap>, std::optional<Result<ReadyMap>>>;
  const auto work = [work = work_, choices = choices(), unit = unit_, check](JobControl& control) {
    Saved done{save_laser_map(work->map, choices, work->lines), std::nullopt};
    if (check && done.first) done.second = ready_map(*unit, control, done.first->files);
    return done;
  };
  task_.start(
      check ? "saving and checking" : "saving", work,
      [this, check, choices = choices(), made = work_](const Saved& done) {
        const auto& [saved, ready] = done;
        if (!saved) return say_failed(check ? "not saved" : "saving", saved.error());
        take_saved(*saved, choices, *made);
        if (ready && !*ready) return say_failed("saved, but not sent", ready->error());
        if (ready) {
          ready_ = **ready;
          return;
        }
        const std::string recipe = choices.opened_map.empty() ? ", the recipe " + saved->files.recipe : "";
        message_.say(fmt::format("saved: {}, its parameters {}{}", saved->files.map, saved->files.parameters, recipe));
      });
}

void LaserController::receive_parameters(const std::string& file) {
  if (!idle()) return;
  const auto work = [file, unit = unit_](JobControl& control) -> Result<void> {
    ECS_TRY(received, parameters_of_unit(*unit, control));
    return params::write_parameters(file, received.parameters, received.identity);
  };
  task_.start("receiving the parameters", work, [this, file](const Result<void>& received) {
    if (!received) return say_failed("receiving the parameters", received.error());
    name_in_commands(file, file_between("parameters", ".toml"));  // it lies in the state folder
    note_on_unit(*unit_, {"params", "receive", "-o", path_word(file)});
    message_.say("parameters of the unit written to " + file);
    change("parameters of the unit", [&](LaserChoices& c) { c.params_file = file; });
    read_again();
  });
}

bool LaserController::advance() {
  bool changed = working_out_.advance();
  changed = task_.advance() || changed;
  const double part = task_.running() ? task_.part() : -1.0;
  changed = changed || part != part_shown_;
  part_shown_ = part;
  look_after_failure();
  changed = looking_.advance() || changed;
  return note_changes() || changed;
}

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kBetweenLooks{1};
constexpr std::chrono::seconds kBetweenUnitLooks{3};  ///< a look takes half a second of a line of 9,600 baud

}  // namespace

void LaserController::send() {
  if (!idle() || !ready_) return;
  failed_.reset();
  after_failure_.clear();
  forget_verdict();
  const auto work = [ready = *ready_, unit = unit_](JobControl& control) { return sent_map(*unit, control, ready); };
  task_.start("sending the map", work,
              [this, ready = *ready_](const SendAttempt& attempt) { take_sent(attempt, ready); });
}

void LaserController::take_sent(const SendAttempt& attempt, const ReadyMap& ready) {
  ready_.reset();
  if (attempt.sent) {
    sent_ = *attempt.sent;
    sent_csv_ = saved_csv_;
    note_sent_map(*unit_, ready.files);
    if (saved() && !changed_)
      keep_as(fmt::format("saved in {}{}{}", std::filesystem::path(saved_file_).filename().string(), kSentTo,
                          sent_->identity.serial_number));
    message_.say(sent_text(*sent_));
    return;
  }
  next_look_ = Clock::now() + kBetweenLooks;
  failed_ = ready;
  after_failure_ =
      attempt.begun
          ? "The unit keeps its old map until a new one is complete. As soon as it answers, the active map is checked."
          : "Not sent: the unit keeps its old map.";
  if (is_not_armed(attempt.sent.error()))
    message_.say(std::string(kNotArmed) + " Press Enter in step 8 to try again.", Tone::bad);
  else
    say_failed("not sent", attempt.sent.error());
}

void LaserController::look_after_failure() {
  if (!failed_ || task_.running() || Clock::now() < next_look_ || !unit_->snapshot().open) return;
  next_look_ = Clock::now() + kBetweenLooks;
  const auto work = [unit = unit_](JobControl& control) { return holding_of_unit(*unit, control); };
  task_.start("reading the unit", work, [this](const Result<UnitHolding>& holding) {
    next_look_ = Clock::now() + kBetweenLooks;
    if (holding) take_active_after_failure(holding->check);
  });
}

void LaserController::take_active_after_failure(const std::optional<std::uint32_t>& active) {
  const std::string now = active ? fmt::format("checksum {:08X}", *active) : "none";
  if (active && failed_ && *active == failed_->check)
    after_failure_ = "The unit has accepted the new map (" + now + "). Step 9 compares it byte by byte.";
  else if (failed_ && active == failed_->active)
    after_failure_ =
        active ? "The unit answers: the old map is still active and complete (" + now + "). Press Enter to send again."
               : "The unit answers: it contains no map, as before. Press Enter to send again.";
  else
    after_failure_ = "The unit answers; its map has changed (" + now + "). Press Enter to send again.";
  message_.say(after_failure_, Tone::warning);
  failed_.reset();
}

void LaserController::verify() {
  if (!idle()) return;
  if (!has_saved()) {
    message_.say("no map to compare with yet: save and send it in step 8", Tone::warning);
    return;
  }
  const auto work = [files = files_of_map(saved_file_), unit = unit_](JobControl& control) {
    return verified_map(*unit, control, files);
  };
  task_.start(
      "reading the map back", work, [this, files = files_of_map(saved_file_)](const Result<VerifiedMap>& verified) {
        if (!verified) return say_failed("reading the map back", verified.error());
        take_verdict(*verified);
        note_on_unit(*unit_, {"map", "verify", path_word(files.map), "--params", path_word(files.parameters)},
                     found_->verdict.same() ? 0 : 1);
        message_.say(
            found_->verdict.same() ? "the unit contains this map and its parameters" : "this map is not in the unit",
            found_->verdict.same() ? Tone::good : Tone::bad);
      });
}

bool LaserController::may_compensate() {
  if (!idle()) return false;
  if (!found_ && !sent_)
    message_.say("the map in the unit is not known: press Enter to compare it with the file first", Tone::bad);
  else if (found_ && !found_->verdict.same())
    message_.say("the map of the file is not in the unit: send it in step 8, then press Enter to compare again",
                 Tone::bad);
  else
    return true;
  return false;
}

void LaserController::compensate() {
  if (!may_compensate()) return;
  const ExpectedMap expected = found_ ? ExpectedMap(found_->holding) : ExpectedMap(*sent_);
  const auto work = [expected, unit = unit_](JobControl& control) {
    return switch_to_compensation(*unit, control, expected);
  };
  task_.start("compensation mode", work, [this](const Result<void>& switched) {
    if (!switched) return say_failed("compensation mode", switched.error());
    note_on_unit(*unit_, {"utility", "mode", "compensate", "--wait", "0"});
    message_.say(
        "reference every axis at the control now; the unit is waiting. ECS UTILITY, DISPLAY ECS STATUS shows the "
        "progress (bundled emulator: press g there)");
  });
}

void LaserController::forget_verdict() {
  found_.reset();
  compared_csv_.clear();
  stale_.clear();
  unit_time_us_ = 0;
  ++comparison_;
}

void LaserController::take_verdict(const VerifiedMap& verified) {
  forget_verdict();
  found_ = verified;
  compared_csv_ = saved_csv_;
  next_verdict_look_ = Clock::now() + kBetweenUnitLooks;
}

void LaserController::say_stale(const std::string& why) {
  stale_ = why;
  if (!message_.is_problem() || message_.text().empty())  // an error stays until the next action
    message_.say("the unit has changed since the comparison: " + why + "; press Enter in step 9 to compare again",
                 Tone::warning);
}

bool LaserController::note_changes() {
  if (!found_ || !stale_.empty()) return false;
  const WatchedUnit unit = unit_->snapshot();
  UnitHolding now = found_->holding;
  if (unit.identity) now.serial_number = unit.identity->serial_number;
  now.opened_at = unit.opened_at;
  std::string why = unit.open ? changed_since(found_->holding, now) : "the link to it was lost";
  if (const auto sample = unit_->newest(); sample && why.empty()) {
    if (sample->unit_time_us < unit_time_us_) why = "it was restarted";
    unit_time_us_ = std::max(unit_time_us_, sample->unit_time_us);
  }
  if (why.empty()) return false;
  say_stale(why);
  return true;
}

void LaserController::watch_verdict() {
  if (!found_ || !stale_.empty() || task_.running() || looking_.running()) return;
  if (Clock::now() < next_verdict_look_ || !unit_->snapshot().open) return;
  const auto look = [unit = unit_](JobControl& control) { return holding_of_unit(*unit, control); };
  looking_.start("reading the unit", look, [this, comparison = comparison_](const Result<UnitHolding>& now) {
    next_verdict_look_ = Clock::now() + kBetweenUnitLooks;
    if (comparison != comparison_ || !now || !found_ || !stale_.empty()) return;
    if (const std::string why = changed_since(found_->holding, *now); !why.empty()) say_stale(why);
  });
}

}  // namespace ecs::commissioning
