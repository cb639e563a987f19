#include "app/screens/model/screen.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/catalogue.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/ui/talk.hpp"
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

ModelScreen::ModelScreen(std::unique_ptr<ModelController> controller)
    : controller_(std::move(controller)), draft_(controller_->draft()) {}

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

void ModelScreen::on_asked(const Key& key) {
  if (key.name == Key::Name::escape) {
    asked_.reset();
    controller_->drop_plan();
  } else if (key.name == Key::Name::tab && asked_->purpose == Asked::For::effect) {
    asked_->line.set(completed_effect(asked_->line.text()));
  } else if (key.name == Key::Name::tab) {
    asked_->line.set(completed_path(asked_->line.text()).completed);
  } else if (key.name == Key::Name::enter) {
    const Asked asked = *asked_;
    asked_.reset();
    const bool may_be_empty = asked.purpose == Asked::For::params || asked.purpose == Asked::For::zero_reason ||
                              asked.purpose == Asked::For::workshop;
    if (may_be_empty || !asked.line.text().empty()) on_answer(asked);
  } else {
    (void)asked_->line.on_key(key);
  }
}

void ModelScreen::on_answer(const Asked& asked) {
  const std::string text = asked.line.text();
  const auto& before = controller_->investigation().request();
  switch (asked.purpose) {
    case Asked::For::map:
      map_file_ = text;
      asked_ = {Asked::For::params, "parameters of the unit (empty: received from it, else those of the machine):",
                TextLine(controller_->params_proposed())};
      return;
    case Asked::For::params:
      return controller_->plan_map(map_file_, text);
    case Asked::For::zero_reason:
      return write_map(text);
    case Asked::For::effect:
      page_ = Page::ladder;
      return controller_->start_adding(text);
    case Asked::For::workshop:
      if (auto place = controller_->investigation_place(text); place)
        workshop_ = std::move(*place);
      else
        return;
      asked_ = {Asked::For::minutes,
                "minutes that the runs may take:", TextLine(before ? fmt::format("{:g}", before->minutes) : "240")};
      return;
    case Asked::For::minutes:
      return controller_->start_investigation(workshop_, text);
    case Asked::For::investigated:
      return controller_->write_investigated(text);
  }
}

bool ModelScreen::on_investigation_key(const Key& key) {
  const InvestigationController& investigation = controller_->investigation();
  if (is_letter(key, U'i')) {
    if (!controller_->may_investigate()) return true;
    const std::string emulated = controller_->emulated_workshop();
    const std::string before = investigation.request() ? investigation.request()->place : "";
    asked_ = {Asked::For::workshop,
              fmt::format("workshop socket, or folder for readings{}:",
                          emulated.empty() ? "" : " (empty: the emulated machine of this link)"),
              TextLine(before == emulated ? "" : before)};
  } else if (is_letter(key, U'f') && investigation.found()) {
    asked_ = {Asked::For::investigated, "write the model to:",
              TextLine(std::filesystem::path(controller_->model_file()).replace_extension(".found.toml").string())};
  } else {
    return false;
  }
  return true;
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
  const std::string expected = d.add
                                   ? fmt::format(" With {} the rms of readings left out goes from {:.3g} to {:.3g} {}.",
                                                 fmt::join(d.add->effects, " and "), d.add->held_out_rms_before_um,
                                                 d.add->held_out_rms_um, d.noise.unit)
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
                        "What the model leaves is noise. This effect would be fitted to that noise and predicts no new "
                        "readings better.",
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
               fmt::format("These data cannot tell it from {}. It is added with \"(or {})\" in model, map and report, "
                           "until a measurement decides. {}",
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
    asked_ = {Asked::For::map, "write the map to:", TextLine(proposed)};
  };
  if (controller_->is_kept()) return ask();
  asking_.ask({"Save the model first?",
               fmt::format("The map names the model that it was made from. {} is written with the fitted values.",
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
       fmt::format("{} exist{} already. The contents will be overwritten.", fmt::join(exist, " and "),
                   exist.size() == 1 ? "s" : ""),
       "overwrite", "keep"},
      [this, zero_reason] { controller_->write_map(zero_reason); }, [this] { controller_->drop_plan(); });
}

bool ModelScreen::advance() {
  const bool looked = files_.advance();
  const bool changed = controller_->advance() || looked;
  if (controller_->busy() || asked_ || files_.active() || asking_.active()) return changed;
  if (const auto& planned = controller_->planned_map()) {
    if (planned->missing.empty())
      write_map("");
    else
      asked_ = {Asked::For::zero_reason,
                "declared zero because (empty: leave them missing):", TextLine("not measured, no effect in the model")};
    return true;
  }
  if (controller_->ready()) {
    asking_.ask(
        controller_->sending_question(), [this] { controller_->send(); }, [this] { controller_->not_now(); });
    return true;
  }
  return changed;
}

bool ModelScreen::on_ladder_key(const Key& key) {
  const int count = static_cast<int>(controller_->model().effects.size());
  const auto chosen = static_cast<std::size_t>(std::clamp(effect_.selected, 0, count - 1));
  const model::EffectInstance& effect = controller_->model().effects[chosen];
  if (is_letter(key, U'x') || key.name == Key::Name::erase)
    controller_->start_removing(chosen);
  else if (key.name == Key::Name::enter && !effect.tied_with.empty())
    asking_.ask({fmt::format("Is it decided that it is {}?", place_text(effect)),
                 fmt::format("Until now it could be {} as well.", effect.tied_with), "decided", "still open"},
                [this, chosen] { controller_->decide(chosen); });
  else
    return effect_.on_key(key, count);
  return true;
}

bool ModelScreen::on_after_key(const Key& key) {
  if (is_letter(key, U'w')) {
    controller_->start_after({});
  } else if (is_letter(key, U'o')) {
    files_.choose("Files measured again with compensation", {{FileKind::measurements}, true},
                  [this](const std::vector<std::string>& paths) { controller_->start_after(paths); });
  } else if (is_letter(key, U'm')) {
    begin_map();
  } else if (is_letter(key, U't')) {
    controller_->prepare_sending();
  } else if (is_letter(key, U'c')) {
    if (controller_->may_compensate())
      asking_.ask(
          {"Switch the unit to compensation?",
           "The unit is asked once more whether it holds the map that was sent. It then tests its memory, closes "
           "the relays once every axis is referenced, and from then on moves the axes by the values of that map.",
           "switch", "not now"},
          [this] { controller_->compensate(); });
  } else {
    return false;
  }
  page_ = Page::after;
  scroll_ = {};
  return true;
}

CellPosition ModelScreen::cursor(const Area& area) const {
  if (files_.active()) return files_.cursor(area, 0);
  if (!asked_) return {-1, -1};
  const int begin = asked_rows(area) > 0 ? 1 : width_of(asked_->label) + 2;
  return {area.row + area.rows - 1,
          area.column + begin + asked_->line.cursor_column(std::max(4, area.columns - begin - 1))};
}

Step ModelScreen::on_key(const Key& key) {
  if (draft_ || leaving_) return on_question(key);
  if (answers(asking_, key) || files_.on_key(key)) return stay();
  if (asked_) {
    on_asked(key);
    return stay();
  }
  if (key.name == Key::Name::escape && page_ == Page::causes && opened_ != Opened::list && !controller_->busy()) {
    opened_ = Opened::list;
    scroll_ = {};
    return stay();
  }
  if (key.name == Key::Name::escape || is_letter(key, U'q')) {
    if (controller_->busy()) {
      controller_->cancel();
      return stay();
    }
    if (!controller_->changed()) return back();
    leaving_ = true;
    return stay();
  }
  if (key.name == Key::Name::tab || key.name == Key::Name::back_tab) {
    turn_page(key.name == Key::Name::tab ? 1 : -1);
    return stay();
  }
  if (key.name == Key::Name::letter && key.letter >= U'1' && key.letter < U'1' + kPages) {
    page_ = static_cast<Page>(static_cast<int>(key.letter - U'1'));
    scroll_ = {};
    return stay();
  }
  if (is_letter(key, U'd')) {
    page_ = Page::causes;
    cause_ = {};
    opened_ = Opened::list;
    controller_->start_diagnosis();
  } else if (is_letter(key, U'a') && controller_->diagnosis()) {
    add_chosen();
  } else if (is_letter(key, U'u')) {
    controller_->undo();
  } else if (is_letter(key, U'y')) {
    controller_->redo();
  } else if (is_letter(key, U'n')) {
    asked_ = {Asked::For::effect, "effect to add:", {}};
  } else if (is_letter(key, U's')) {
    controller_->save();
  } else if (is_letter(key, U'e')) {
    controller_->export_picture(write_plot);
  } else if (on_after_key(key) || (page_ == Page::next && on_investigation_key(key))) {
    return stay();
  } else if (page_ == Page::curves) {
    (void)on_curve_key(key);
  } else if (page_ == Page::ladder) {
    if (!on_ladder_key(key)) (void)scroll_.on_key(key);
  } else if (page_ == Page::causes) {
    if (!on_causes_key(key)) (void)scroll_.on_key(key);
  } else {
    (void)scroll_.on_key(key);
  }
  return stay();
}

std::vector<KeyHelp> ModelScreen::keys() const {
  if (const auto& question = asking_.question()) return {{"y", question->yes}, {"n", question->no}};
  if (files_.active()) return files_.keys();
  if (asked_) return {{"Enter", "go on"}, {"Tab", "complete"}, {"Esc", "leave it"}};
  std::vector<KeyHelp> keys;
  if (page_ == Page::curves)
    keys = {{"d", "diagnose"}, {"Tab", "page"},          {"up/down", "line"}, {"v", "residual against"},
            {"r", "runs"},     {"left/right", "cursor"}, {"+ - 0", "zoom"}};
  else if (page_ == Page::after)
    keys = {{"w", "what if"},        {"m", "map"},   {"t", "send"}, {"c", "compensate"},
            {"o", "measured again"}, {"Tab", "page"}};
  else if (page_ == Page::causes && opened_ == Opened::list)
    keys = {{"Enter", "details"}, {"d", "diagnose"}, {"Tab", "page"}, {"up/down", "choose"}};
  else if (page_ == Page::causes)
    keys = {{"Enter", opened_ == Opened::details ? "evidence" : "details"}, {"Esc", "back to the list"}};
  else if (page_ == Page::next)
    keys = {{"i", "investigate"}, {"d", "diagnose"}, {"Tab", "page"}, {"up/down", "read"}};
  else if (page_ == Page::ladder)
    keys = {{"d", "diagnose"}, {"x", "remove"}, {"up/down", "effect"}, {"Tab", "page"}};
  else
    keys = {{"d", "diagnose"}, {"Tab", "page"}, {"up/down", "read"}, {"left/right", "sideways"}};
  if (page_ == Page::next && controller_->investigation().found())
    keys.insert(keys.begin(), {"f", "write what was found"});
  if (controller_->diagnosis() && !controller_->diagnosis()->candidates.empty() && page_ != Page::after)
    keys.insert(keys.begin(), {"a", "add"});
  keys.insert(keys.begin() + 2, {"s", "save"});
  keys.push_back({"u", "undo"});
  keys.push_back({"y", "redo"});
  keys.push_back({"n", "name an effect"});
  keys.push_back({"e", "picture"});
  return keys;
}

std::string ModelScreen::help() const {
  return "Compare the model with the measurements, see where it fails, find which effect is missing, add it and watch "
         "the error fall. Signs are readings, lines the model: forward solid, reverse broken. d tries every effect of "
         "the library; the page What is missing ranks them with their evidence and the rivals that these data cannot "
         "exclude; a adds the one under the cursor, Enter explains it and gives the evidence; the Ladder shows how far "
         "the error fell towards the noise, and the "
         "effects of the model, of which x removes one. n adds an effect by its name, as in cyclic:X:EX. u takes the "
         "last change back, y does it again. After tells what compensation would leave (w), builds the map (m), sends "
         "it to the unit after the same checks and question as PROCESS LASER DATA (t), switches the unit to "
         "compensation (c) and shows what it left when measured again (o). r "
         "shows the means of the targets, one run after the other, then all readings; v shows what is left over each "
         "period of the model, by run and against the sensors. The scale of what is left stays when an effect is "
         "added, 0 lets it go. On the page Next i investigates: a workshop is asked for one run after the "
         "other (with the bundled emulator it is the emulated machine of the link) until one cause is left; the ledger "
         "shows minutes, error and the causes still possible. Esc stops it, i goes "
         "on where it was, f writes the model with what was found.";
}

std::string ModelScreen::unsaved() const {
  return controller_->changed() ? controller_->model_file() + " has changes that are not saved" : "";
}

}  // namespace ecs::app
