// What the MODEL screen works on: a model, its readings, the fit, the last diagnosis, what compensation would leave,
// and the work under way. Pure state; every action is a function that can be called without a terminal.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/unit_work.hpp"
#include "commissioning/model_session/commands.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/plot/picture_export.hpp"
#include "commissioning/session/editor.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/planning/next_measurement.hpp"

namespace ecs::commissioning {

/// The map of the model as it would be written.
struct PlannedMap {
  FromModelArguments arguments;
  std::vector<Component> missing;  ///< to be declared zero with a reason
  std::vector<std::string> exist;  ///< files that would be overwritten
};

class ModelController {
 public:
  /// Reads and fits; takes up to seconds for large sets. @param unit  for maps to be sent; null: none
  [[nodiscard]] static Result<std::unique_ptr<ModelController>> open(const ModelArguments& files,
                                                                     std::shared_ptr<UnitConnection> unit = {});
  /// The same with a model that is started in a new file (begun_model()). The file is there only if this succeeds.
  [[nodiscard]] static Result<std::unique_ptr<ModelController>> begin_new(const ModelArguments& files,
                                                                          std::shared_ptr<UnitConnection> unit = {});

  [[nodiscard]] const model::Model& model() const { return edited_.now(); }
  [[nodiscard]] const model::Observations& data() const { return work_->data; }
  [[nodiscard]] const model::Fit& fit() const { return fit_; }
  [[nodiscard]] const std::vector<MeasuredLine>& lines() const { return lines_; }
  [[nodiscard]] const std::vector<int>& runs() const { return runs_; }
  /// Where the model fails, as lines of text.
  [[nodiscard]] const std::vector<std::string>& comparison() const { return comparison_; }
  [[nodiscard]] const std::optional<model::Diagnosis>& diagnosis() const { return diagnosis_; }
  [[nodiscard]] const std::optional<model::NextMeasurement>& next() const { return next_; }
  /// What compensation would leave, and what it left; empty: not asked yet.
  [[nodiscard]] const std::vector<std::string>& after() const { return after_; }
  [[nodiscard]] const std::string& model_file() const { return files_.model; }
  [[nodiscard]] const ModelArguments& files() const { return files_; }
  [[nodiscard]] const std::optional<params::Machine>& machine() const { return work_->machine; }
  [[nodiscard]] const std::shared_ptr<UnitConnection>& unit() const { return unit_; }  ///< null: none
  [[nodiscard]] bool changed() const { return edited_.unsaved(); }
  /// Counts up with every fit: curves are made again only then.
  [[nodiscard]] int generation() const { return generation_; }

  /// Unsaved work on this model that was kept when it was last open.
  [[nodiscard]] std::optional<Draft> draft() const { return draft_of(edited_.draft()); }
  void take_draft();
  void drop_draft() { commissioning::drop_draft(edited_.draft()); }

  // actions; each tells message() what came of it
  void start_diagnosis();
  /// The candidate of the diagnosis, in the place and with the values found.
  void start_adding(std::size_t candidate);
  /// The formula that the diagnosis proposes of what is left.
  void start_adding_formula();
  /// "cyclic:X:EX" and what its place leaves open, from the best fit.
  /// @return why it is none; empty: it is being added
  [[nodiscard]] std::string start_adding(const std::string& effect);
  /// It is this one, and none of its alternatives. @param effect  place in the model
  void decide(std::size_t effect);
  /// @param effect  place in the model
  void start_removing(std::size_t effect);
  /// What was done last here; then the steps of the ladder that the file has.
  void undo();
  void redo();
  /// The model with its fitted values.
  void save();
  /// The values of this fit are in the file.
  [[nodiscard]] bool is_kept() const { return !changed() && values_kept_; }
  /// What compensation would leave; with files measured again, what it left.
  void start_after(const std::vector<std::string>& measured_again);
  /// Whether a map can be built; says why not.
  [[nodiscard]] bool may_build_map();
  /// The map that the saved model compiles to. Writes nothing: planned_map() says what is missing and what exists.
  /// @param params  parameters of the unit; empty: received from it where there is a link, else those of the machine
  void plan_map(const std::string& output, const std::string& params);
  [[nodiscard]] const std::optional<PlannedMap>& planned_map() const { return planned_; }
  void drop_plan() { planned_.reset(); }
  /// Writes it, its parameters beside it. @param zero_reason  for the missing components; empty: they stay missing
  void write_map(const std::string& zero_reason);
  /// File of the map written last; empty: none.
  [[nodiscard]] const std::string& map_file() const { return map_file_; }
  [[nodiscard]] static std::string params_beside(const std::string& machine_file);
  [[nodiscard]] std::string params_proposed() const { return params_beside(files_.machine); }

  // the map to the unit, as in the laser session
  void prepare_sending();
  [[nodiscard]] const std::optional<ReadyMap>& ready() const { return ready_; }
  [[nodiscard]] Question sending_question() const;
  void send();
  void not_now() { ready_.reset(); }
  [[nodiscard]] const std::optional<SentMap>& sent() const { return sent_; }
  /// Whether a map was sent; says why not.
  [[nodiscard]] bool may_compensate();
  /// Refused unless the unit holds the map that was sent.
  void compensate();
  /// The picture of the figure that `ecs model fit --plot` draws.
  void export_picture(FigureWriter write);
  void cancel();

  /// Takes what has been finished meanwhile. @return whether anything changed
  [[nodiscard]] bool advance();
  [[nodiscard]] bool busy() const { return running().running(); }
  [[nodiscard]] std::string working_on() const { return running().label(); }
  [[nodiscard]] double seconds_working() const { return running().seconds(); }
  [[nodiscard]] const Message& message() const { return message_; }

  // for what a module adds to the screen
  [[nodiscard]] Message& message() { return message_; }
  /// Its work: nothing else begins meanwhile, and cancel() stops it; what is said of that it says itself.
  [[nodiscard]] TaskRunner& added_work() { return added_work_; }

 private:
  struct Fitted {
    model::Model model;
    model::Fit fit;
    std::vector<std::string> comparison;
    std::string said;
    std::string done{};                ///< what undo calls it
    std::vector<std::string> words{};  ///< of the command that does it; empty: there is none
  };
  struct Diagnosed {
    Result<model::Diagnosis> diagnosis;
    model::NextMeasurement next;
    std::optional<model::DecidedTies> ties;  ///< of the model, by these readings
  };
  using Lines = std::vector<std::string>;
  ModelController() = default;
  [[nodiscard]] const TaskRunner& running() const { return added_work_.running() ? added_work_ : task_; }
  /// A step, as the command `words` does it. @return false: it changes nothing
  bool did(const std::string& what, model::Model after, const std::vector<std::string>& words);
  void keep();
  void step_over(bool back);
  void take(const model::DecidedTies& ties);
  /// @param rivals  that the data cannot tell it from: kept with it
  void start_adding(const model::AddRequest& request, const std::string& name,
                    const std::vector<model::EffectInstance>& rivals);
  /// Starts a task that ends in a fit.
  void start_fit(const std::string& label, std::function<Result<Fitted>()> work);
  [[nodiscard]] static Result<Fitted> fitted(model::Model model, const model::Observations& data, std::string said);
  void take(Result<Fitted> fitted);
  void show(Fitted fitted);
  [[nodiscard]] bool has_unit();
  void take(Diagnosed found);
  void note_map(const FromModelArguments& arguments);

  ModelArguments files_;
  std::shared_ptr<const ModelWork> work_;  ///< as it was read; shared with the work under way
  Editor<model::Model> edited_{""};
  model::Fit fit_;
  std::vector<MeasuredLine> lines_;
  std::vector<int> runs_;
  Lines comparison_;
  std::optional<model::Diagnosis> diagnosis_;
  std::optional<model::NextMeasurement> next_;
  Lines after_;
  std::shared_ptr<UnitConnection> unit_;
  std::optional<PlannedMap> planned_;
  std::string map_file_;
  std::vector<std::string> remarks_;  ///< on that map
  std::optional<ReadyMap> ready_;
  std::optional<SentMap> sent_;
  bool values_kept_ = false;
  bool saved_ = false;  ///< since it was opened
  int generation_ = 0;
  Message message_;
  ModelCommands commands_;
  TaskRunner added_work_;
  TaskRunner drawing_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
