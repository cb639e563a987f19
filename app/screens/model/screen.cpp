#include "app/screens/model/screen.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/catalogue.hpp"
#include "app/cli/module.hpp"
#include "app/plot/gnuplot.hpp"
#include "commissioning/files/known_files.hpp"
#include "model/effects/definition.hpp"

namespace ecs::app {
namespace {

/// As far as the names of the library decide it.
std::string completed_effect(const std::string& typed) {
  std::optional<std::string> completed;
  for (const model::EffectDefinition& effect : model::effect_library()) {
    if (!effect.id.starts_with(typed)) continue;
    if (!completed) {
      completed = std::string(effect.id);
      continue;
    }
    const auto differ = std::mismatch(completed->begin(), completed->end(), effect.id.begin(), effect.id.end());
    completed->erase(differ.first, completed->end());
  }
  return completed.value_or(typed);
}

}  // namespace

std::vector<NextPart> next_parts(ModelController& controller, Prompt& prompt) {
  std::vector<NextPart> parts;
  for (const Module* module : modules())
    if (module->next_part != nullptr) parts.push_back(module->next_part(controller, prompt));
  return parts;
}

ModelScreen::ModelScreen(std::unique_ptr<ModelController> controller)
    : controller_(std::move(controller)), draft_(controller_->draft()) {
  auto at = keys_.begin() + 1;
  for (const NextPart& part : parts_)
    for (KeyRow row : part.keys) {
      row.when = [this, when = row.when] { return page_ == Page::next && (!when || when()); };
      at = keys_.insert(at, std::move(row)) + 1;
    }
}

/// Means, one run after the other, all readings.
void ModelScreen::next_run() {
  const auto& runs = controller_->runs();
  if (!shown_.run) {
    shown_ = {shown_.means && runs.size() > 1 ? std::optional(runs.front()) : std::nullopt, !shown_.means};
    return;
  }
  const auto at = std::find(runs.begin(), runs.end(), *shown_.run);
  shown_ =
      at == runs.end() || at + 1 == runs.end() ? ShownReadings{std::nullopt, false} : ShownReadings{*(at + 1), false};
}

void ModelScreen::turn_page(int by) {
  page_ = static_cast<Page>((static_cast<int>(page_) + by + kPages) % kPages);
  scroll_ = {};
}

bool ModelScreen::on_curve_key(const Key& key) {
  const int count = static_cast<int>(controller_->lines().size());
  if (count == 0) return false;
  if (key.name == Key::Name::down || key.name == Key::Name::up) {
    line_ = (line_ + (key.name == Key::Name::down ? 1 : count - 1)) % count;
    view_ = {};
    residual_ = 0;
    return true;
  }
  if (is_letter(key, U'r')) {
    next_run();
    return true;
  }
  if (is_letter(key, U'v')) {
    residual_ = (residual_ + 1) % curves().residual.size();
    return true;
  }
  if (is_letter(key, U'0')) widest_.clear();
  return on_chart_key(key, curves().measured, view_);
}

Step ModelScreen::on_question(const Key& key) {
  const Reply reply = reply_to(key);
  if (draft_) {
    if (reply == Reply::no) return back();
    if (reply == Reply::yes) controller_->take_draft();
    if (is_letter(key, U'd')) controller_->drop_draft();
    if (reply == Reply::yes || is_letter(key, U'd')) draft_.reset();
    return stay();
  }
  if (reply == Reply::none) return stay();
  leaving_ = false;
  if (reply == Reply::no) return stay();
  controller_->drop_draft();
  return back();
}

void ModelScreen::ask_effect() {
  prompt_
      .ask("effect to add:", Prompt::Kind::text, "",
           [this](const std::string& effect) {
             std::string refusal = controller_->start_adding(effect);
             if (refusal.empty()) page_ = Page::ladder;
             return refusal;
           })
      .completed_by(completed_effect);
}

std::size_t ModelScreen::chosen_cause() const {
  const int count = static_cast<int>(controller_->diagnosis()->candidates.size());
  return static_cast<std::size_t>(std::clamp(cause_.selected, 0, std::max(0, count - 1)));
}

/// The list, and on Enter what is known of a row.
bool ModelScreen::on_causes_key(const Key& key) {
  const int count = controller_->diagnosis() ? static_cast<int>(controller_->diagnosis()->candidates.size()) : 0;
  if (count == 0) return false;
  if (key.name == Key::Name::enter) {
    opened_ = opened_ == Opened::details ? Opened::evidence : Opened::details;
    scroll_ = {};
    return true;
  }
  if (opened_ != Opened::list) return false;
  const auto clicked = cause_.clicked(key);
  if (clicked && *clicked < count) cause_.selected = *clicked;
  return clicked || cause_.on_key(key, count);
}

/// What is likely is added on trial, with the fall to expect.
void ModelScreen::ask_to_add_likely(const std::function<void()>& add) {
  const model::Diagnosis& d = *controller_->diagnosis();
  const model::Candidate& candidate = d.candidates[chosen_cause()];
  const std::string expected =
      d.add ? fmt::format(" With {} the rms of held-out readings changes from {:.3g} to {:.3g} {}.",
                          fmt::join(d.add->effects, " and "), d.add->held_out_rms_before_um, d.add->held_out_rms_um,
                          d.noise.unit)
            : "";
  asking_.ask({fmt::format("Add {}, which is likely but not proved?", place_text(candidate.effect)),
               fmt::format("Not proved, because {}.{} {} to be sure.", candidate.but, expected, candidate.decide),
               "add it", "not now"},
              add);
}

/// One of several that these data cannot tell apart, and one that an adequate model does not lack, is added only after
/// a question.
void ModelScreen::add_chosen() {
  const std::size_t chosen = chosen_cause();
  const auto add = [this, chosen] {
    page_ = Page::ladder;
    scroll_ = {};
    residual_ = 0;  // along the line, where the error is seen to fall
    controller_->start_adding(chosen);
  };
  const auto& candidates = controller_->diagnosis()->candidates;
  if (controller_->diagnosis()->verdict == model::Verdict::adequate && !candidates.empty())
    return asking_.ask({fmt::format("Add {} to an adequate model?", place_text(candidates[chosen].effect)),
                        "The residual of the model is noise. This effect would be fitted to that noise and would not "
                        "predict new readings better.",
                        "add it", "not now"},
                       add);
  if (controller_->diagnosis()->verdict == model::Verdict::cannot_tell && !candidates.empty())
    return asking_.ask({fmt::format("Add {} on these data?", place_text(candidates[chosen].effect)),
                        controller_->diagnosis()->headline, "add it", "not now"},
                       add);
  if (!candidates.empty() && candidates[chosen].standing == model::Standing::likely) return ask_to_add_likely(add);
  if (candidates.empty() || candidates[chosen].rivals.empty()) return add();
  std::vector<std::string> rivals;
  for (const model::EffectInstance& rival : candidates[chosen].rivals) rivals.push_back(place_text(rival));
  asking_.ask({fmt::format("Add {}?", place_text(candidates[chosen].effect)),
               fmt::format("These data cannot distinguish it from {}. It is marked \"(or {})\" in model, map and "
                           "report until a measurement decides. {}",
                           fmt::join(rivals, ", "), fmt::join(rivals, ", "), candidates[chosen].next_measurement),
               "add it", "not now"},
              add);
}

/// The model's file is named in the map, so it must hold what is shown.
void ModelScreen::begin_map() {
  if (!controller_->may_build_map()) return;
  const auto ask = [this] {
    const std::string proposed =
        std::filesystem::path(controller_->model_file()).replace_extension(".map.csv").string();
    prompt_.ask("write the map to:", Prompt::Kind::path, proposed, [this](const std::string& map) {
      prompt_
          .ask(
              "parameters of the unit:", Prompt::Kind::path, controller_->params_proposed(),
              [this, map](const std::string& params) {
                std::string refusal = refusal_as(FileKind::parameters, params);
                if (refusal.empty()) controller_->plan_map(map, params);
                return refusal;
              },
              "empty: received from the unit, else those of the machine")
          .or_nothing();
    });
  };
  if (controller_->is_kept()) return ask();
  asking_.ask({"Save the model first?",
               fmt::format("The map refers to its model file. {} will be saved with the fitted values.",
                           controller_->model_file()),
               "save it", "no map now"},
              [this, ask] {
                controller_->save();
                if (controller_->is_kept()) ask();
              });
}

void ModelScreen::write_map(const std::string& zero_reason) {
  if (!controller_->planned_map()) return;
  const auto& exist = controller_->planned_map()->exist;
  if (exist.empty()) return controller_->write_map(zero_reason);
  asking_.ask(
      {fmt::format("Overwrite {}?", exist.front()),
       fmt::format("{} already exist{}. The contents will be overwritten.", fmt::join(exist, " and "),
                   exist.size() == 1 ? "s" : ""),
       "overwrite", "keep"},
      [this, zero_reason] { controller_->write_map(zero_reason); }, [this] { controller_->drop_plan(); });
}

bool ModelScreen::advance() {
  const bool looked = prompt_.advance();
  const bool changed = controller_->advance() || looked;
  if (controller_->busy() || prompt_.active() || asking_.active()) return changed;
  if (const auto& planned = controller_->planned_map()) {
    if (planned->missing.empty())
      write_map("");
    else
      prompt_
          .ask(
              "declared zero because:", Prompt::Kind::text, "not measured, no effect in the model",
              [this](const std::string& reason) { write_map(reason); }, "empty: do not declare them")
          .or_nothing();
    return true;
  }
  if (controller_->ready()) {
    asking_.ask(
        controller_->sending_question(), [this] { controller_->send(); }, [this] { controller_->not_now(); });
    return true;
  }
  return changed;
}

std::size_t ModelScreen::chosen_effect() const {
  return static_cast<std::size_t>(
      std::clamp(effect_.selected, 0, static_cast<int>(controller_->model().effects.size()) - 1));
}

bool ModelScreen::on_ladder_key(const Key& key) {
  const auto& effects = controller_->model().effects;
  const std::size_t chosen = chosen_effect();
  if (key.name != Key::Name::enter || effects[chosen].tied_with.empty())
    return effect_.on_key(key, static_cast<int>(effects.size()));
  asking_.ask({fmt::format("Decide for {}?", place_text(effects[chosen])),
               fmt::format("It could still be {}.", effects[chosen].tied_with), "decided", "leave open"},
              [this, chosen] { controller_->decide(chosen); });
  return true;
}

CellPosition ModelScreen::cursor(const Area& area) const {
  return prompt_.cursor(area, prompt_.choosing() ? 0 : area.rows - 1);
}

std::vector<KeyRow> ModelScreen::key_table() {
  const auto on = [this](Page page) { return [this, page] { return page_ == page; }; };
  const auto causes = [this](Opened opened) {
    return [this, opened] { return page_ == Page::causes && opened_ == opened; };
  };
  const auto after = [this](std::function<void()> act) {
    return [this, act = std::move(act)] {
      act();
      page_ = Page::after;
      scroll_ = {};
    };
  };
  const auto diagnose = [this] {
    page_ = Page::causes;
    cause_ = {};
    opened_ = Opened::list;
    controller_->start_diagnosis();
  };
  const auto compensate = [this] {
    if (controller_->may_compensate())
      asking_.ask({"Switch the unit to compensation?",
                   "The program first checks that the unit still contains the map that was sent. The unit then tests "
                   "its memory, closes the relays once every axis is referenced, and from then on moves the axes by "
                   "the values of that map.",
                   "switch", "not now"},
                  [this] { controller_->compensate(); });
  };
  const auto measured_again = [this] {
    prompt_.choose("Files measured again with compensation", {{FileKind::measurements}, true},
                   [this](const std::vector<std::string>& paths) {
                     for (const std::string& path : paths)
                       if (std::string refusal = refusal_as(FileKind::measurements, path); !refusal.empty())
                         return refusal;
                     controller_->start_after(paths);
                     return std::string();
                   });
  };
  const auto candidates = [this] {
    return page_ != Page::after && controller_->diagnosis() && !controller_->diagnosis()->candidates.empty();
  };
  const auto formula = [this] {
    return page_ != Page::after && controller_->diagnosis() && controller_->diagnosis()->formula;
  };
  const auto add_formula = [this] {
    page_ = Page::ladder;
    scroll_ = {};
    controller_->start_adding_formula();
  };
  return {{"a", "add",
           [this] {
             if (controller_->diagnosis()) add_chosen();
           },
           candidates, true},
          {"f", "add formula", add_formula, formula, true},
          {"Enter", "details", {}, causes(Opened::list)},
          {"Enter", "evidence", {}, causes(Opened::details)},
          {"Enter", "details", {}, causes(Opened::evidence)},
          {"w", "what if", after([this] { controller_->start_after({}); }), on(Page::after), true},
          {"d", "diagnose", diagnose,
           [this] { return page_ != Page::after && (page_ != Page::causes || opened_ == Opened::list); }, true},
          {"s", "save", [this] { controller_->save(); }},
          {"m", "map", after([this] { begin_map(); }), on(Page::after), true},
          {"t", "send", after([this] { controller_->prepare_sending(); }), on(Page::after), true},
          {"c", "compensate", after(compensate), on(Page::after), true},
          {"o", "measured again", after(measured_again), on(Page::after), true},
          {"x Del", "remove", [this] { controller_->start_removing(chosen_effect()); }, on(Page::ladder)},
          {"x Del", "",
           [this] {
             controller_->message().say("To remove an effect, press 4 for the page Ladder, choose it and press x.",
                                        Tone::warning);
           }},
          {"Tab", "page", [this] { turn_page(1); }},
          {"Shift-Tab", "", [this] { turn_page(-1); }},
          {"up/down", "line", {}, on(Page::curves)},
          {"v", "residual against", {}, on(Page::curves)},
          {"r", "runs", {}, on(Page::curves)},
          {"left/right", "cursor", {}, on(Page::curves)},
          {"+ - 0", "zoom", {}, on(Page::curves)},
          {"up/down", "effect", {}, on(Page::ladder)},
          {"up/down", "choose", {}, causes(Opened::list)},
          {"up/down", "read", {}, on(Page::next)},
          {"up/down", "read", {}, on(Page::fails)},
          {"left/right", "sideways", {}, on(Page::fails)},
          {"Esc", "back to the list", {}, [this] { return page_ == Page::causes && opened_ != Opened::list; }},
          {"u", "undo", [this] { controller_->undo(); }},
          {"y", "redo", [this] { controller_->redo(); }},
          {"n", "add an effect by name", [this] { ask_effect(); }},
          {"e", "picture", [this] { controller_->export_picture(write_plot); }}};
}

Step ModelScreen::on_key(const Key& key) {
  if (draft_ || leaving_) return on_question(key);
  if (answers(asking_, key) || prompt_.on_key(key)) return stay();
  if (key.name == Key::Name::escape && page_ == Page::causes && opened_ != Opened::list && !controller_->busy()) {
    opened_ = Opened::list;
    scroll_ = {};
  } else if (key.name == Key::Name::escape || is_letter(key, U'q')) {
    if (!controller_->busy() && !controller_->changed()) return back();
    leaving_ = !controller_->busy();
    controller_->cancel();
  } else if (key.name == Key::Name::letter && key.letter >= U'1' && key.letter < U'1' + kPages) {
    page_ = static_cast<Page>(static_cast<int>(key.letter - U'1'));
    scroll_ = {};
  } else if (!act_on(keys_, key)) {
    on_page_key(key);
  }
  return stay();
}

void ModelScreen::on_page_key(const Key& key) {
  const bool taken = (page_ == Page::curves && on_curve_key(key)) || (page_ == Page::ladder && on_ladder_key(key)) ||
                     (page_ == Page::causes && on_causes_key(key));
  if (!taken && page_ != Page::curves) (void)scroll_.on_key(key);
}

std::vector<KeyHelp> ModelScreen::keys() const {
  if (const auto& question = asking_.question()) return {{"y", question->yes}, {"n", question->no}};
  return prompt_.active() ? prompt_.keys() : helps_of(keys_);
}

std::string ModelScreen::said_by_parts(std::string NextPart::*what) const {
  std::string said;
  for (const NextPart& part : parts_) said += " " + part.*what;
  return said;
}

std::string ModelScreen::help() const {
  return "Compare the model with the measurements, find which effect is missing, add it and see the error fall. "
         "Symbols are readings, lines the model: forward solid, reverse dashed. Press d to try every effect of the "
         "library: the page Missing ranks them with their evidence and the rivals that these data cannot exclude. "
         "Press a to add the effect under the cursor, f to add the formula for the residual, Enter to see explanation "
         "and evidence. The page Ladder shows how far the error fell towards the noise and lists the effects of the "
         "model; press x to remove one. Press n to add an effect by its name, as in cyclic:X:EX, u to undo the last "
         "change, y to redo it. On page After, press w to predict the error after compensation and m to build the map. "
         "Press t to send the map to the unit, with the same checks and questions as PROCESS LASER DATA. Press c to "
         "switch the unit to compensation, and o to compare with files measured again. Press r to show the means of "
         "the targets, then each run, then all readings. Press v to plot the residual against the phase of each period "
         "in the model, the run and each sensor. The scale of the residual is kept when an effect is added; press 0 to "
         "reset "
         "it." +
         said_by_parts(&NextPart::help);
}

std::string ModelScreen::unsaved() const {
  return controller_->changed() ? controller_->model_file() + " has changes that are not saved" : "";
}

}  // namespace ecs::app
