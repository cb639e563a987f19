// A map sent by the laser controller, and a look at the unit after sending failed.
#include <fmt/format.h>

#include "commissioning/laser_session/controller.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kBetweenLooks{1};

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
    message_.say(sent_text(*sent_));
    return;
  }
  next_look_ = Clock::now() + kBetweenLooks;
  failed_ = ready;
  after_failure_ = attempt.begun ? "The unit keeps the map it had until a new one is whole. As soon as it answers, it "
                                   "is asked which map is active."
                                 : "Nothing was sent: the unit keeps the map it had.";
  say_failed("not sent", attempt.sent.error());
}

void LaserController::look_after_failure() {
  if (!failed_ || task_.running() || Clock::now() < next_look_ || !unit_->snapshot().open) return;
  next_look_ = Clock::now() + kBetweenLooks;
  const auto work = [unit = unit_](JobControl& control) { return holding_of_unit(*unit, control); };
  task_.start("looking at the unit", work, [this](const Result<UnitHolding>& holding) {
    next_look_ = Clock::now() + kBetweenLooks;
    if (holding) take_active_after_failure(holding->check);
  });
}

void LaserController::take_active_after_failure(const std::optional<std::uint32_t>& active) {
  const std::string now = active ? fmt::format("block check {:08X}", *active) : "none";
  if (active && failed_ && *active == failed_->check)
    after_failure_ = "The unit has taken the new map after all (" + now + "). Step 9 compares it byte by byte.";
  else if (failed_ && active == failed_->active)
    after_failure_ =
        active ? "The unit answers: the map it had before is still active and whole (" + now + "). Enter sends again."
               : "The unit answers: it holds no map, as before. Enter sends again.";
  else
    after_failure_ = "The unit answers; it holds another map than before (" + now + "). Enter sends again.";
  message_.say(after_failure_, Tone::warning);
  failed_.reset();
}

}  // namespace ecs::commissioning
