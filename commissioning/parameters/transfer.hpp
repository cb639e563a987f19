// Looking into the unit, receiving and sending as the parameters screen does them: beside the screen, asking before
// anything is overwritten. Does not live here: what is said over the line (unit.hpp), drawing.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/parameters/controller.hpp"
#include "commissioning/session/job.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::commissioning {

/// A question and what follows a yes.
struct Asking {
  Question question;
  std::function<void()> yes;
};

class ParametersTransfer {
 public:
  explicit ParametersTransfer(std::shared_ptr<UnitConnection> line) : line_(std::move(line)) {}

  /// @pre !running(), and nothing stands against the set (cross-check)
  void send(const ParametersController& controller);
  /// @pre !running()
  void receive();
  /// What the unit holds, for comparing; by itself it is done whenever the line was opened.
  void look() { looked_at_.reset(); }

  [[nodiscard]] bool running() const { return reading_.running() || sending_.running(); }
  void cancel();
  [[nodiscard]] bool sending() const { return sending_.running(); }
  [[nodiscard]] double part() const { return sending_.part(); }  ///< sent, 0 … 1
  /// Estimated from what is sent; negative: not known.
  [[nodiscard]] double seconds_left() const;
  [[nodiscard]] const UnitConnection& line() const { return *line_; }

  /// Takes what arrived into the controller, says what happened. @return whether anything changed
  [[nodiscard]] bool advance(ParametersController& controller, Message& message);
  /// To be asked now, once.
  [[nodiscard]] std::optional<Asking> take_question() { return std::exchange(asking_, std::nullopt); }

 private:
  enum class Reading { to_receive, to_send };
  void read(Reading purpose, bool switching);
  void look_when_opened();
  void take_read(ParametersController& controller, Message& message, Result<UnitContent> unit);
  void ask_to_switch(const UnitContent& unit);
  void ask_to_send(const ParametersController& controller);
  void start_sending(const params::Identity& owner, UnfitMap unfit);
  void take_sent(ParametersController& controller, Message& message, Result<SentParameters> sent);

  std::shared_ptr<UnitConnection> line_;
  Job<Result<UnitContent>> looking_;                                ///< by itself
  std::optional<std::chrono::steady_clock::time_point> looked_at_;  ///< the opening of the line that was looked at
  Job<Result<UnitContent>> reading_;
  Reading purpose_ = Reading::to_receive;
  Job<Result<SentParameters>> sending_;
  ParameterSet to_send_;
  params::Identity owner_;
  std::chrono::steady_clock::time_point since_{};
  std::optional<Asking> asking_;
};

}  // namespace ecs::commissioning
