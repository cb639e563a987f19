#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "commissioning/session/records.hpp"
#include "laser/writers/writers.hpp"
#include "modules/investigation/investigation.hpp"

namespace ecs::commissioning {
namespace {

void record_readings(const laser::MeasurementSet& set, int run) {
  if (!records_are_kept()) return;
  record({.kind = "measurement",
          .summary = fmt::format("run {} of an investigation: {} readings", run, set.readings.size()),
          .files = {{"output", fmt::format("investigation run {}.csv", run),
                     std::make_shared<const std::string>(laser::to_csv(set))}}});
}

void record_step(const InvestigationStep& step, std::size_t number) {
  record({.kind = "investigation step",
          .summary = fmt::format("step {}: {}; {}", number, step.measured, model::name_of(step.verdict)),
          .content = one_line(object_of("step"_is(step_cell(step).json), "number"_is(number)))});
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
  if (readings) record_readings(readings->set, run.number);
  if (readings) {
    const std::lock_guard lock(followed_.mutex_);
    followed_.given_[key] = *readings;
    auto& steps = followed_.progress_.steps;  // those that another run led to are no longer
    if (steps.size() > kept_) steps.resize(kept_);
  }
  say_doing(readings ? "looking for missing effects" : "");
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
  if (is_new) record_step(step, kept_);
  say_doing("");
}

namespace {

constexpr std::size_t kMostBars = 8;

std::string set_text(const InvestigationStep& step) {
  if (step.set.empty()) return std::string(name_of(step.verdict));
  std::vector<std::string> members;
  for (const SetMember& member : step.set) members.push_back(fmt::format("{} {:.2f}", member.name, member.probability));
  return fmt::format("{}", fmt::join(members, ", "));
}

}  // namespace

LedgerView view_of(const InvestigationProgress& progress) {
  LedgerView view;
  double minutes = 0.0;
  for (const InvestigationStep& step : progress.steps) {
    minutes += step.minutes;
    view.rows.push_back({ledger_numbers(view.rows.size() + 1, step, minutes), step.set.size(),
                         step.set.size() == 1 || step.verdict == model::Verdict::adequate, step.measured});
  }
  if (!progress.steps.empty()) view.set = set_text(progress.steps.back());
  view.doing = progress.doing;
  view.said = progress.said;
  return view;
}

std::vector<std::string> lines_of(const LedgerView& view, std::size_t columns) {
  std::vector<std::string> lines;
  const auto add = [&](std::string line) {
    if (line.size() > columns) line.resize(columns);
    lines.push_back(std::move(line));
  };
  add(fmt::format("{}  {:<{}} measured", ledger_numbers_head(), "", kMostBars));
  for (const LedgerRow& row : view.rows)
    add(fmt::format("{}  {:<{}} {}", row.numbers, std::string(std::min(row.members, kMostBars), '#'), kMostBars,
                    row.measured));
  if (!view.set.empty()) add("   " + view.set);
  if (!view.doing.empty()) add("   " + view.doing);
  return lines;
}

}  // namespace ecs::commissioning
