// Undo and redo of whatever is edited on a screen.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ecs::commissioning {

/// Steps that were done and those that were taken back, the oldest of many forgotten. `State` is what a step replaced.
template <class State>
class EditHistory {
 public:
  struct Step {
    std::string what;  ///< as undo names it
    State state;       ///< before the step; of one taken back, after it
  };

  /// A new step: what was taken back cannot be done again.
  void did(std::string what, State before) {
    done_.push_back({std::move(what), std::move(before)});
    if (done_.size() > kMost) done_.erase(done_.begin());
    undone_.clear();
  }
  /// A step from before all that was done here; what was taken back stays.
  void did_before(std::string what, State before) { done_.insert(done_.begin(), {std::move(what), std::move(before)}); }
  /// The step that undo() takes back; null: there is none.
  [[nodiscard]] const Step* last() const { return done_.empty() ? nullptr : &done_.back(); }
  /// The step that redo() does again; null: there is none.
  [[nodiscard]] const Step* next() const { return undone_.empty() ? nullptr : &undone_.back(); }
  /// @param now  becomes the state before the last step  @return what it was; nothing: there is none
  [[nodiscard]] std::optional<std::string> undo(State& now) { return step_over(done_, undone_, now); }
  [[nodiscard]] std::optional<std::string> redo(State& now) { return step_over(undone_, done_, now); }
  void clear() {
    done_.clear();
    undone_.clear();
  }

 private:
  static constexpr std::size_t kMost = 500;
  using Steps = std::vector<Step>;
  static std::optional<std::string> step_over(Steps& from, Steps& to, State& now) {
    if (from.empty()) return std::nullopt;
    Step step = std::move(from.back());
    from.pop_back();
    to.push_back({step.what, std::exchange(now, std::move(step.state))});
    return std::move(step.what);
  }
  Steps done_, undone_;
};

}  // namespace ecs::commissioning
