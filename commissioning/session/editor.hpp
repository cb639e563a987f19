// What is edited on a screen: as it is, as it was when it was loaded or saved last, the steps between, and its draft
// on disc as long as the two differ.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commissioning/session/remembered.hpp"

namespace ecs::commissioning {

/// @tparam State  what a step replaces; states are equal where saving them would write the same
template <class State>
class Editor {
 public:
  struct Step {
    std::string what;  ///< as undo names it
    State state;       ///< before the step; of one taken back, after it
    /// That does the step; empty: there is none.
    std::vector<std::string> command{};
  };

  /// @param draft  its name among the drafts (commissioning/session/remembered.hpp)
  explicit Editor(std::string draft, State now = {}) : draft_(std::move(draft)), now_(now), saved_(std::move(now)) {}

  [[nodiscard]] const std::string& draft() const { return draft_; }
  [[nodiscard]] const State& now() const { return now_; }
  /// As it was loaded, saved or sent last.
  [[nodiscard]] const State& saved() const { return saved_; }
  [[nodiscard]] bool unsaved() const { return unsaved_; }

  /// Other work takes the place of this, which stays as a draft where it is unsaved.
  void load(State state) {
    if (unsaved_) set_draft_aside(draft_);
    take_up(state, state);
    settle();
  }
  /// The work of a draft.
  void take_up(State now, State saved) {
    now_ = std::move(now);
    saved_ = std::move(saved);
    done_.clear();
    undone_.clear();
    compare();
    if (unsaved_) done_.push_back({"the work of the draft", saved_});
  }

  /// A step, the oldest of many forgotten: what was taken back cannot be done again. @return false: nothing differs
  bool did(std::string what, State after, std::vector<std::string> command = {}) {
    if (after == now_) return false;
    done_.push_back({std::move(what), std::exchange(now_, std::move(after)), std::move(command)});
    if (done_.size() > kMost) done_.erase(done_.begin());
    undone_.clear();
    compare();
    return true;
  }
  /// A step from before all that was done here; what was taken back stays.
  void did_before(Step step) { done_.insert(done_.begin(), std::move(step)); }
  /// The step that undo() takes back; null: there is none.
  [[nodiscard]] const Step* last() const { return done_.empty() ? nullptr : &done_.back(); }
  /// The step that redo() does again; null: there is none.
  [[nodiscard]] const Step* next() const { return undone_.empty() ? nullptr : &undone_.back(); }
  /// @return what it was; nothing: there is none
  [[nodiscard]] std::optional<std::string> undo() { return step_over(done_, undone_); }
  [[nodiscard]] std::optional<std::string> redo() { return step_over(undone_, done_); }

  /// The present state has been saved or sent.
  void settle() { settle(now_); }
  /// The state as it was when saving began has been saved or sent.
  void settle(State saved) {
    saved_ = std::move(saved);
    compare();
    if (!unsaved_) drop_draft(draft_);
  }
  /// It was saved in this form, which takes its place.
  void saved_as(State state) {
    now_ = state;
    settle(std::move(state));
  }
  /// Keeps the draft, or drops one that is needed no more. @param text  of the draft
  [[nodiscard]] Result<void> keep(const std::string& text) const {
    if (unsaved_) return keep_draft(draft_, text);
    drop_draft(draft_);
    return {};
  }

 private:
  static constexpr std::size_t kMost = 500;
  using Steps = std::vector<Step>;
  std::optional<std::string> step_over(Steps& from, Steps& to) {
    if (from.empty()) return std::nullopt;
    Step step = std::move(from.back());
    from.pop_back();
    to.push_back({step.what, std::exchange(now_, std::move(step.state)), std::move(step.command)});
    compare();
    return std::move(step.what);
  }
  void compare() { unsaved_ = !(now_ == saved_); }

  std::string draft_;
  State now_, saved_;
  bool unsaved_ = false;
  Steps done_, undone_;
};

}  // namespace ecs::commissioning
