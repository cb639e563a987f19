// An investigation as somebody watches it: its steps, the run under way, what was said, as rows of a screen too (a
// falling staircase of the causes that are still possible); and the readings it was given, so that one that was stopped
// goes on where it was. Does not live here: the ledger as text of a verb (investigation.hpp), its file (workshops.hpp).
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "commissioning/session/message.hpp"
#include "modules/investigation/investigation.hpp"

namespace ecs::commissioning {

struct InvestigationProgress {
  std::vector<InvestigationStep> steps;
  std::string doing;              ///< "run 3: Measure EX along X, …"; empty: nothing is measured
  std::vector<std::string> said;  ///< notes and warnings, newest last
};

/// What an investigation leaves behind when it is stopped; its functions may be called from any thread.
class FollowedInvestigation final : public MessageSink {
 public:
  void note(std::string_view text) override;
  void warn(std::string_view text) override;

  [[nodiscard]] InvestigationProgress progress() const;
  /// Forgets what was said; steps and readings stay.
  void forget_messages();

 private:
  friend class FollowedWorkshop;
  mutable std::mutex mutex_;
  InvestigationProgress progress_;
  std::map<std::pair<int, std::string>, RunReadings> given_;  ///< by number of the run and what was asked for
};

/// Another workshop, followed. A run that was measured before the investigation was stopped is not measured again.
class FollowedWorkshop final : public Workshop {
 public:
  /// @param changed  called after every change, in the thread of the investigation; may be empty
  FollowedWorkshop(FollowedInvestigation& followed, Workshop& workshop, std::function<void()> changed = {})
      : followed_(followed), workshop_(workshop), changed_(std::move(changed)) {}

  [[nodiscard]] Result<RunReadings> measure(const RequestedRun& run) override;
  [[nodiscard]] Result<void> activate(const model::Model& model) override;
  void keep(const InvestigationStep& step) override;

 private:
  void say_doing(std::string text);

  FollowedInvestigation& followed_;
  Workshop& workshop_;
  std::function<void()> changed_;
  std::size_t kept_ = 0;  ///< steps of this investigation
};

struct LedgerRow {
  std::string numbers;      ///< number, minutes, minutes in all, rms, members left; below ledger_numbers_head()
  std::size_t members = 0;  ///< left in the set; 0: nothing is named
  bool settled = false;     ///< one cause is left, or nothing is missing
  std::string measured;
};

struct LedgerView {
  std::vector<LedgerRow> rows;
  std::string set;    ///< "sag:X:EX 0.97, progressive:X:EX 0.03"; what the last verdict is where it is empty
  std::string doing;  ///< empty: nothing
  std::vector<std::string> said;  ///< newest last
};

[[nodiscard]] LedgerView view_of(const InvestigationProgress& progress);

/// The view as lines that fit `columns`, bars as '#'; for a terminal that is redrawn.
[[nodiscard]] std::vector<std::string> lines_of(const LedgerView& view, std::size_t columns);

}  // namespace ecs::commissioning
