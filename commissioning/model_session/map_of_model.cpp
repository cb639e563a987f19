// From the model to a unit: the map planned, written and sent, compensation switched on.
#include <filesystem>

#include <fmt/format.h>

#include "base/overwriting.hpp"
#include "commissioning/link/unit_commands.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/model_session/controller.hpp"

namespace ecs::commissioning {

std::string ModelController::params_beside(const std::string& machine_file) {
  const auto file = std::filesystem::path(machine_file).parent_path() / "parameters.toml";
  std::error_code error;
  return !machine_file.empty() && std::filesystem::exists(file, error) ? file.string() : "";
}

bool ModelController::may_build_map() {
  if (busy()) return false;
  if (files_.machine.empty())
    message_.say("open the model with its machine file: the map needs the travels of the axes", Tone::bad);
  return !files_.machine.empty();
}

void ModelController::plan_map(const std::string& output, const std::string& params) {
  if (!may_build_map()) return;
  message_.clear();
  planned_.reset();
  FromModelArguments arguments;
  arguments.model = files_.model;
  arguments.machine = files_.machine;
  arguments.params = params;
  arguments.output = output;
  arguments.params_out = files_of_map(output).parameters;
  const auto plan = [arguments, unit = unit_](JobControl& control) -> Result<PlannedMap> {
    FromModelArguments asked = arguments;
    if (asked.params.empty() && unit && unit->snapshot().open) {
      auto received = parameters_of_unit(*unit, control);
      if (received)
        asked.received = std::move(*received);
      else if (received.error().kind == ProblemKind::link)
        return tl::unexpected(received.error());
    }
    NoMessages messages;
    ECS_TRY(map, planned_map_from_model(messages, asked));
    PlannedMap planned{asked, map.missing, {}};
    for (const std::string& file : {asked.output, asked.params_out})
      if (would_overwrite(file, {asked.params})) planned.exist.push_back(file);
    return planned;
  };
  task_.start("compiling the model to a map", plan, [this](Result<PlannedMap> planned) {
    if (task_.cancelled()) return;
    if (!planned) return message_.say(planned.error());
    planned_ = std::move(*planned);
  });
}

void ModelController::write_map(const std::string& zero_reason) {
  if (busy() || !planned_) return;
  FromModelArguments arguments = planned_->arguments;
  arguments.zero_missing = zero_reason;
  planned_.reset();
  message_.clear();
  struct Written {
    Result<MapFromModel> map;
    Lines lines;
  };
  const auto write = [arguments](JobControl&) {
    NoMessages messages;
    Written written{map_from_model(messages, arguments), {}};
    if (written.map)  // the last line of the answer first: it is what matters
      written.lines =
          owned_lines_of(verdict_text(written.map->findings) + "\n" + from_model_cell(*written.map, arguments).text);
    return written;
  };
  task_.start("writing the map", write, [this, arguments](Written written) {
    if (!written.map) return message_.say(written.map.error());
    after_ = std::move(written.lines);
    map_file_ = arguments.output;
    note_map(arguments);
    remarks_ = remarks_in(written.map->findings);
    ready_.reset();
    sent_.reset();
    if (written.map->complete())
      message_.say(fmt::format("map written to {}, its parameters to {}; t sends both to the unit", arguments.output,
                               arguments.params_out));
    else
      message_.say(fmt::format("map written to {}, but it is not complete: a unit refuses it", arguments.output),
                   Tone::warning);
  });
}

/// Parameters that came from the unit are received again by a command of their own.
void ModelController::note_map(const FromModelArguments& arguments) {
  if (changed_) note_remark("the map is that of the model as it was saved last");
  std::string params = path_word(arguments.params);
  if (arguments.received && params.empty()) {
    params = file_between("parameters", ".toml");
    note_on_unit(*unit_, {"params", "receive", "-o", params});
  }
  commands_.note_map(arguments, params);
}

bool ModelController::has_unit() {
  if (busy()) return false;
  if (!unit_)
    message_.say("no link to a unit", Tone::bad);
  else if (map_file_.empty())
    message_.say("there is no map to send yet: m builds it from the model", Tone::warning);
  else
    return true;
  return false;
}

void ModelController::prepare_sending() {
  if (!has_unit()) return;
  message_.clear();
  ready_.reset();
  const auto check = [files = files_of_map(map_file_), unit = unit_](JobControl& control) {
    return ready_map(*unit, control, files);
  };
  task_.start("checking the map", check, [this](Result<ReadyMap> ready) {
    if (task_.cancelled()) return;
    if (!ready) return message_.say(ready.error());
    ready_ = std::move(*ready);
  });
}

Question ModelController::sending_question() const {
  return question_before_sending(*ready_, unit_->snapshot(), remarks_);
}

void ModelController::send() {
  if (!has_unit() || !ready_) return;
  message_.clear();
  const auto work = [ready = *ready_, unit = unit_](JobControl& control) { return sent_map(*unit, control, ready); };
  task_.start("sending the map", work, [this, files = ready_->files](SendAttempt attempt) {
    if (!attempt.sent)
      return message_.say(fmt::format("not sent: {}{}", to_text(attempt.sent.error()),
                                      attempt.begun ? ". The unit keeps the map it had until a new one is whole." : ""),
                          Tone::bad);
    sent_ = std::move(*attempt.sent);
    note_sent_map(*unit_, files);
    message_.say(sent_text(*sent_) + "; c switches the unit to compensation");
  });
  ready_.reset();
}

bool ModelController::may_compensate() {
  if (!has_unit()) return false;
  if (!sent_) message_.say("the map was not sent yet: t sends it", Tone::warning);
  return sent_.has_value();
}

void ModelController::compensate() {
  if (!may_compensate()) return;
  const auto work = [expected = ExpectedMap{sent_, std::nullopt}, unit = unit_](JobControl& control) {
    return switch_to_compensation(*unit, control, expected);
  };
  task_.start("switching to compensation", work, [this](const Result<void>& done) {
    if (!done) return message_.say(done.error());
    note_on_unit(*unit_, {"utility", "mode", "compensate", "--wait", "0"});
    message_.say(
        unit_->snapshot().emulator
            ? "the unit watches: g in DISPLAY ECS STATUS (F3) references the emulated machine, e in step 1 of PROCESS "
              "LASER DATA measures it again; o here opens those files"
            : "the unit watches: reference every axis at the control now, then it compensates; measure the same lines "
              "again, o opens those files");
  });
}

}  // namespace ecs::commissioning
