// What the MODEL screen works on: a model, its readings, the fit, the last diagnosis, and the work under way.
// Pure state; every action is a function that can be called without a terminal. Does not live here: drawing
// (model_screen.hpp), the verbs' texts (app/model_view.hpp).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/model_work.hpp"
#include "app/plot_figure.hpp"
#include "app/screens/job.hpp"
#include "model/compare.hpp"
#include "model/diagnose.hpp"
#include "model/ladder.hpp"
#include "model/next_measurement.hpp"

namespace ecs::app {

/// Readings of one sense along one axis with the others parked at one place.
struct MeasuredLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  std::vector<std::size_t> rows;  ///< canonical order of the observations
};
[[nodiscard]] std::vector<MeasuredLine> measured_lines(const model::Observations& data);
/// "EX along X at Y -700"
[[nodiscard]] std::string title_of(const MeasuredLine& line);

/// Readings (signs) with the model through them (lines), forward and reverse.
[[nodiscard]] PlotPanel measured_panel(const model::Observations& data, const model::Fit& fit,
                                       const MeasuredLine& line);
/// What the model leaves: readings as signs, means as lines.
[[nodiscard]] PlotPanel residual_panel(const model::Observations& data, const model::Fit& fit,
                                       const MeasuredLine& line);

class ModelDesk {
 public:
  /// Reads and fits; takes up to seconds for large sets.
  [[nodiscard]] static Result<std::unique_ptr<ModelDesk>> open(Session& session, const ModelArguments& files);

  [[nodiscard]] const model::Model& model() const { return work_->model; }
  [[nodiscard]] const model::Observations& data() const { return *data_; }
  [[nodiscard]] const model::Fit& fit() const { return fit_; }
  [[nodiscard]] const std::vector<MeasuredLine>& lines() const { return lines_; }
  [[nodiscard]] const std::optional<model::Diagnosis>& diagnosis() const { return diagnosis_; }
  [[nodiscard]] const std::optional<model::NextMeasurement>& next() const { return next_; }
  [[nodiscard]] const std::string& model_file() const { return files_.model; }
  [[nodiscard]] bool changed() const { return changed_; }

  // actions; each sets message() where there is something to say
  void start_diagnosis();
  /// The candidate of the diagnosis, in the place and with the values found.
  void start_adding(std::size_t candidate);
  void undo();
  void save();
  /// The picture of the figure that `ecs model fit --plot` draws.
  void export_picture(const std::string& path);
  void cancel();

  /// Takes what has been finished meanwhile. @return whether anything changed
  [[nodiscard]] bool advance();
  [[nodiscard]] bool busy() const { return diagnosing_.running() || adding_.running(); }
  [[nodiscard]] const std::string& working_on() const { return working_on_; }
  [[nodiscard]] double seconds_working() const;
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] bool message_is_problem() const { return message_is_problem_; }

 private:
  struct Diagnosed {
    Result<model::Diagnosis> diagnosis;
    model::NextMeasurement next;
  };
  ModelDesk() = default;
  void say(std::string text, bool problem = false);
  [[nodiscard]] bool refit(model::Model model);

  ModelArguments files_;
  std::shared_ptr<ModelWork> work_;
  std::shared_ptr<const model::Observations> data_;
  model::Fit fit_;
  std::vector<MeasuredLine> lines_;
  std::optional<model::Diagnosis> diagnosis_;
  std::optional<model::NextMeasurement> next_;
  bool changed_ = false;
  bool cancelled_ = false;
  std::string working_on_;
  std::chrono::steady_clock::time_point since_{};
  std::string message_;
  bool message_is_problem_ = false;
  Job<Diagnosed> diagnosing_;
  Job<Result<model::Added>> adding_;
};

}  // namespace ecs::app
