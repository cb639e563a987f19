#include "modules/investigation/controller.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/session/records.hpp"
#include "model/fit/model_file.hpp"
#include "modules/investigation/socket_workshop.hpp"

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

Result<Investigation> investigated(const ModelArguments& files, const std::string& place, double minutes,
                                   FollowedInvestigation& followed, const std::shared_ptr<UnitConnection>& unit,
                                   JobControl& control) {
  const std::atomic<bool>& cancelled = control.cancelled;
  const auto watch = watch_for_records();
  const auto model = model::read_model(files.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(followed, files.machine));
  if (!machine)
    return problem(ProblemKind::usage, "an investigation needs the machine file: travels, lever arms, pitches");
  std::error_code error;
  WorkshopChoice choice;
  choice.model = files.model;
  choice.machine = files.machine;
  choice.map_is_modelled = model->map.has_value();
  (std::filesystem::is_socket(place, error) ? choice.socket : choice.folder) = place;
  choice.open_unit = open_unit_of(unit, control);
  ECS_TRY(opened, open_workshop(followed, choice, *machine, cancelled));
  FollowedWorkshop workshop(followed, *opened.workshop);
  InvestigationOptions options;
  options.minutes = minutes;
  if (!choice.socket.empty()) options.times = workshop_times();
  options.cancelled = &cancelled;
  auto found = investigate(*model, *machine, workshop, options);
  if (found)
    record({.kind = "investigation",
            .summary = fmt::format("MODEL: {} steps; {}", found->steps.size(),
                                   found->verdict ? model::name_of(*found->verdict) : "nothing was measured"),
            .content = one_line(Json{{"screen", "MODEL"}, {"answer", investigation_cell(*found).json}})});
  return found;
}

}  // namespace

bool InvestigationController::may_begin() {
  if (model_.busy()) return false;
  if (model_.files().machine.empty())
    model_.message().say("open the model with its machine file: an investigation needs travels and lever arms",
                         Tone::bad);
  else if (model_.changed())
    model_.message().say("save the model first (s): the investigation begins with its file", Tone::warning);
  else
    return true;
  return false;
}

std::string InvestigationController::emulated_workshop() const {
  const WatchedUnit seen = model_.unit() ? model_.unit()->snapshot() : WatchedUnit{};
  return seen.emulator ? seen.workshop : "";
}

std::optional<std::string> InvestigationController::place_of(const std::string& typed) {
  if (!typed.empty()) return typed;
  const std::string workshop = emulated_workshop();
  if (workshop.empty()) {
    model_.message().say("this link has no emulated machine: give the socket of a workshop, or a folder", Tone::bad);
    return std::nullopt;
  }
  const std::string link = model_.unit()->snapshot().link;  // emulator:MACHINE
  const auto emulated = params::read_machine(link.substr(std::min(link.size(), link.find(':') + 1)));
  if (emulated && model_.machine() && emulated->machine.name != model_.machine()->name) {
    model_.message().say(
        fmt::format("the emulated machine of this link is {}, the machine file of the model is of {}: set the "
                    "link to emulator:{} in LINK (F3) first",
                    emulated->machine.name, model_.machine()->name, model_.files().machine),
        Tone::bad);
    return std::nullopt;
  }
  return workshop;
}

void InvestigationController::start(const std::string& place, const std::string& minutes) {
  if (!may_begin()) return;
  const auto number = number_in(minutes);
  if (!number || !(*number > 0.0))
    return model_.message().say(fmt::format("expected minutes that the runs may take, found \"{}\"", minutes),
                                Tone::bad);
  model_.message().clear();
  const bool goes_on = followed_ && !found_ && place == place_;
  if (!goes_on) followed_ = std::make_shared<FollowedInvestigation>();
  followed_->forget_messages();
  found_.reset();
  place_ = place;
  minutes_ = *number;
  model_.added_work().start(
      "investigating",
      [files = model_.files(), place, number, followed = followed_, unit = model_.unit()](JobControl& control) {
        return investigated(files, place, *number, *followed, unit, control);
      },
      [this](Result<Investigation> investigation) { take(std::move(investigation)); });
}

void InvestigationController::take(Result<Investigation> investigation) {
  followed_->forget_messages();
  if (investigation) {
    found_ = std::move(*investigation);
    model_.message().say("the investigation is at its end");
    noted_ = note(command({}));
  } else if (model_.added_work().cancelled()) {
    model_.message().say("stopped; what was measured is kept, and i goes on", Tone::warning);
  } else {
    model_.message().say(investigation.error());
  }
}

LedgerView InvestigationController::view() const { return followed_ ? view_of(followed_->progress()) : LedgerView{}; }

/// @param file  for the model with the causes; empty: it is not written
NotedCommand InvestigationController::command(const std::string& file) const {
  std::error_code error;
  const bool watches = std::filesystem::is_directory(place_, error);
  NotedCommand noted;
  noted.words = {"ecs",
                 "model",
                 "investigate",
                 path_word(model_.files().model),
                 "--machine",
                 path_word(model_.files().machine),
                 watches ? "--watch" : "--workshop",
                 watches ? path_word(place_) : place_,
                 "--minutes",
                 shortest(minutes_)};
  if (!file.empty()) noted.words.insert(noted.words.end(), {"-o", path_word(file)});
  return noted;
}

void InvestigationController::write_model(const std::string& file) {
  if (const auto kept = keep_model(file, found_->model, model_.files().model); !kept)
    return model_.message().say(kept.error());
  amend(noted_, command(file));
  model_.message().say("written to " + file);
}

}  // namespace ecs::commissioning
