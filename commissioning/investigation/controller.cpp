#include "commissioning/investigation/controller.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "commissioning/investigation/socket_workshop.hpp"
#include "commissioning/logbook/observed.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/models/work.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {
namespace {

/// The link that the screens share.
OpenUnit open_unit_of(const std::shared_ptr<UnitConnection>& unit, JobControl& control) {
  if (!unit) return {};
  const WatchedUnit seen = unit->snapshot();
  return {seen.where, seen.workshop, [unit, &control](const std::function<Result<void>(protocol::UnitClient&)>& work) {
            return unit->with_link(control, [&](UnitLink& link) { return work(link.client()); });
          }};
}

Result<Investigation> investigated(const InvestigationRequest& request, FollowedInvestigation& followed,
                                   const std::shared_ptr<UnitConnection>& unit, JobControl& control) {
  const std::atomic<bool>& cancelled = control.cancelled;
  const ObservedFiles seen;
  const auto model = model::read_model(request.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(followed, request.machine));
  if (!machine)
    return problem(ProblemKind::usage, "an investigation needs the machine file: travels, lever arms, pitches");
  std::error_code error;
  WorkshopChoice choice;
  choice.model = request.model;
  choice.machine = request.machine;
  choice.map_is_modelled = model->map.has_value();
  (std::filesystem::is_socket(request.place, error) ? choice.socket : choice.folder) = request.place;
  choice.open_unit = open_unit_of(unit, control);
  ECS_TRY(opened, open_workshop(followed, choice, *machine, cancelled));
  FollowedWorkshop workshop(followed, *opened.workshop);
  InvestigationOptions options;
  options.minutes = request.minutes;
  if (!choice.socket.empty()) options.times = workshop_times();
  options.cancelled = &cancelled;
  auto found = investigate(*model, *machine, workshop, options);
  if (found && logbook_is_kept()) {
    const Cell answer = investigation_cell(*found);
    LogRecord made;
    made.kind = "investigation";
    made.summary = fmt::format("MODEL: {} steps; {}", found->steps.size(),
                               found->verdict ? model::name_of(*found->verdict) : "nothing was measured");
    made.content = one_line(Json{{"screen", "MODEL"}, {"answer", answer.json}});
    record(std::move(made));
  }
  return found;
}

}  // namespace

void InvestigationController::start(const InvestigationRequest& request, std::shared_ptr<UnitConnection> unit) {
  const bool goes_on = request_ && followed_ && !found_ && request.model == request_->model &&
                       request.machine == request_->machine && request.place == request_->place;
  if (!goes_on) followed_ = std::make_shared<FollowedInvestigation>();
  followed_->forget_messages();
  found_.reset();
  request_ = request;
  message_.clear();
  task_.start(
      "investigating",
      [request, followed = followed_, unit = std::move(unit)](JobControl& control) {
        return investigated(request, *followed, unit, control);
      },
      [this](Result<Investigation> investigation) {
        followed_->forget_messages();
        if (investigation) {
          found_ = std::move(*investigation);
          return message_.say("the investigation is at its end");
        }
        if (task_.cancelled())
          message_.say("stopped; what was measured is kept, and i goes on", Tone::warning);
        else
          message_.say(investigation.error());
      });
}

void InvestigationController::stop() { task_.cancel(); }

bool InvestigationController::advance() { return task_.advance() || busy(); }

LedgerView InvestigationController::view() const { return followed_ ? view_of(followed_->progress()) : LedgerView{}; }

Result<void> InvestigationController::write_model(const std::string& file) const {
  if (!found_) return problem(ProblemKind::usage, "no investigation came to its end yet");
  return keep_model(file, found_->model, request_->model);
}

}  // namespace ecs::commissioning
