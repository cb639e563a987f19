// State and actions behind the screen LENGTHS: the fit of measured lengths, a plan, what is saved of them.
// Does not live here: the computation (work.hpp, plan.hpp), cells of a terminal (app/screens/lengths).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/lengths/plan.hpp"
#include "commissioning/lengths/work.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

/// What the screen shows of a file of lengths.
struct LengthsView {
  std::vector<std::string> lines;  ///< components with their uncertainties, noise, set-ups; of a plan what it asks for
  std::vector<std::string> missing;  ///< what is not determined, and what would determine it
  std::size_t undetermined = 0;
  bool measured = true;  ///< false: the file is a plan, there is nothing to fit
  LengthsWork work;      ///< of what was measured
};

/// And of a plan that was made.
struct LengthsPlanView {
  std::vector<std::string> lines;
  model::LengthPlan plan;
};

class LengthsController {
 public:
  /// In the background; nothing while something is under way.
  void fit(const LengthsArguments& arguments);
  void plan(const LengthsPlanAsked& asked);
  /// Ends the search for a plan.
  void cancel() { task_.cancel(); }
  /// Takes what is done. @return whether something changed
  [[nodiscard]] bool advance() { return task_.advance(); }
  [[nodiscard]] bool running() const { return task_.running(); }
  [[nodiscard]] const std::string& label() const { return task_.label(); }

  /// Nothing: none yet, or the last try failed (message() says why).
  [[nodiscard]] const std::optional<LengthsView>& view() const { return view_; }
  [[nodiscard]] const std::optional<LengthsPlanView>& planned() const { return planned_; }
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

  /// Why there is no map to save; empty: there is one.
  [[nodiscard]] std::string no_map() const;
  /// @param params_out  parameters with the squareness that was found  @pre no_map().empty()
  void save_map(const std::string& map, const std::string& params_out);
  /// @pre planned()
  void save_plan(const std::string& path);

 private:
  [[nodiscard]] bool stays(const std::string& output, const std::vector<std::string>& inputs);
  LengthsArguments fitted_;  ///< of view_
  LengthsPlanAsked asked_;   ///< of planned_
  std::optional<LengthsView> view_;
  std::optional<LengthsPlanView> planned_;
  Message message_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
