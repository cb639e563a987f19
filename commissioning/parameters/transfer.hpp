// Looking into the unit, receiving and sending as the parameters screen does them: beside the screen, asking before
// anything is overwritten.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/parameters/set.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/fault.hpp"

namespace ecs::commissioning {

class ParametersController;

/// What a unit said of itself at one moment.
struct UnitContent {
  std::string name;  ///< "EMULATOR", or the link
  protocol::Identity identity;
  UnitMode mode = UnitMode::starting;
  std::optional<UnitParameters> parameters;
  std::string none_because;  ///< why there are none: the unit is new, or its memory is corrupt
  std::string tools_beyond;  ///< tools_beyond_range() of the parameters to send, once they are to be sent
};
/// "EMULATOR, unit MCM-0107"
[[nodiscard]] std::string title_of(const UnitContent& unit);

/// A short transfer: identity, state, the parameters without their map.
[[nodiscard]] Result<UnitContent> unit_content(UnitLink& link);

/// Into integration mode, where the unit takes parameters; then what it holds.
[[nodiscard]] Result<UnitContent> switched_to_integration(UnitLink& link);

struct SentParameters {
  SendReport report;
  UnitContent after;  ///< read back
};
/// @param owner  against the header of the unit's map; empty: not judged
[[nodiscard]] Result<SentParameters> sent_to_unit(UnitLink& link, const UnitParameters& parameters,
                                                  const params::Identity& owner, UnfitMap unfit,
                                                  const protocol::ProgressCallback& progress);

/// Whether sending was refused because of the map in the unit, so that dropping the map would help.
[[nodiscard]] bool refused_for_map(const Problem& why);

/// Why the parameters are not for that unit: they state another serial number. Empty: they are, or do not say.
[[nodiscard]] std::string other_unit_sentence(const ParameterSet& set, const UnitContent& unit);

class ParametersTransfer {
 public:
  /// @param controller  takes what arrives  @param message  says what happened; both outlive this
  ParametersTransfer(std::shared_ptr<UnitConnection> connection, ParametersController& controller, Message& message)
      : connection_(std::move(connection)), controller_(&controller), message_(&message) {}

  /// @pre !task().running(), and nothing stands against the set (cross-check)
  void send();
  /// @pre !task().running()
  void receive();
  /// What the unit holds, for comparing; on its own it is done whenever the link was opened.
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
  TaskRunner looking_;                                              ///< on its own
  std::optional<std::chrono::steady_clock::time_point> looked_at_;  ///< the opening of the link that was looked at
  TaskRunner task_;
  ParameterSet to_send_;
  params::Identity owner_;
  bool drops_map_ = false;  ///< of what is being sent
  Asking asking_;
};

}  // namespace ecs::commissioning
