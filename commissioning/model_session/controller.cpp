#include "commissioning/model_session/controller.hpp"

#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/models/compare_view.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/what_if.hpp"

namespace ecs::commissioning {

using model::Observations;

Result<ModelController::Fitted> ModelController::fitted(model::Model model, const Observations& data,
                                                        std::string said) {
  auto fit = model::fit(model, data);
  if (!fit) return tl::unexpected(fit.error());
  auto comparison = owned_lines_of(comparison_cell(model::compare(*fit, data), data.size()).text);
  return Fitted{std::move(model), std::move(*fit), std::move(comparison), std::move(said)};
}

Result<std::unique_ptr<ModelController>> ModelController::open(const ModelArguments& files) {
  NoMessages messages;
  auto work = model_work(messages, files);
  if (!work) return tl::unexpected(work.error());
  auto first = fitted(work->model, work->data, "");
  if (!first) return tl::unexpected(in_file(first.error(), files.model));
  std::unique_ptr<ModelController> controller(new ModelController);
  controller->files_ = files;
  controller->work_ = std::make_shared<const ModelWork>(std::move(*work));
  controller->lines_ = measured_lines(controller->data());
  const std::set<int> runs(controller->data().run.begin(), controller->data().run.end());
  controller->runs_.assign(runs.begin(), runs.end());
  controller->model_ = std::move(first->model);
  controller->fit_ = std::move(first->fit);
  controller->comparison_ = std::move(first->comparison);
  return controller;
}

Result<std::unique_ptr<ModelController>> ModelController::begin_new(const ModelArguments& files) {
  NoMessages messages;
  if (const auto begun = begun_model(messages, files); !begun) return tl::unexpected(begun.error());
  auto controller = open(files);
  if (!controller) {
    std::error_code error;
    std::filesystem::remove(files.model, error);
    return controller;
  }
  (*controller)
      ->message_.say(fmt::format(
          "begun in {} with offset, slope and backlash of what was measured; d finds what else there is, a adds it",
          std::filesystem::path(files.model).filename().string()));
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

std::string ModelController::draft_name() const {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(files_.model, error);
  return "model-" + sha256_hex(path.string()).substr(0, 16);
}

std::optional<Draft> ModelController::draft() const { return draft_of(draft_name()); }
void ModelController::drop_draft() { commissioning::drop_draft(draft_name()); }

void ModelController::take_draft() {
  const auto kept = draft();
  if (!kept || busy()) return;
  auto model = model::parse_model(kept->text, "the unsaved work", std::filesystem::path(files_.model).parent_path());
  if (!model) return message_.say(model.error());
  start_fit("taking up the unsaved work", [model = std::move(*model), work = work_] {
    return fitted(model, work->data, "unsaved work taken up; s writes it to the model file");
  });
}

void ModelController::start_diagnosis() {
  if (busy()) return;
  message_.clear();
  const auto work = [model = model_, data = work_](JobControl& control) {
    model::DiagnoseOptions options;
    options.cancelled = &control.cancelled;
    Diagnosed found{model::diagnose(model, data->data, options), {}};
    if (found.diagnosis && !control.cancelled)
      found.next = model::next_measurement(model, data->data, *found.diagnosis);
    return found;
  };
  task_.start("looking for what is missing", work, [this](Diagnosed found) {
    if (!task_.cancelled()) take(std::move(found));
  });
}

void ModelController::start_adding(std::size_t candidate) {
  if (busy() || !diagnosis_ || candidate >= diagnosis_->candidates.size()) return;
  const model::EffectInstance& effect = diagnosis_->candidates[candidate].effect;
  const model::AddRequest request{effect.id,       effect.axis,   effect.sense,   effect.code,
                                  effect.approach, effect.sensor, effect.sensor2, effect.name};
  start_fit("adding " + to_text(effect), [model = model_, work = work_, request]() -> Result<Fitted> {
    auto added = model::add_effect(model, work->data, request, work->data_name);
    if (!added) return tl::unexpected(added.error());
    return fitted(std::move(added->model), work->data,
                  fmt::format("added {}: {:.3f} -> {:.3f} um rms; u takes it back, s writes the model",
                              to_text(added->effect.effect), added->rms_before_um, added->rms_after_um));
  });
}

void ModelController::undo() {
  if (busy()) return;
  auto before = model::undo(model_);
  if (!before) return message_.say(before.error());
  const std::string taken = model_.history.empty() ? "" : model_.history.back().effect;
  start_fit("taking back " + taken, [model = std::move(*before), work = work_, taken] {
    return fitted(model, work->data, "taken back: " + taken);
  });
}

void ModelController::save() {
  if (busy()) return;
  std::string beside;
  if (!saved_) {  // what people wrote into the file by hand, comments too, is not lost
    const auto before = read_file(files_.model);
    if (before && !before->empty()) {
      beside = files_.model + ".before";
      if (const auto kept = write_file(beside, *before); !kept) return message_.say(kept.error());
    }
  }
  if (const auto kept = keep_model(files_.model, model_, files_.model); !kept) return message_.say(kept.error());
  saved_ = true;
  changed_ = false;
  drop_draft();
  message_.say("written to " + files_.model + (beside.empty() ? "" : "; as it was: " + beside));
}

void ModelController::start_after(const std::vector<std::string>& measured_again) {
  if (busy()) return;
  message_.clear();
  const auto compute = [model = model_, work = work_, files = files_, measured_again](JobControl&) -> Result<Lines> {
    NoMessages messages;
    const ModelWork now{model, work->machine, {}, work->data, work->data_name};
    const auto answer = what_if_answer(messages, now, files.model, measured_again, files.import);
    if (!answer) return tl::unexpected(answer.error());
    return owned_lines_of(what_if_cell(*answer).text);
  };
  task_.start("computing what compensation would leave", compute, [this](Result<Lines> lines) {
    if (task_.cancelled()) return;
    if (!lines) return message_.say(lines.error());
    after_ = std::move(*lines);
  });
}

void ModelController::start_map(const std::string& output) {
  if (busy()) return;
  if (changed_) return message_.say("save the model first (s): the map's header names its file", Tone::warning);
  message_.clear();
  const auto build = [files = files_, output](JobControl&) -> Result<Lines> {
    NoMessages messages;
    FromModelArguments arguments;
    arguments.model = files.model;
    arguments.machine = files.machine;
    arguments.output = output;
    arguments.params_out = std::filesystem::path(output).replace_extension(".params.toml").string();
    const auto built = map_from_model(messages, arguments);
    if (!built) return tl::unexpected(built.error());
    return owned_lines_of(from_model_cell(*built, arguments).text);
  };
  task_.start("compiling the model to a map", build, [this](Result<Lines> lines) {
    if (!lines) return message_.say(lines.error());
    after_ = std::move(*lines);
  });
}

void ModelController::export_picture(FigureWriter write) {
  commissioning::export_picture(drawing_, fit_figure(fit_, data(), files_.model),
                                std::filesystem::path(files_.model).stem().string(), std::move(write), message_);
}

void ModelController::start_investigation(const std::string& place, const std::string& minutes) {
  if (busy()) return;
  const auto number = number_in(minutes);
  if (!number || !(*number > 0.0))
    return message_.say(fmt::format("expected minutes that the runs may take, found \"{}\"", minutes), Tone::bad);
  if (files_.machine.empty())
    return message_.say("open the model with its machine file: an investigation needs travels and lever arms",
                        Tone::bad);
  if (changed_) return message_.say("save the model first (s): the investigation begins with its file", Tone::warning);
  message_.clear();
  investigation_.start({files_.model, files_.machine, place, *number});
}

void ModelController::write_investigated(const std::string& file) {
  if (const auto written = investigation_.write_model(file); !written) return message_.say(written.error());
  message_.say("written to " + file);
}

void ModelController::cancel() {
  if (investigation_.busy()) return investigation_.stop();
  if (!busy()) return;
  task_.cancel();
  message_.say("given up", Tone::warning);
}

void ModelController::take(Result<Fitted> fitted) {
  if (!fitted) return message_.say(fitted.error());
  model_ = std::move(fitted->model);
  fit_ = std::move(fitted->fit);
  comparison_ = std::move(fitted->comparison);
  diagnosis_.reset();
  next_.reset();
  after_.clear();
  changed_ = true;
  ++generation_;
  message_.say(fitted->said);
  if (const auto kept = keep_draft(draft_name(), to_toml(model_)); !kept) message_.say(kept.error());
}

void ModelController::take(Diagnosed found) {
  if (!found.diagnosis) return message_.say(found.diagnosis.error());
  diagnosis_ = std::move(*found.diagnosis);
  next_ = std::move(found.next);
}

bool ModelController::advance() {
  const bool drawn = drawing_.advance();
  const bool investigating = investigation_.busy();
  const bool changed = investigation_.advance();
  if (investigating && !investigation_.busy()) message_ = investigation_.message();
  return task_.advance() || drawn || changed || busy();
}

}  // namespace ecs::commissioning
