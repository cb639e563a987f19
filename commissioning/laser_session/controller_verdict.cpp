// The map read back from the unit: the verdict, whether it still holds, compensation with it.
// Does not live here: the talk with the unit (commissioning/laser_session/unit_work.cpp), other work (controller.cpp).
#include <algorithm>

#include <fmt/format.h>

#include "commissioning/laser_session/controller.hpp"

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
  start(Doing::verifying, "reading the map back",
        [files = files_of_map(saved_file_), unit = unit_](JobControl& control, SendProgress& seen, Done& done) {
          auto verified = verified_map(*unit, control, files, seen);
          if (verified)
            done.verified = std::move(*verified);
          else
            done.problem = verified.error();
        });
}

void LaserController::compensate() {
  if (!idle()) return;
  if (!verdict_ && !sent_)
    return message_.say("not known which map the unit holds: Enter compares it with the file first", Tone::bad);
  if (verdict_ && !verdict_->same())
    return message_.say("the unit does not hold the map of the file: step 8 sends it, then Enter compares again",
                        Tone::bad);
  start(Doing::switching, "compensation mode",
        [expected = ExpectedMap{compared_ ? std::nullopt : sent_, compared_}, unit = unit_](JobControl& control,
                                                                                            SendProgress&, Done& done) {
          const auto switched = switch_to_compensation(*unit, control, expected);
          if (!switched) done.problem = switched.error();
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
  if (!compared_ || !stale_.empty() || job_.running() || look_.running()) return;
  if (Clock::now() < next_verdict_look_ || !unit_->snapshot().open) return;
  look_.start([unit = unit_, comparison = comparison_](JobControl& control) {
    return Look{comparison, holding_of_unit(*unit, control)};
  });
}

bool LaserController::take_look() {
  const auto look = look_.take();
  if (!look) return false;
  next_verdict_look_ = Clock::now() + kBetweenUnitLooks;
  if (look->comparison != comparison_ || !look->now || !compared_ || !stale_.empty()) return false;
  const std::string why = changed_since(*compared_, *look->now);
  if (why.empty()) return false;
  say_stale(why);
  return true;
}

}  // namespace ecs::commissioning
