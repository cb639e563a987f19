// RECORD DATUM SEQUENCE: ten seconds of one axis out of the unit while its control references the machine. TEST DATUM
// ROUTINE: the unit's own routine, axis after axis, with the stage in which each stands.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "commissioning/link/unit_link.hpp"
#include "commissioning/session/task_runner.hpp"
#include "commissioning/unit/datum_recording.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::commissioning {

/// What work on the link tells its screen while it has the link to itself: the newest sample and status, and where the
/// bundled emulator's workshop is.
class DatumLive {
 public:
  struct Seen {
    std::optional<protocol::MonitorSample> sample;
    std::optional<protocol::UnitStatus> status;
    std::string workshop;  ///< socket; empty: no emulator
    std::optional<Axis> axis;
    bool running = false;      ///< the unit has answered that it is at it
    bool fetching = false;     ///< the command is done, its result is read out of the memory
    double part = 0.0;         ///< of the command under way, or of what is fetched, 0 … 1
    double seconds_left = -1;  ///< of what is fetched; negative: not known
    std::uint64_t changes = 0;
  };
  /// Begins work on an axis.
  void begin(UnitLink& link, Axis axis) {
    const std::lock_guard lock(mutex_);
    seen_.workshop = link.workshop();
    seen_.axis = axis;
    seen_.running = false;
    seen_.fetching = false;
    seen_.part = 0.0;
    seen_.seconds_left = -1;
    ++seen_.changes;
  }
  /// One look over the link; what fails is left to the command that is under way.
  void look(UnitLink& link, const protocol::CommandResult& busy, bool with_status) {
    auto sample = link.client().monitor();
    std::optional<protocol::UnitStatus> status;
    if (with_status)
      if (auto read = link.client().status()) status = *read;
    const std::lock_guard lock(mutex_);
    if (sample) seen_.sample = *sample;
    if (status) seen_.status = *status;
    seen_.running = true;
    seen_.part = busy.per_mille / 1000.0;
    ++seen_.changes;
  }
  void fetch(const protocol::Progress& progress) {
    const std::lock_guard lock(mutex_);
    seen_.fetching = true;
    if (progress.bytes_total > 0)
      seen_.part = static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total);
    seen_.seconds_left = progress.seconds_left;
    ++seen_.changes;
  }
  void end() {
    const std::lock_guard lock(mutex_);
    seen_.axis.reset();
    seen_.running = false;
    ++seen_.changes;
  }
  [[nodiscard]] Seen now() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  mutable std::mutex mutex_;
  Seen seen_;
};

class DatumRecordController {
 public:
  enum class Phase { ready, starting, recording, fetching };
  explicit DatumRecordController(std::shared_ptr<UnitConnection> connection);

  [[nodiscard]] Question question(Axis axis) const;
  void start(Axis axis);
  /// The bundled emulator's machine references the axis that is recorded; the message says why not.
  void reference();
  void cancel();
  [[nodiscard]] bool busy() const { return task_.running(); }
  [[nodiscard]] Phase phase() const;
  [[nodiscard]] bool referencing() const { return reference_.running(); }
  /// @return whether anything changed
  [[nodiscard]] bool advance();
  /// The record, once.
  [[nodiscard]] std::optional<DatumRecording> take();

  [[nodiscard]] const UnitView& unit() const { return unit_; }
  [[nodiscard]] Axis axis() const { return axis_; }  ///< recorded now or last
  [[nodiscard]] double part() const;                 ///< of the phase, 0 … 1
  [[nodiscard]] double seconds_left() const;         ///< of the phase; negative: not known
  [[nodiscard]] bool switch_seen() const { return switch_seen_; }
  [[nodiscard]] bool marker_seen() const { return marker_seen_; }
  [[nodiscard]] bool emulator() const { return unit_.watched.emulator; }
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  void follow_live();

  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  UnitView unit_;
  std::shared_ptr<DatumLive> live_ = std::make_shared<DatumLive>();
  std::uint64_t live_changes_ = 0;
  Axis axis_ = Axis::X;
  bool switch_seen_ = false;
  bool marker_seen_ = false;
  bool referenced_ = false;  ///< the emulated machine, while it records
  std::optional<DatumRecording> recorded_;
  Message message_;
  TaskRunner reference_;
  TaskRunner task_;
};

class DatumTestController {
 public:
  enum class TestState { not_chosen, chosen, under_way, passed, failed, given_up };
  struct AxisRow {
    Axis axis = Axis::X;
    TestState state = TestState::chosen;
    DatumStage stage = DatumStage::waiting;  ///< as the unit reported last
    std::string message;                     ///< of one that failed
  };

  explicit DatumTestController(std::shared_ptr<UnitConnection> connection);

  void toggle(Axis axis);  ///< whether it is tested
  [[nodiscard]] Question question() const;
  void start();
  /// The bundled emulator's machine references the axis under test, and each of the following when its turn comes.
  void reference();
  void cancel();
  [[nodiscard]] bool busy() const { return task_.running(); }
  [[nodiscard]] bool referencing() const { return reference_.running(); }
  [[nodiscard]] bool advance();

  [[nodiscard]] const std::vector<AxisRow>& rows() const { return rows_; }
  [[nodiscard]] std::optional<Axis> under_test() const { return under_test_; }
  [[nodiscard]] const UnitView& unit() const { return unit_; }
  [[nodiscard]] bool emulator() const { return unit_.watched.emulator; }
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  /// What is reported from the thread of the work.
  struct FinishedTests {
    std::mutex mutex;
    std::vector<AxisTest> tests;
  };
  void fill_rows();
  void follow_live();
  void follow_tests();
  void take(const Result<void>& result);
  AxisRow* row_of(Axis axis);

  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  UnitView unit_;
  std::vector<AxisRow> rows_;
  std::optional<Axis> under_test_;
  std::optional<Axis> referenced_for_;  ///< the axis for which the emulated machine was started last
  bool reference_each_ = false;
  std::shared_ptr<DatumLive> live_ = std::make_shared<DatumLive>();
  std::uint64_t live_changes_ = 0;
  std::shared_ptr<FinishedTests> finished_ = std::make_shared<FinishedTests>();
  std::size_t tests_seen_ = 0;
  Message message_;
  TaskRunner reference_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
