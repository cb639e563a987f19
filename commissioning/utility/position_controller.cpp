#include "commissioning/utility/position_controller.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/link/unit_commands.hpp"

namespace ecs::commissioning {

PositionController::PositionController(std::shared_ptr<UnitConnection> connection)
    : connection_(connection), watching_(std::move(connection)) {
  (void)unit_.look(*connection_);
  restarts_ = unit_.restarts;
}

Result<double> PositionController::position_in(const std::string& typed) {
  const auto number = number_in(typed);
  if (!number) return problem(ProblemKind::usage, fmt::format("expected a position in mm, found \"{}\"", typed));
  if (std::abs(*number) > kLargest_mm)
    return problem(ProblemKind::usage,
                   fmt::format("expected a position within +/-{:.0f} mm, found {}", kLargest_mm, typed));
  return *number;
}

Question PositionController::question(Axis axis, double position_mm) const {
  const protocol::AxisSample* now = unit_.axis(axis);
  const std::string shown = now == nullptr ? "" : fmt::format(" It shows {:.4f} mm now.", now->position_mm);
  const std::string reference =
      now != nullptr && now->referenced
          ? " The axis stays marked as referenced, but its positions are yours from now on: reference the machine "
            "again (compensation mode does) before anything relies on them."
          : " The axis does not become referenced by this: only its reference sequence does that.";
  return {fmt::format("Let the unit show {:.4f} mm for axis {}?", position_mm, letter_of(axis)),
          "Nothing moves: only the number changes, and the unit counts on from there." + shown + reference, "set it",
          "leave it"};
}

void PositionController::set(Axis axis, double position_mm) { start(axis, position_mm, false, 0.0); }

void PositionController::undo() {
  if (done_.empty()) {
    message_.say("Nothing to undo: no position was set here.", Tone::warning);
    return;
  }
  const PresetPosition& last = done_.back();
  start(last.axis, 0.0, true, last.before_mm - last.after_mm);
}

/// @param shift_mm  of an undo: the axis may have moved since, so it is shifted from where it stands
void PositionController::start(Axis axis, double position_mm, bool is_undo, double shift_mm) {
  if (busy()) return;
  const auto work = [connection = connection_, axis, position_mm, is_undo, shift_mm](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) -> Result<Change> {
      ECS_TRY(before, link.client().monitor());
      const double shown_mm = before.axes[index_of(axis)].position_mm;
      const double wanted_mm = is_undo ? shown_mm + shift_mm : position_mm;
      ECS_DO(link.client().set_axis_position(axis, wanted_mm));
      return Change{{axis, shown_mm, wanted_mm}, is_undo};
    });
  };
  task_.start("setting the position", work, [this](const Result<Change>& change) { take(change); });
}

bool PositionController::advance() {
  bool changed = unit_.look(*connection_);
  if (unit_.restarts != restarts_) {
    restarts_ = unit_.restarts;
    if (!done_.empty())
      message_.say("The unit was restarted: it counts from 0 again, and what was set here is gone.", Tone::warning);
    done_.clear();
    changed = true;
  }
  return task_.advance() || changed;
}

void PositionController::take(const Result<Change>& change) {
  if (!change) return message_.say(change.error());
  const PresetPosition& preset = change->preset;
  if (change->is_undo)
    done_.pop_back();
  else
    done_.push_back(preset);
  note_on_unit(*connection_,
               {"utility", "position", std::string(1, letter_of(preset.axis)), shortest(preset.after_mm)});
  message_.say(fmt::format("Axis {} {} {:.4f} mm; it showed {:.4f} mm.{}", letter_of(preset.axis),
                           change->is_undo ? "is back at" : "now shows", preset.after_mm, preset.before_mm,
                           change->is_undo ? "" : " u takes it back."));
}

}  // namespace ecs::commissioning
