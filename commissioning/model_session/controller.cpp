#include "commissioning/model_session/controller.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/what_if.hpp"

namespace ecs::commissioning {

using model::Observations;

namespace {

std::string draft_name_of(const std::string& model_file) {
  const std::filesystem::path path = disc::absolute(model_file);
  return "model-" + sha256_hex(path.string()).substr(0, 16);
}

/// "fits (p = 0.3)", "DOES NOT FIT": at most 18 columns.
std::string short_verdict(const std::optional<model::LackOfFit>& test) {
  if (!test) return "too few repeats";
  if (test->fails()) return "DOES NOT FIT";
  return fmt::format(fmt::runtime(test->is_in_doubt() ? "doubtful p={:.1g}" : "fits (p = {:.1g})"), test->p);
}

/// With verdicts that a table of 80 columns has room for: the sentences of the verb would be cut.
std::vector<std::string> lines_of_comparison(const model::Comparison& comparison, std::size_t readings) {
  auto lines = owned_lines_of(comparison_cell(comparison, readings).text);
  for (std::string& line : lines)
    for (const model::DirectionSummary& one : comparison.directions)
      if (const std::string verdict = "   " + lack_of_fit_cell(one.lack_of_fit).text; line.ends_with(verdict)) {
        line.replace(line.size() - verdict.size(), verdict.size(), "   " + short_verdict(one.lack_of_fit));
        break;
      }
  return lines;
}

}  // namespace

Result<ModelController::Fitted> ModelController::fitted(model::Model model, const Observations& data,
                                                        std::string said) {
  ECS_TRY(fit, model::fit(model, data));
  auto comparison = lines_of_comparison(model::compare(fit, data), data.size());
  return Fitted{std::move(model), std::move(fit), std::move(comparison), std::move(said)};
}

Result<std::unique_ptr<ModelController>> ModelController::open(const ModelArguments& files,
                                                               std::shared_ptr<UnitConnection> unit) {
  NoMessages messages;
  ECS_TRY(work, model_work(messages, files));
  auto first = fitted(work.model, work.data, "");
  if (!first) return tl::unexpected(in_file(first.error(), files.model));
  std::unique_ptr<ModelController> controller(new ModelController);
  controller->files_ = files;
  controller->commands_ = ModelCommands(files);
  if (work.machine) {
    const std::string mismatch = mismatch_of(*work.machine, work.set);
    const std::string other = unit ? other_unit_for(*work.machine, unit->snapshot()) : "";
    if (!mismatch.empty())
      controller->message_.say(mismatch + " Choose the machine file of this machine.", Tone::bad);
    else if (!other.empty())
      controller->message_.say(other, Tone::warning);
  }
  controller->unit_ = std::move(unit);
  controller->work_ = std::make_shared<const ModelWork>(std::move(work));
  controller->lines_ = measured_lines(controller->data());
  const std::set<int> runs(controller->data().run.begin(), controller->data().run.end());
  controller->runs_.assign(runs.begin(), runs.end());
  controller->values_kept_ = std::all_of(first->model.effects.begin(), first->model.effects.end(), [](const auto& e) {
    return !e.fitted.empty() || !e.curve.empty() || e.definition().traits.fixed_size;
  });
  controller->edited_ = Editor(draft_name_of(files.model), std::move(first->model));
  controller->fit_ = std::move(first->fit);
  controller->comparison_ = std::move(first->comparison);
  return controller;
}

Result<std::unique_ptr<ModelController>> ModelController::begin_new(const ModelArguments& files,
                                                                    std::shared_ptr<UnitConnection> unit) {
  NoMessages messages;
  ECS_DO(begun_model(messages, files));
  auto controller = open(files, std::move(unit));
  if (!controller) {
    disc::remove(files.model);
    return controller;
  }
  (*controller)->commands_.begun();
  Message& message = (*controller)->message_;
  const std::string begun =
      fmt::format("new model {} with {}; press d to find missing effects, a to add one",
                  std::filesystem::path(files.model).filename().string(), usual_in_words(*(*controller)->work_));
  if (message.text().empty())
    message.say(begun);
  else
    message.say(fmt::format("{} {}", message.text(), begun), message.tone());
  return controller;
}

void ModelController::start_fit(const std::string& label, std::function<Result<Fitted>()> work) {
  message_.clear();
  task_.start(
      label, [work = std::move(work)](JobControl&) { return work(); },
      [this](Result<Fitted> fitted) {
        if (!task_.cancelled()) take(std::move(fitted));
      });
}

void ModelController::take_draft() {
  const auto kept = draft();
  if (!kept || busy()) return;
  auto model = model::parse_model(kept->text, "the unsaved work", std::filesystem::path(files_.model).parent_path());
  if (!model) return message_.say(model.error());
  start_fit("restoring the unsaved work", [model = std::move(*model), work = work_] {
    auto now = fitted(model, work->data, "unsaved work restored; press s to save it to the model file");
    if (now) now->done = "unsaved work";
    return now;
  });
}

void ModelController::start_diagnosis() {
  if (busy()) return;
  message_.clear();
  const auto work = [model = model(), data = work_](JobControl& control) {
    model::DiagnoseOptions options;
    options.cancelled = &control.cancelled;
    Diagnosed found{model::diagnose(model, data->data, options), {}, {}};
    if (!found.diagnosis || control.cancelled) return found;
    if (auto ties = model::decided_ties(model, data->data)) found.ties = std::move(*ties);
    found.next = model::planned_next(model, data->data, *found.diagnosis);
    return found;
  };
  task_.start("looking for missing effects", work, [this](Diagnosed found) {
    if (!task_.cancelled()) take(std::move(found));
  });
}

void ModelController::start_adding(std::size_t candidate) {
  if (busy() || !diagnosis_ || candidate >= diagnosis_->candidates.size()) return;
  const model::EffectInstance& effect = diagnosis_->candidates[candidate].effect;
  start_adding(model::request_of(effect), place_text(effect), diagnosis_->candidates[candidate].rivals);
}

void ModelController::start_adding_formula() {
  if (busy() || !diagnosis_ || !diagnosis_->formula) return;
  start_adding(model::request_of(diagnosis_->formula->effect), "formula", {});
}

std::string ModelController::start_adding(const std::string& effect) {
  if (busy()) return {};
  const auto request = model::parse_add_request(effect);
  if (!request) return to_text(request.error());
  start_adding(*request, effect, {});
  return {};
}

void ModelController::decide(std::size_t effect) {
  if (busy() || effect >= model().effects.size() || model().effects[effect].is_user()) return;
  const std::string name = place_text(model().effects[effect]);
  model::Model after = model();
  keep_alternatives(after.effects[effect], {});
  did("decided for " + name, std::move(after), commands_.decide(name));
  keep_alternatives(fit_.effects[effect].effect, {});
  message_.say("decided for " + name);
  keep();
}

void ModelController::start_adding(const model::AddRequest& request, const std::string& name,
                                   const std::vector<model::EffectInstance>& rivals) {
  start_fit("adding " + name,
            [model = model(), work = work_, request, rivals, name, commands = commands_]() -> Result<Fitted> {
              ECS_TRY(added, model::add_effect(model, work->data, request, work->data_name));
              if (!rivals.empty()) keep_alternatives(added.model.effects.back(), rivals);
              const std::string effect = name_with_alternatives(added.model.effects.back());
              auto now =
                  fitted(std::move(added.model), work->data,
                         fmt::format("added {}: {:.3f} -> {:.3f} {} rms; press u to undo, s to save the model", effect,
                                     added.rms_before_um, added.rms_after_um, work->data.reading_unit()));
              if (now) {
                now->done = effect;
                now->words = commands.add(name, request, now->model.effects.back().tied_with);
              }
              return now;
            });
}

void ModelController::start_removing(std::size_t effect) {
  if (busy() || effect >= model().effects.size()) return;
  if (model().effects.size() == 1) return message_.say("a model must keep at least one effect", Tone::warning);
  const std::string name = place_text(model().effects[effect]);
  start_fit(
      "removing " + name,
      [model = model(), work = work_, before = fit_, effect, name, words = commands_.remove(name)]() -> Result<Fitted> {
        ECS_TRY(without, without_effect(model, work->data, effect, before, work->data_name));
        auto comparison = lines_of_comparison(model::compare(without.fit, work->data), work->data.size());
        Fitted now{
            std::move(without.model), std::move(without.fit), std::move(comparison), {}, "removed " + name, words};
        now.said = fmt::format("removed {}: {:.3f} -> {:.3f} {} rms; press u to undo", name, before.rms_um,
                               now.fit.rms_um, work->data.reading_unit());
        return now;
      });
}

bool ModelController::did(const std::string& what, model::Model after, const std::vector<std::string>& words) {
  if (!edited_.did(what, std::move(after), words)) return false;
  commands_.did(words);
  return true;
}

void ModelController::keep() {
  if (const auto kept = edited_.keep(to_toml(model())); !kept) message_.say(kept.error());
}

/// @pre there is such a step
void ModelController::step_over(bool back) {
  const auto& step = back ? *edited_.last() : *edited_.next();
  const char* const label = back ? "undone" : "redone";
  message_.clear();
  const auto work = [model = step.state, work = work_, said = fmt::format("{}: {}", label, step.what)](JobControl&) {
    return fitted(model, work->data, said);
  };
  task_.start(label, work, [this, back, words = step.command](Result<Fitted> now) {
    if (task_.cancelled()) return;
    if (!now) return message_.say(now.error());
    back ? commands_.undid(words) : commands_.did_again(words);
    (void)(back ? edited_.undo() : edited_.redo());
    show(std::move(*now));
  });
}

void ModelController::undo() {
  if (busy()) return;
  if (edited_.last() == nullptr) {
    auto before = model::undo(model());
    if (!before) return message_.say(before.error());
    edited_.did_before({model().history.back().effect, std::move(*before), ModelCommands::added_before()});
  }
  step_over(true);
}

void ModelController::redo() {
  if (busy()) return;
  if (edited_.next() == nullptr) return message_.say("nothing to redo", Tone::warning);
  step_over(false);
}

void ModelController::save() {
  if (busy()) return;
  model::Model after = model_to_keep(model(), fit_, data(), work_->data_name);
  std::string beside;
  if (!saved_) {  // what people wrote into the file by hand, comments too, is not lost
    const auto before = read_file(files_.model);
    if (before && !before->empty() && *before != to_toml(after)) {
      beside = files_.model + ".before";
      std::error_code error;
      for (int i = 2; std::filesystem::exists(beside, error); ++i) beside = fmt::format("{}.before{}", files_.model, i);
      if (const auto kept = write_file(beside, *before); !kept) return message_.say(kept.error());
    }
  }
  if (const auto kept = keep_model(files_.model, after, files_.model); !kept) return message_.say(kept.error());
  edited_.saved_as(std::move(after));
  commands_.saved(to_toml(model()));
  record_saved_model(files_, model());
  saved_ = true;
  values_kept_ = true;
  message_.say("saved in " + files_.model + " with the fitted values" +
               (beside.empty() ? "" : "; the earlier version is in " + beside));
}

void ModelController::start_after(const std::vector<std::string>& measured_again) {
  if (busy()) return;
  message_.clear();
  const auto compute = [model = model(), work = work_, files = files_, measured_again](JobControl&) -> Result<Lines> {
    NoMessages messages;
    const ModelWork now{model, work->machine, {}, work->data, work->data_name};
    ECS_TRY(answer, what_if_answer(messages, now, files.model, measured_again, files.import));
    return owned_lines_of(what_if_cell(answer).text);
  };
  task_.start("computing the error after compensation", compute, [this, measured_again](Result<Lines> lines) {
    if (task_.cancelled()) return;
    if (!lines) return message_.say(lines.error());
    after_ = std::move(*lines);
    commands_.looked_after(changed(), measured_again);
  });
}

void ModelController::export_picture(FigureWriter write) {
  commissioning::export_picture(
      drawing_, fit_figure(fit_, data(), files_.model), std::filesystem::path(files_.model).stem().string(),
      std::move(write), message_,
      [commands = commands_, changed = changed()](const std::string& picture) { commands.drawn(changed, picture); });
}

void ModelController::cancel() {
  if (added_work_.running()) return added_work_.cancel();
  if (!busy()) return;
  task_.cancel();
  message_.say("cancelled", Tone::warning);
}

void ModelController::take(Result<Fitted> fitted) {
  if (!fitted) return message_.say(fitted.error());
  did(fitted->done, std::move(fitted->model), fitted->words);
  show(std::move(*fitted));
}

void ModelController::show(Fitted fitted) {
  fit_ = std::move(fitted.fit);
  comparison_ = std::move(fitted.comparison);
  diagnosis_.reset();
  next_.reset();
  after_.clear();
  planned_.reset();
  ++generation_;
  message_.say(fitted.said);
  keep();
}

void ModelController::take(Diagnosed found) {
  if (!found.diagnosis) return message_.say(found.diagnosis.error());
  diagnosis_ = std::move(*found.diagnosis);
  record_diagnosis(files_, model(), *diagnosis_);
  commands_.diagnosed(changed());
  next_ = std::move(found.next);
  if (found.ties && !found.ties->notes.empty()) take(*found.ties);
}

void ModelController::take(const model::DecidedTies& ties) {
  message_.say(fmt::format("{}", fmt::join(ties.notes, "; ")));
  model::Model after = model();
  for (std::size_t i = 0; i < after.effects.size(); ++i)
    after.effects[i].tied_with = fit_.effects[i].effect.tied_with = ties.model.effects[i].tied_with;
  if (did("evaluating these readings", std::move(after), commands_.fit())) keep();
}

bool ModelController::advance() {
  const bool drawn = drawing_.advance();
  const bool added = added_work_.advance();
  return task_.advance() || drawn || added || busy();
}

std::string ModelController::params_beside(const std::string& machine_file) {
  const auto file = std::filesystem::path(machine_file).parent_path() / "parameters.toml";
  return !machine_file.empty() && disc::exists(file) ? file.string() : "";
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
      written.lines = owned_lines_of(
          verdict_text(written.map->compiled.map, written.map->findings, false, written.map->enter_squareness) + "\n" +
          from_model_cell(*written.map, arguments).text);
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
      message_.say(fmt::format("map written to {}, its parameters to {}; press t to send both to the unit",
                               arguments.output, arguments.params_out));
    else
      message_.say(fmt::format("map written to {}, but it is not complete, and the unit refuses it", arguments.output),
                   Tone::warning);
  });
}

/// Parameters that came from the unit are received again by a command of their own.
void ModelController::note_map(const FromModelArguments& arguments) {
  if (changed()) note_remark("the map belongs to the last saved model");
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
    message_.say("no map to send yet: press m to build it from the model", Tone::warning);
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
                                      attempt.begun ? ". The unit keeps its old map until a new one is complete." : ""),
                          Tone::bad);
    sent_ = std::move(*attempt.sent);
    note_sent_map(*unit_, files);
    message_.say(sent_text(*sent_) + "; press c to switch the unit to compensation");
  });
  ready_.reset();
}

bool ModelController::may_compensate() {
  if (!has_unit()) return false;
  if (!sent_) message_.say("the map has not been sent yet: press t to send it", Tone::warning);
  return sent_.has_value();
}

void ModelController::compensate() {
  if (!may_compensate()) return;
  const auto work = [expected = ExpectedMap(*sent_), unit = unit_](JobControl& control) {
    return switch_to_compensation(*unit, control, expected);
  };
  task_.start("switching to compensation", work, [this](const Result<void>& done) {
    if (!done) return message_.say(done.error());
    note_on_unit(*unit_, {"utility", "mode", "compensate", "--wait", "0"});
    message_.say(unit_->snapshot().emulator
                     ? "the unit is waiting: press g in DISPLAY ECS STATUS (F3) to reference the emulated machine, and "
                       "e in step 1 of PROCESS LASER DATA to measure it again; press o here to open those files"
                     : "reference every axis at the control now; the unit is waiting and then compensates. Measure the "
                       "same lines again and press o to open those files");
  });
}

}  // namespace ecs::commissioning
