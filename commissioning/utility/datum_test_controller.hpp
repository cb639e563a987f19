// TEST DATUM ROUTINE: the unit's own routine, axis after axis, with the stage in which each stands.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "commissioning/session/task_runner.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/datum_live.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::commissioning {

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
