// What came of the work of the laser controller. Does not live here: starting it (controller.cpp).
#include <fmt/format.h>

#include "commissioning/laser_session/controller.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kBetweenLooks{1};

}  // namespace

bool LaserController::advance() {
  bool changed = false;
  if (auto work = working_out_.take()) {
    changed = true;
    work_ = std::move(*work);
    if (pending_)
      work_out(false);
    else if (map_pending_)
      work_out(true);
  }
  if (auto done = job_.take()) {
    changed = true;
    take(*done);
  } else if (job_.running() && job_.part() != part_shown_) {
    part_shown_ = job_.part();
    changed = true;
  }
  look_after_failure();
  changed = take_look() || changed;
  return note_changes() || changed;
}

void LaserController::say_saved(const MapFiles& files) {
  message_.say(fmt::format("saved: {}, its parameters {}, the recipe {}", files.map, files.parameters, files.recipe));
}

void LaserController::take(const Done& done) {
  if (!done.csv.empty() && !done.files.map.empty()) {
    saved_csv_ = done.csv;
    saved_file_ = done.files.map;
    if (work_->map.csv == done.csv) changed_ = false;
  }
  if (done.problem) return take_failure(done);
  switch (done.doing) {
    case Doing::saving:
      say_saved(done.files);
      break;
    case Doing::preparing:
      ready_ = done.ready;
      break;
    case Doing::sending:
      sent_ = done.sent;
      sent_csv_ = saved_csv_;
      ready_.reset();
      message_.say(fmt::format("sent to unit {} and read back: {} bytes in {:.1f} s, block check {:08X}",
                               sent_->identity.serial_number, sent_->report.bytes, sent_->seconds, sent_->check));
      break;
    case Doing::verifying:
      take_verdict(*done.verified);
      message_.say(verdict_->same() ? "the unit holds this map and its parameters" : "the unit does not hold this map",
                   verdict_->same() ? Tone::good : Tone::bad);
      break;
    case Doing::receiving:
      message_.say("parameters of the unit written to " + done.params_file);
      change("parameters of the unit", [&](LaserChoices& c) { c.params_file = done.params_file; });
      read_again();
      break;
    case Doing::switching:
      message_.say(
          "the unit watches: reference every axis at the control now; ECS UTILITY, DISPLAY ECS STATUS shows how far it "
          "is (emulator: g there)");
      break;
    case Doing::looking: {
      const std::string now = done.active ? fmt::format("block check {:08X}", *done.active) : "none";
      const std::uint32_t new_check = failed_ ? failed_->check : 0;
      if (done.active && *done.active == new_check)
        after_failure_ = "The unit has taken the new map after all (" + now + "). Step 9 compares it byte by byte.";
      else if (failed_ && done.active == failed_->active)
        after_failure_ = done.active ? "The unit answers: the map it had before is still active and whole (" + now +
                                           "). Enter sends again."
                                     : "The unit answers: it holds no map, as before. Enter sends again.";
      else
        after_failure_ = "The unit answers; it holds another map than before (" + now + "). Enter sends again.";
      message_.say(after_failure_, Tone::warning);
      failed_.reset();
      break;
    }
  }
}

void LaserController::take_failure(const Done& done) {
  const std::string why = to_text(*done.problem);
  next_look_ = Clock::now() + kBetweenLooks;
  switch (done.doing) {
    case Doing::sending:
      ready_.reset();
      failed_ = done.ready;
      after_failure_ = seen_->begun ? "The unit keeps the map it had until a new one is whole. As soon as it answers, "
                                      "it is asked which map is active."
                                    : "Nothing was sent: the unit keeps the map it had.";
      message_.say("not sent: " + why, Tone::bad);
      break;
    case Doing::preparing:
      message_.say((done.csv.empty() ? "not saved: " : "saved, but not sent: ") + why, Tone::bad);
      break;
    case Doing::looking:
      break;  // the next look comes by itself
    default:
      message_.say(busy_with_ + ": " + why, Tone::bad);
  }
}

void LaserController::look_after_failure() {
  if (!failed_ || job_.running() || Clock::now() < next_look_ || !unit_->snapshot().open) return;
  next_look_ = Clock::now() + kBetweenLooks;
  start(Doing::looking, "looking at the unit", [unit = unit_](JobControl& control, SendProgress&, Done& done) {
    const auto holding = holding_of_unit(*unit, control);
    if (holding)
      done.active = holding->check;
    else
      done.problem = holding.error();
  });
}

}  // namespace ecs::commissioning
