// RECORD DATUM SEQUENCE: ten seconds of one axis out of the unit, while its control references the machine.
#pragma once

#include <memory>
#include <optional>

#include "commissioning/session/task_runner.hpp"
#include "commissioning/unit/datum_recording.hpp"
#include "commissioning/utility/datum_live.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::commissioning {

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

}  // namespace ecs::commissioning
