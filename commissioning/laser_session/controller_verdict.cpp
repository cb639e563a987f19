// The map read back from the unit: the verdict, whether it still holds, compensation with it.
#include <algorithm>

#include "commissioning/laser_session/controller.hpp"
#include "commissioning/link/unit_commands.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kBetweenUnitLooks{3};  ///< a look takes half a second of a line of 9,600 baud

}  // namespace

void LaserController::verify() {
  if (!idle()) return;
  if (saved_file_.empty()) {
    message_.say("there is nothing to compare with yet: step 8 saves and sends the map", Tone::warning);
    return;
  }
  const auto work = [files = files_of_map(saved_file_), unit = unit_](JobControl& control) {
    return verified_map(*unit, control, files);
  };
  task_.start("reading the map back", work,
              [this, files = files_of_map(saved_file_)](const Result<VerifiedMap>& verified) {
                if (!verified) return say_failed("reading the map back", verified.error());
                take_verdict(*verified);
                note_on_unit(*unit_, {"map", "verify", path_word(files.map), "--params", path_word(files.parameters)},
                             verdict_->same() ? 0 : 1);
                message_.say(
                    verdict_->same() ? "the unit holds this map and its parameters" : "the unit does not hold this map",
                    verdict_->same() ? Tone::good : Tone::bad);
              });
}

bool LaserController::may_compensate() {
  if (!idle()) return false;
  if (!verdict_ && !sent_)
    message_.say("not known which map the unit holds: Enter compares it with the file first", Tone::bad);
  else if (verdict_ && !verdict_->same())
    message_.say("the unit does not hold the map of the file: step 8 sends it, then Enter compares again", Tone::bad);
  else
    return true;
  return false;
}

void LaserController::compensate() {
  if (!may_compensate()) return;
  const ExpectedMap expected{compared_ ? std::nullopt : sent_, compared_};
  const auto work = [expected, unit = unit_](JobControl& control) {
    return switch_to_compensation(*unit, control, expected);
  };
  task_.start("compensation mode", work, [this](const Result<void>& switched) {
    if (!switched) return say_failed("compensation mode", switched.error());
    note_on_unit(*unit_, {"utility", "mode", "compensate", "--wait", "0"});
    message_.say(
        "the unit watches: reference every axis at the control now; ECS UTILITY, DISPLAY ECS STATUS shows how far it "
        "is (emulator: g there)");
  });
}

void LaserController::forget_verdict() {
  verdict_.reset();
  compared_.reset();
  compared_csv_.clear();
  stale_.clear();
  unit_time_us_ = 0;
  ++comparison_;
}

void LaserController::take_verdict(const VerifiedMap& verified) {
  forget_verdict();
  verdict_ = verified.verdict;
  compared_ = verified.holding;
  compared_csv_ = saved_csv_;
  next_verdict_look_ = Clock::now() + kBetweenUnitLooks;
}

void LaserController::say_stale(const std::string& why) {
  stale_ = why;
  if (!message_.is_problem() || message_.text().empty())  // an error stays until the next action
    message_.say("the unit has changed since it was compared: " + why + "; step 9, Enter compares again",
                 Tone::warning);
}

bool LaserController::note_changes() {
  if (!compared_ || !stale_.empty()) return false;
  const WatchedUnit unit = unit_->snapshot();
  UnitHolding now = *compared_;
  if (unit.identity) now.serial_number = unit.identity->serial_number;
  now.opened_at = unit.opened_at;
  std::string why = unit.open ? changed_since(*compared_, now) : "the link to it was lost";
  if (const auto sample = unit_->newest(); sample && why.empty()) {
    if (sample->unit_time_us < unit_time_us_) why = "it was restarted";
    unit_time_us_ = std::max(unit_time_us_, sample->unit_time_us);
  }
  if (why.empty()) return false;
  say_stale(why);
  return true;
}

void LaserController::watch_verdict() {
  if (!compared_ || !stale_.empty() || task_.running() || looking_.running()) return;
  if (Clock::now() < next_verdict_look_ || !unit_->snapshot().open) return;
  const auto look = [unit = unit_](JobControl& control) { return holding_of_unit(*unit, control); };
  looking_.start("looking at the unit", look, [this, comparison = comparison_](const Result<UnitHolding>& now) {
    next_verdict_look_ = Clock::now() + kBetweenUnitLooks;
    if (comparison != comparison_ || !now || !compared_ || !stale_.empty()) return;
    if (const std::string why = changed_since(*compared_, *now); !why.empty()) say_stale(why);
  });
}

}  // namespace ecs::commissioning
