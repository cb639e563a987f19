// SET AXIS POSITION: what is asked of the unit, what it showed before and after, and the way back. OUTPUT COMPENSATION
// VALUE: one axis's D/A value and relay, what moves by it, and the way back to rest; whoever goes leaves the unit at
// rest as far as the link allows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/utility/unit_view.hpp"
#include "core/parameters.hpp"

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

/// What the unit puts out.
struct OutputSetting {
  Axis axis = Axis::X;
  double um = 0.0;
  bool relay = false;
  [[nodiscard]] bool at_rest() const { return um == 0.0 && !relay; }
  friend bool operator==(const OutputSetting&, const OutputSetting&) = default;
};

/// "+5 um", "0 um"
[[nodiscard]] std::string um_text(double um);

/// What an output scale should be, from what was put out and what a dial gauge showed.
struct ScaleProposal {
  double counts_per_um = 0.0;  ///< above 0
  int polarity = 1;            ///< compensation polarity
  std::string sentence;        ///< for the user, with the names of the parameters
};
/// @param measured_um  movement of the axis when `um` were put out, signed as the axis's coordinate; a usage problem
/// where no scale follows from them
[[nodiscard]] Result<ScaleProposal> scale_from(const AxisParameters& axis, Axis name, double um, double measured_um);

class OutputController {
 public:
  explicit OutputController(std::shared_ptr<UnitConnection> connection);
  OutputController(const OutputController&) = delete;
  OutputController& operator=(const OutputController&) = delete;
  ~OutputController();  ///< waits until the unit has heard that everything is off, if there is a link

  /// A number within the output limit of the axis; a usage problem otherwise.
  [[nodiscard]] Result<double> value_in(const std::string& typed) const;
  /// What closing the relay with this value, or this value with the relay closed, moves.
  [[nodiscard]] Question question(double um) const;

  /// From what a dial gauge showed for the value that is put out now.
  [[nodiscard]] Result<ScaleProposal> scale_from_measured(const std::string& typed_um) const;

  void choose(Axis axis);  ///< only at rest: otherwise the message says what to do
  void set(double um, bool relay);
  void step(int direction);  ///< by step_um(), with the relay as it is
  void resize_step(int direction);
  void off();  ///< every output 0, every relay open; what is under way is given up for it
  [[nodiscard]] bool busy() const { return task_.running(); }
  /// @return whether anything changed
  [[nodiscard]] bool advance();

  [[nodiscard]] const UnitView& unit() const { return unit_; }
  [[nodiscard]] Axis axis() const { return setting_.axis; }
  [[nodiscard]] const OutputSetting& setting() const { return setting_; }  ///< as the unit took it last
  [[nodiscard]] double step_um() const;
  [[nodiscard]] const AxisParameters& parameters() const { return parameters_.axes[index_of(setting_.axis)]; }
  [[nodiscard]] bool parameters_known() const { return parameters_known_; }  ///< read from the unit; else its defaults
  /// The axis's transducer since the output was at rest, um; nothing before anything was put out.
  [[nodiscard]] std::optional<double> moved_um() const;
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  struct Taken {
    OutputSetting setting;
    std::optional<protocol::MonitorSample> before;  ///< just before the command
  };
  void start(const std::string& label, std::function<Result<Taken>(JobControl&)> work);
  void take(const Result<Taken>& taken);
  void follow_unit();
  void follow_value();
  void renew();
  void start_reading_parameters();

  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  UnitView unit_;
  OutputSetting setting_;
  int step_ = 2;  ///< place in the row of steps
  std::optional<double> rest_mm_;
  UnitParameters parameters_;
  bool parameters_known_ = false;
  std::chrono::steady_clock::time_point parameters_of_{};  ///< the link that they were asked on
  int restarts_ = 0;
  std::chrono::steady_clock::time_point sent_at_{};  ///< when the unit took `setting_`
  std::uint64_t times_lost_ = 0;                     ///< links, as far as it was reported
  bool off_wanted_ = false;
  Message message_;
  TaskRunner task_;
  TaskRunner reading_;  ///< the unit's parameters
};

}  // namespace ecs::commissioning
