#include "commissioning/investigation/followed.hpp"

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::commissioning {
namespace {

void log_readings(const laser::MeasurementSet& set, int run) {
  if (!logbook_is_kept()) return;
  LogRecord made;
  made.kind = "measurement";
  made.summary = fmt::format("run {} of an investigation: {} readings", run, set.readings.size());
  const std::string name = fmt::format("investigation run {}.csv", run);
  made.files.push_back({"output", name, std::make_shared<const std::string>(laser::to_csv(set))});
  record(std::move(made));
}

void log_step(const InvestigationStep& step, std::size_t number) {
  if (!logbook_is_kept()) return;
  LogRecord made;
  made.kind = "investigation step";
  made.summary = fmt::format("step {}: {}; {}", number, step.measured, model::name_of(step.verdict));
  made.content = one_line(Json{{"step", step_cell(step).json}, {"number", number}});
  record(std::move(made));
}

}  // namespace

void FollowedInvestigation::note(std::string_view text) {
  const std::lock_guard lock(mutex_);
  progress_.said.emplace_back(text);
}

void FollowedInvestigation::warn(std::string_view text) { note(fmt::format("warning: {}", text)); }

InvestigationProgress FollowedInvestigation::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void FollowedInvestigation::forget_messages() {
  const std::lock_guard lock(mutex_);
  progress_.said.clear();
  progress_.doing.clear();
}

void FollowedWorkshop::say_doing(std::string text) {
  {
    const std::lock_guard lock(followed_.mutex_);
    followed_.progress_.doing = std::move(text);
  }
  if (changed_) changed_();
}

Result<RunReadings> FollowedWorkshop::measure(const RequestedRun& run) {
  const std::pair key(run.number, run.proposal.sentence);
  {
    const std::lock_guard lock(followed_.mutex_);
    if (const auto given = followed_.given_.find(key); given != followed_.given_.end()) return given->second;
  }
  say_doing(fmt::format("run {}{}: {}", run.number, run.with_new_map ? ", with the new map active" : "",
                        run.proposal.sentence));
  auto readings = workshop_.measure(run);
  if (readings) log_readings(readings->set, run.number);
  if (readings) {
    const std::lock_guard lock(followed_.mutex_);
    followed_.given_[key] = *readings;
    auto& steps = followed_.progress_.steps;  // those that another run led to are no longer
    if (steps.size() > kept_) steps.resize(kept_);
  }
  say_doing(readings ? "looking for what is missing" : "");
  return readings;
}

Result<void> FollowedWorkshop::activate(const model::Model& model) {
  say_doing("making the map of the model active");
  return workshop_.activate(model);
}

void FollowedWorkshop::keep(const InvestigationStep& step) {
  workshop_.keep(step);
  bool is_new = false;
  {
    const std::lock_guard lock(followed_.mutex_);
    auto& steps = followed_.progress_.steps;
    is_new = kept_ >= steps.size();
    if (is_new)
      steps.push_back(step);
    else
      steps[kept_] = step;
    ++kept_;
  }
  if (is_new) log_step(step, kept_);
  say_doing("");
}

}  // namespace ecs::commissioning
