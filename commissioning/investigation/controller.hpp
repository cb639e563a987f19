// An investigation beside a screen: started, watched, stopped, gone on with. Pure state; every action is a function
// that can be called without a terminal.
// Does not live here: the investigation itself (investigation.hpp), how its ledger is drawn (app/screens/model).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "commissioning/investigation/followed.hpp"
#include "commissioning/investigation/investigation.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

struct InvestigationRequest {
  std::string model;     ///< file
  std::string machine;   ///< file
  std::string place;     ///< socket of a workshop, or folder to watch
  double minutes = 0.0;  ///< that the runs may take
  friend bool operator==(const InvestigationRequest&, const InvestigationRequest&) = default;
};

class InvestigationController {
 public:
  /// Goes on with one that was stopped where model, machine and place are the same, else begins anew. @pre !busy()
  /// @param unit  whose link serves where it is the unit of the workshop; null: none
  void start(const InvestigationRequest& request, std::shared_ptr<UnitConnection> unit = {});
  /// What was measured is kept.
  void stop();
  /// Takes what has been finished meanwhile. @return whether anything may have changed
  [[nodiscard]] bool advance();

  [[nodiscard]] bool busy() const { return task_.running(); }
  [[nodiscard]] double seconds_working() const { return task_.seconds(); }
  /// What was started last.
  [[nodiscard]] const std::optional<InvestigationRequest>& request() const { return request_; }
  [[nodiscard]] LedgerView view() const;
  /// Of the last one that came to its end.
  [[nodiscard]] const std::optional<Investigation>& found() const { return found_; }
  /// Writes the model with the causes; refused where that would destroy another file.
  [[nodiscard]] Result<void> write_model(const std::string& file) const;
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  std::optional<InvestigationRequest> request_;
  std::shared_ptr<FollowedInvestigation> followed_;
  std::optional<Investigation> found_;
  Message message_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
