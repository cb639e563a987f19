// An investigation on the MODEL screen: begun, watched, stopped, gone on with, its model written. Pure state; every
// action is a function that can be called without a terminal.
// Does not live here: the investigation itself (investigation.hpp), how its ledger is drawn (app/screens/model).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "commissioning/model_session/controller.hpp"
#include "commissioning/session/commands.hpp"
#include "modules/investigation/followed.hpp"
#include "modules/investigation/investigation.hpp"

namespace ecs::commissioning {

/// What comes of an action the message of the model's controller tells.
class InvestigationController {
 public:
  /// @param model  outlives it
  explicit InvestigationController(ModelController& model) : model_(model) {}

  /// Whether an investigation can begin; says why not.
  [[nodiscard]] bool may_begin();
  /// Socket of the workshop around the emulated machine of the link; empty: none.
  [[nodiscard]] std::string emulated_workshop() const;
  /// Where it works: as typed, the socket of a workshop or a folder for readings; empty: the emulated machine of the
  /// link. Nothing: there is none, or it is another machine than the model's; the message says so.
  [[nodiscard]] std::optional<std::string> place_of(const std::string& typed);
  /// Asks a workshop for one run after the other; goes on where one at that place was stopped, else begins anew. The
  /// link of the screens serves where it is to the unit of the workshop.
  /// @param minutes  that the runs may take
  void start(const std::string& place, const std::string& minutes);
  /// Writes the model with the causes; refused where that would destroy another file.  @pre found()
  void write_model(const std::string& file);

  [[nodiscard]] bool was_begun() const { return followed_ != nullptr; }
  [[nodiscard]] const std::string& place() const { return place_; }  ///< of the last one; empty: none was begun
  [[nodiscard]] double minutes() const { return minutes_; }          ///< of the last one, else the usual
  [[nodiscard]] LedgerView view() const;
  /// Of the last one that came to its end.
  [[nodiscard]] const std::optional<Investigation>& found() const { return found_; }

 private:
  [[nodiscard]] NotedCommand command(const std::string& file) const;
  void take(Result<Investigation> investigation);

  ModelController& model_;
  std::string place_;
  double minutes_ = 240.0;
  std::shared_ptr<FollowedInvestigation> followed_;
  std::optional<Investigation> found_;
  std::size_t noted_ = 0;  ///< place of the command of what was found
};

}  // namespace ecs::commissioning
