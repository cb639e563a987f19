#include "commissioning/investigation/followed.hpp"

#include <fmt/format.h>

namespace ecs::commissioning {

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
  {
    const std::lock_guard lock(followed_.mutex_);
    auto& steps = followed_.progress_.steps;
    if (kept_ < steps.size())
      steps[kept_] = step;
    else
      steps.push_back(step);
    ++kept_;
  }
  say_doing("");
}

}  // namespace ecs::commissioning
