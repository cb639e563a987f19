// The investigation on the page Next of the MODEL screen: started, watched, stopped, gone on with, its model written;
// its keys, and its ledger in place of the next measurement. What the module brings.

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/screens/model/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/model_session/controller.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/records.hpp"
#include "model/fit/model_file.hpp"
#include "modules/investigation/investigation.hpp"
#include "modules/investigation/workshops.hpp"

namespace ecs::app {
namespace {

/// What comes of an action the message of the model's controller tells.
class InvestigationController {
 public:
  /// @param model  outlives it
  explicit InvestigationController(ModelController& model) : model_(model) {}

  /// Whether an investigation can begin; says why not.
  [[nodiscard]] bool may_begin();
  /// Socket of the workshop around the emulated machine of the link; empty: none.
  [[nodiscard]] std::string emulated_workshop() const;
  /// Where it works: as typed, the socket of a workshop or a folder for readings; empty: the emulated machine of the
  /// link. Nothing: there is none, or it is another machine than the model's; the message says so.
  [[nodiscard]] std::optional<std::string> place_of(const std::string& typed);
  /// Asks a workshop for one run after the other; goes on where one at that place was stopped, else starts again. The
  /// link of the screens serves where it is to the unit of the workshop.
  /// @param minutes  that the runs may take
  void start(const std::string& place, const std::string& minutes);
  /// Writes the model with the causes; refused where that would destroy another file.  @pre found()
  void write_model(const std::string& file);

  [[nodiscard]] bool was_begun() const { return followed_ != nullptr; }
  [[nodiscard]] const std::string& place() const { return place_; }  ///< of the last one; empty: none was started
  [[nodiscard]] double minutes() const { return minutes_; }          ///< of the last one, else the usual
  [[nodiscard]] LedgerView view() const;
  /// Of the last one that came to its end.
  [[nodiscard]] const std::optional<Investigation>& found() const { return found_; }

 private:
  [[nodiscard]] NotedCommand command(const std::string& file) const;
  void take(Result<Investigation> investigation);

  ModelController& model_;
  std::string place_;
  double minutes_ = 240.0;
  std::shared_ptr<FollowedInvestigation> followed_;
  std::optional<Investigation> found_;
  std::size_t noted_ = 0;  ///< place of the command of what was found
};

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
                                   found->verdict ? model::name_of(*found->verdict) : "no measurement was made"),
            .content = one_line(object_of("screen"_is("MODEL"), "answer"_is(investigation_cell(*found).json)))});
  return found;
}

bool InvestigationController::may_begin() {
  if (model_.busy()) return false;
  if (model_.files().machine.empty())
    model_.message().say("open the model with its machine file: an investigation needs travels and lever arms",
                         Tone::bad);
  else if (model_.changed())
    model_.message().say("save the model first (s): the investigation starts from its file", Tone::warning);
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
    model_.message().say(fmt::format("the emulated machine of this link is {}, the machine file of the model is of {}: "
                                     "set the link to emulator:{} in LINK (F3) first",
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
    return model_.message().say(fmt::format("expected the minutes available for the runs, found \"{}\"", minutes),
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
    model_.message().say("the investigation is complete");
    noted_ = note(command({}));
  } else if (model_.added_work().cancelled()) {
    model_.message().say("stopped. The measurements are kept; press i to continue", Tone::warning);
  } else {
    model_.message().say(investigation.error());
  }
}

LedgerView InvestigationController::view() const { return followed_ ? view_of(followed_->progress()) : LedgerView{}; }

/// @param file  for the model with the causes; empty: it is not written
NotedCommand InvestigationController::command(const std::string& file) const {
  const bool watches = disc::is_folder(place_);
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

/// The place, then the minutes.
void ask_investigation(InvestigationController& investigation, Prompt& prompt) {
  if (!investigation.may_begin()) return;
  const std::string emulated = investigation.emulated_workshop();
  const std::string before = investigation.place();
  const auto take = [&investigation, &prompt](const std::string& typed) {
    const auto place = investigation.place_of(typed);
    if (place)
      prompt.ask("minutes available for the runs:", Prompt::Kind::number, fmt::format("{:g}", investigation.minutes()),
                 [&investigation, place = *place](const std::string& most) { investigation.start(place, most); });
  };
  prompt
      .ask("workshop socket, or folder for readings:", Prompt::Kind::path, before == emulated ? "" : before, take,
           std::string(emulated.empty() ? "" : "empty: the emulated machine; else the ") +
               "socket of `ecs-emulator serve --workshop`, or a folder to which you copy the file of each measurement")
      .or_nothing();
}

/// A row a run, a bar as long as causes are still possible; below it the set, the run under way, what was said.
void draw_ledger(Canvas& canvas, const Area& area, const InvestigationController& investigation,
                 const ScrollPlace& scroll) {
  constexpr int kBar = 8;
  const commissioning::LedgerView view = investigation.view();
  const Area text = area.between_margins();
  const int numbers = width_of(commissioning::ledger_numbers_head()) + 2;
  canvas.text(text, 0, 0, commissioning::ledger_numbers_head(), Tone::faint);
  canvas.text(text, 0, numbers + kBar + 1, "measured", Tone::faint);
  std::vector<std::string> below;
  const auto add = [&](const std::string& paragraph) {
    for (std::string& line : wrapped(paragraph, text.columns)) below.push_back(std::move(line));
  };
  if (!view.set.empty()) add(view.set);
  if (!view.doing.empty()) add(view.doing);
  if (investigation.found())
    for (std::string& line :
         sentences_wrapped(owned_lines_of(commissioning::summary_text(*investigation.found())), text.columns))
      below.push_back(std::move(line));
  for (auto said = view.said.rbegin(); said != view.said.rend(); ++said) add(*said);  // newest first
  const auto least = static_cast<std::size_t>(std::max(1, area.rows / 3));  // the newest rows of a long ledger
  const auto room = static_cast<std::size_t>(std::max(2, area.rows - 2)) - std::min(below.size(), least);
  int row = 1;
  for (std::size_t k = view.rows.size() > room ? view.rows.size() - room : 0; k < view.rows.size(); ++k, ++row) {
    const commissioning::LedgerRow& step = view.rows[k];
    canvas.text(text, row, 0, step.numbers);
    draw_bar(canvas, {text.row, text.column + numbers, text.rows, kBar}, row, static_cast<double>(step.members), kBar,
             step.settled ? Tone::good : Tone::forward);
    canvas.text(text, row, numbers + kBar + 1, step.measured, step.settled ? Tone::good : Tone::plain);
  }
  draw_scrolled(canvas, text.below(row + 1), below, scroll);
}

NextPart investigation_part(ModelController& model, Prompt& prompt) {
  const auto investigation = std::make_shared<InvestigationController>(model);
  const auto write_found = [investigation, &model, &prompt] {
    prompt.ask("write the model to:", Prompt::Kind::path,
               std::filesystem::path(model.model_file()).replace_extension(".found.toml").string(),
               [investigation](const std::string& file) { investigation->write_model(file); });
  };
  return {
      {{"f", "save the findings", write_found, [investigation] { return investigation->found().has_value(); }},
       {"i", "investigate", [investigation, &prompt] { ask_investigation(*investigation, prompt); }}},
      [investigation](Canvas& canvas, const Area& area, const ScrollPlace& scroll) {
        if (investigation->was_begun()) draw_ledger(canvas, area, *investigation, scroll);
        return investigation->was_begun();
      },
      "Or press i to measure, diagnose and make the next run until one cause remains, in the workshop of an emulator "
      "or with files that you provide.",
      "On the page Next, press i to investigate: run after run is measured, by the emulated machine or by you "
      "(with files), until one cause remains. The list of runs shows minutes, error and the causes that remain. Press "
      "Esc to stop, i to continue, and f to save the model with the causes found."};
}

}  // namespace

extern const std::vector<Action> kModelInvestigation;

const Module& investigation_module() {
  static const Module module{.verbs = {{"model next", &kModelInvestigation}}, .next_part = investigation_part};
  return module;
}

}  // namespace ecs::app
