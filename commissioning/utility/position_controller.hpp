// SET AXIS POSITION: what is asked of the unit, what it showed before and after, and the way back.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commissioning/utility/unit_view.hpp"

namespace ecs::commissioning {

/// A position that was preset; positions as the unit showed them.
struct PresetPosition {
  Axis axis = Axis::X;
  double before_mm = 0.0;
  double after_mm = 0.0;
};

class PositionController {
 public:
  static constexpr double kLargest_mm = 1e6;  ///< as the unit takes them
  explicit PositionController(std::shared_ptr<UnitConnection> connection);

  /// A number within ±kLargest_mm; a usage problem otherwise.
  [[nodiscard]] static Result<double> position_in(const std::string& typed);
  /// What presetting it means, from what is known of the axis.
  [[nodiscard]] Question question(Axis axis, double position_mm) const;

  void set(Axis axis, double position_mm);
  /// Shifts the axis preset last back by what it was shifted.
  void undo();
  void cancel() { task_.cancel(); }
  [[nodiscard]] bool busy() const { return task_.running(); }
  /// Takes what has come meanwhile. @return whether anything changed
  [[nodiscard]] bool advance();

  [[nodiscard]] const UnitView& unit() const { return unit_; }
  [[nodiscard]] const std::vector<PresetPosition>& done() const { return done_; }  ///< that can be undone, newest last
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  struct Change {
    PresetPosition preset;
    bool is_undo = false;
  };
  void start(Axis axis, double position_mm, bool is_undo, double shift_mm);
  void take(const Result<Change>& change);

  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  UnitView unit_;
  std::vector<PresetPosition> done_;
  int restarts_ = 0;
  Message message_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
