#include "commissioning/utility/datum.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/utility/datum_view.hpp"
#include "commissioning/utility/unit_view.hpp"

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

namespace {

constexpr std::chrono::milliseconds kLimit{620'000};  ///< the unit gives up by itself after 600 s

}  // namespace

DatumTestController::DatumTestController(std::shared_ptr<UnitConnection> connection)
    : connection_(connection), watching_(std::move(connection)) {
  (void)unit_.look(*connection_);
  fill_rows();
}

void DatumTestController::fill_rows() {
  const auto axes = unit_.axes();
  if (busy() || axes.size() == rows_.size()) return;
  rows_.clear();
  for (const Axis a : axes) rows_.push_back({a, TestState::chosen, DatumStage::waiting, {}});
}

DatumTestController::AxisRow* DatumTestController::row_of(Axis axis) {
  const auto row = std::find_if(rows_.begin(), rows_.end(), [axis](const AxisRow& r) { return r.axis == axis; });
  return row == rows_.end() ? nullptr : &*row;
}

void DatumTestController::toggle(Axis axis) {
  AxisRow* row = row_of(axis);
  if (row == nullptr || busy()) return;
  row->state = row->state == TestState::not_chosen ? TestState::chosen : TestState::not_chosen;
  row->message.clear();
}

Question DatumTestController::question() const {
  std::string axes;
  for (const AxisRow& row : rows_)
    if (row.state != TestState::not_chosen) axes += fmt::format("{}{}", axes.empty() ? "" : ", ", letter_of(row.axis));
  if (axes.empty()) return {"No axis is chosen", "Space chooses the axis under the cursor.", "well", "well"};
  return {fmt::format("Test the datum routine of {}?", axes),
          fmt::format("The unit opens its relays, forgets the reference of each of these axes and looks for it again "
                      "while the machine's control references it, one axis after the other. The unit moves nothing.{}",
                      emulator() ? " This is the emulator: g references its machine." : ""),
          "test", "not now"};
}

void DatumTestController::start() {
  std::vector<Axis> axes;
  for (AxisRow& row : rows_) {
    if (row.state == TestState::not_chosen) continue;
    row = {row.axis, TestState::chosen, DatumStage::waiting, {}};
    axes.push_back(row.axis);
  }
  if (busy() || axes.empty()) return;
  {
    const std::lock_guard lock(finished_->mutex);
    finished_->tests.clear();
  }
  tests_seen_ = 0;
  reference_each_ = false;
  referenced_for_.reset();
  const auto work = [connection = connection_, live = live_, finished = finished_, axes](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) -> Result<void> {
      for (const Axis axis : axes) {
        live->begin(link, axis);
        ECS_TRY(test, test_datum_of(link.client(), axis, kLimit,
                                    [&](const protocol::CommandResult& busy) { live->look(link, busy, true); }));
        const std::lock_guard lock(finished->mutex);
        finished->tests.push_back(std::move(test));
      }
      return {};
    });
  };
  task_.start("testing", work, [this](const Result<void>& result) { take(result); });
}

void DatumTestController::reference() {
  const auto seen = live_->now();
  if (!busy() || !under_test_) {
    message_.say("g references the emulated machine while the test runs: Enter first.", Tone::warning);
  } else if (seen.workshop.empty()) {
    message_.say("This is a real unit: reference the axis at the machine's own control.", Tone::warning);
  } else {
    reference_each_ = true;
    referenced_for_.reset();
  }
}

void DatumTestController::cancel() {
  task_.cancel();
  reference_.cancel();
}

void DatumTestController::follow_live() {
  const auto seen = live_->now();
  if (!busy() || seen.changes == live_changes_) return;
  live_changes_ = seen.changes;
  under_test_ = seen.running ? seen.axis : std::nullopt;
  if (seen.sample) unit_.take(*seen.sample);
  AxisRow* row = under_test_ ? row_of(*under_test_) : nullptr;
  if (row == nullptr) return;
  row->state = TestState::under_way;
  if (seen.status) row->stage = seen.status->axes[index_of(row->axis)].datum_stage;
}

void DatumTestController::follow_tests() {
  const std::lock_guard lock(finished_->mutex);
  for (; tests_seen_ < finished_->tests.size(); ++tests_seen_) {
    const AxisTest& test = finished_->tests[tests_seen_];
    AxisRow* row = row_of(test.axis);
    if (row == nullptr) continue;
    row->state = test.passed ? TestState::passed : TestState::failed;
    row->stage = test.passed ? DatumStage::done : DatumStage::failed;
    NotedCommand command;
    command.words = words_on_unit(*connection_, {"utility", "datum", "test", std::string(1, letter_of(test.axis)),
                                                 "--wait", fmt::format("{}", kLimit.count() / 1000)});
    command.exit_code = test.passed ? 0 : 1;
    if (referenced_for_ == test.axis) command.meanwhile = reference_words(live_->now().workshop, {test.axis});
    note(std::move(command));
    row->message = test.failure == DatumFailure::none
                       ? test.message
                       : fmt::format("{}. What to do: {}.", ecs::name_of(test.failure), advice_for(test.failure));
  }
}

bool DatumTestController::advance() {
  bool changed = unit_.look(*connection_) || busy();
  fill_rows();
  follow_live();
  follow_tests();
  if (reference_each_ && under_test_ && referenced_for_ != under_test_ && !reference_.running()) {
    referenced_for_ = under_test_;
    reference_machine(reference_, live_->now().workshop, {*under_test_}, message_, true);
  }
  changed = reference_.advance() || changed;
  return task_.advance() || changed;
}

void DatumTestController::take(const Result<void>& result) {
  follow_tests();
  under_test_.reset();
  reference_each_ = false;
  for (AxisRow& row : rows_)
    if (row.state == TestState::under_way) row.state = TestState::given_up;
  if (!result) {
    reference_.cancel();
    return say_failed(message_, result.error(), task_.cancelled());
  }
  const auto failed =
      std::count_if(rows_.begin(), rows_.end(), [](const AxisRow& r) { return r.state == TestState::failed; });
  if (failed == 0)
    message_.say("Every axis that was tested found its datum.");
  else
    message_.say(
        fmt::format("{} failed: see above what to do.", failed == 1 ? "One axis" : fmt::format("{} axes", failed)),
        Tone::bad);
}

}  // namespace ecs::commissioning
