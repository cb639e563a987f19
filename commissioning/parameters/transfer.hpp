// Looking into the unit, receiving and sending as the parameters screen does them: beside the screen, asking before
// anything is overwritten.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/parameters/controller.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

class ParametersTransfer {
 public:
  /// @param controller  takes what arrives  @param message  says what happened; both outlive this
  ParametersTransfer(std::shared_ptr<UnitConnection> connection, ParametersController& controller, Message& message)
      : connection_(std::move(connection)), controller_(&controller), message_(&message) {}

  /// @pre !task().running(), and nothing stands against the set (cross-check)
  void send();
  /// @pre !task().running()
  void receive();
  /// What the unit holds, for comparing; by itself it is done whenever the link was opened.
  void look() { looked_at_.reset(); }
  void cancel() { task_.cancel(); }
  [[nodiscard]] const TaskRunner& task() const { return task_; }  ///< receiving, sending
  [[nodiscard]] bool sending() const;
  [[nodiscard]] const UnitConnection& connection() const { return *connection_; }

  /// @return whether anything changed
  [[nodiscard]] bool advance();
  /// To be asked now, once.
  [[nodiscard]] Asking take_question() { return std::exchange(asking_, {}); }

 private:
  void look_when_opened();
  void read_to_send(bool switching);
  void say_no_exchange(const Problem& why);
  void take_read_to_send(UnitContent unit);
  void ask_to_switch(const UnitContent& unit);
  void ask_to_send();
  void start_sending(const params::Identity& owner, UnfitMap unfit);
  void take_sent(Result<SentParameters> sent);

  std::shared_ptr<UnitConnection> connection_;
  ParametersController* controller_;
  Message* message_;
  TaskRunner looking_;                                              ///< by itself
  std::optional<std::chrono::steady_clock::time_point> looked_at_;  ///< the opening of the link that was looked at
  TaskRunner task_;
  ParameterSet to_send_;
  params::Identity owner_;
  bool drops_map_ = false;  ///< of what is being sent
  Asking asking_;
};

}  // namespace ecs::commissioning
