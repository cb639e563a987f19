#include "commissioning/utility/datum_record_controller.hpp"

#include <fmt/format.h>

#include "base/clock.hpp"
#include "commissioning/link/unit_commands.hpp"
#include "commissioning/utility/datum_view_controller.hpp"
#include "commissioning/utility/emulated_machine.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::chrono::milliseconds kRecordLimit{30'000};

Result<DatumRecording> recorded(UnitLink& link, Axis axis, DatumLive& live) {
  ECS_TRY(identity, link.client().identity());
  live.begin(link, axis);
  ECS_TRY(result, link.client().record_datum(
                      axis, kRecordLimit, [&](const protocol::CommandResult& busy) { live.look(link, busy, false); }));
  auto recording = read_recording(link.client(), result.value,
                                  [&live](const protocol::Progress& progress) { live.fetch(progress); });
  live.end();
  if (!recording) return recording;
  recording->taken = now_utc();
  recording->serial_number = identity.serial_number;
  return recording;
}

}  // namespace

DatumRecordController::DatumRecordController(std::shared_ptr<UnitConnection> connection)
    : connection_(connection), watching_(std::move(connection)) {
  (void)unit_.look(*connection_);
}

Question DatumRecordController::question(Axis axis) const {
  const std::string unsaved = unsaved_record_of();
  return {
      fmt::format("Record axis {} for {:.0f} seconds?", letter_of(axis), kDatumRecord_s),
      fmt::format("The unit opens its relays and only watches. Let the machine's control reference axis {} as soon as "
                  "the bar runs: the whole sequence must fit into the {:.0f} seconds. Begin some travel away from the "
                  "reference switch.{}{}",
                  letter_of(axis), kDatumRecord_s, emulator() ? " This is the emulator: g references its machine." : "",
                  unsaved.empty() ? "" : " The record of " + unsaved + " was not saved: this one takes its place."),
      "record", "not now"};
}

void DatumRecordController::start(Axis axis) {
  if (busy()) return;
  axis_ = axis;
  switch_seen_ = false;
  marker_seen_ = false;
  referenced_ = false;
  const auto work = [connection = connection_, live = live_, axis](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) { return recorded(link, axis, *live); });
  };
  task_.start("recording", work, [this](Result<DatumRecording> recording) {
    if (!recording) return say_failed(message_, recording.error(), task_.cancelled());
    recorded_ = std::move(*recording);
    NotedCommand command;  // saving the record amends it (datum_view_controller.cpp)
    command.words = words_on_unit(*connection_, {"utility", "datum", "record", std::string(1, letter_of(axis_))});
    if (referenced_) command.meanwhile = reference_words(live_->now().workshop, {axis_});
    note(std::move(command));
  });
}

void DatumRecordController::reference() {
  const auto seen = live_->now();
  if (!busy() || phase() != Phase::recording)
    message_.say("g references the emulated machine while the record runs: Enter first.", Tone::warning);
  else if (seen.workshop.empty())
    message_.say("This is a real unit: reference the axis at the machine's own control.", Tone::warning);
  else
    reference_machine(reference_, seen.workshop, {axis_}, message_, referenced_ = true);
}

void DatumRecordController::cancel() {
  task_.cancel();
  reference_.cancel();
}

DatumRecordController::Phase DatumRecordController::phase() const {
  if (!busy()) return Phase::ready;
  const auto seen = live_->now();
  if (seen.fetching) return Phase::fetching;
  return seen.running ? Phase::recording : Phase::starting;
}

double DatumRecordController::part() const { return live_->now().part; }

double DatumRecordController::seconds_left() const {
  const auto seen = live_->now();
  return seen.fetching ? seen.seconds_left : (1.0 - seen.part) * kDatumRecord_s;
}

void DatumRecordController::follow_live() {
  const auto seen = live_->now();
  if (seen.changes == live_changes_ || !busy()) return;
  live_changes_ = seen.changes;
  if (!seen.sample) return;
  unit_.take(*seen.sample);
  const protocol::AxisSample& axis = seen.sample->axes[index_of(axis_)];
  switch_seen_ = switch_seen_ || axis.switch_active;
  marker_seen_ = marker_seen_ || axis.marker;
}

bool DatumRecordController::advance() {
  bool changed = unit_.look(*connection_) || busy();
  follow_live();
  changed = reference_.advance() || changed;
  return task_.advance() || changed;
}

std::optional<DatumRecording> DatumRecordController::take() {
  std::optional<DatumRecording> record;
  record.swap(recorded_);
  return record;
}

}  // namespace ecs::commissioning
