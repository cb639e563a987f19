#include "app/screens/parameters/screen.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace ecs::app {

ParametersScreen::ParametersScreen(std::shared_ptr<UnitConnection> line)
    : draft_(controller_.draft()), transfer_(std::move(line), controller_, message_) {}

std::vector<ParameterRow> ParametersScreen::rows() const {
  return rows_of(static_cast<params::Group>(static_cast<int>(page_)), controller_.set().parameters);
}

std::string ParametersScreen::key_here() const {
  if (!on_group()) return {};
  const auto list = rows();
  const int at = place().selected;
  return at >= 0 && at < static_cast<int>(list.size()) ? list[static_cast<std::size_t>(at)].key : "";
}

int ParametersScreen::page_rows() const { return std::max(2, list_area_.rows - 1); }

/// Off a heading, in the direction of the move, else the other way.
void ParametersScreen::settle_on_field(int direction) {
  const auto list = rows();
  const int count = static_cast<int>(list.size());
  const auto is_field = [&](int at) {
    return at >= 0 && at < count && !list[static_cast<std::size_t>(at)].key.empty();
  };
  int& at = place().selected;
  at = std::clamp(at, 0, std::max(0, count - 1));
  for (const int by : {direction, -direction}) {
    int there = at;
    while (there >= 0 && there < count && !is_field(there)) there += by;
    if (is_field(there)) {
      at = there;
      return;
    }
  }
}

void ParametersScreen::turn_page(int to) {
  page_ = static_cast<Page>((to + kPages) % kPages);
  if (on_group()) settle_on_field(1);
}

void ParametersScreen::go_to(const std::string& key) {
  for (const Page page : {Page::configuration, Page::compensation, Page::datuming}) {
    const auto list = rows_of(static_cast<params::Group>(static_cast<int>(page)), controller_.set().parameters);
    const auto found = std::find_if(list.begin(), list.end(), [&](const ParameterRow& row) { return row.key == key; });
    if (found == list.end()) continue;
    page_ = page;
    place().selected = static_cast<int>(found - list.begin());
    return;
  }
  message_.say(fmt::format("{} belongs to an axis that configuration.axes does not name", key), Tone::warning);
}

bool ParametersScreen::typing() const { return prompt_ || seeking_ || (edit_ && !edit_->choosing); }

std::string ParametersScreen::unsaved() const {
  if (!controller_.unsaved()) return {};
  return fmt::format("Parameters: {} change{} neither saved nor sent. A draft is kept and offered next time.",
                     controller_.changes(), controller_.changes() == 1 ? "" : "s");
}

bool ParametersScreen::advance() {
  bool changed = transfer_.advance();
  if (prompt_ && prompt_->chooser) changed = prompt_->chooser->advance() || changed;
  if (Asking question = transfer_.take_question(); question.active()) asking_ = std::move(question);
  if (controller_.loaded() && on_group()) settle_on_field(1);
  if (!controller_.loaded() && seen_changes_ != transfer_.connection().changes()) {
    seen_changes_ = transfer_.connection().changes();
    changed = true;
  }
  return changed;
}

Step ParametersScreen::on_key(const Key& key) {
  if (answers(asking_, key)) return std::exchange(leaving_, false) ? back() : stay();
  if (key.name != Key::Name::none && key.name != Key::Name::resized) message_.clear();
  if (prompt_) {
    on_prompt_key(key);
    return stay();
  }
  if (edit_) {
    on_edit_key(key);
    return stay();
  }
  if (seeking_) {
    on_seek_key(key);
    return stay();
  }
  if (transfer_.task().running() && key.name == Key::Name::escape) {
    transfer_.cancel();
    return stay();
  }
  return controller_.loaded() ? on_page_key(key) : on_start_key(key);
}

Step ParametersScreen::leave() {
  if (!controller_.unsaved()) return back();
  asking_.ask({"Leave the parameters?", unsaved(), "leave", "stay"}, [this] { leaving_ = true; });
  return stay();
}

Step ParametersScreen::on_start_key(const Key& key) {
  if (key.name == Key::Name::escape || is_letter(key, U'q')) return back();
  if (transfer_.task().running()) return stay();
  const bool enter = key.name == Key::Name::enter;
  if (draft_) {
    if (is_letter(key, U'd') || (enter && start_.selected == 1)) {
      asking_.ask(
          {"Drop the unsaved work?", fmt::format("What was edited at {} is lost.", draft_->kept), "drop", "keep"},
          [this] {
            drop_draft(kParametersDraft);
            draft_ = controller_.draft();
            start_ = {};
          });
    } else if (is_letter(key, U'b') || (enter && start_.selected == 2)) {
      set_draft_aside(kParametersDraft);
      draft_.reset();
      start_ = {};
      message_.say("The unsaved work is kept; it is offered again when there is no other.");
    } else if (is_letter(key, U'o') || (enter && start_.selected == 3)) {
      exchange_draft(kParametersDraft);
      draft_ = controller_.draft();
    } else if (enter) {
      after(controller_.take_up_draft(), "the unsaved work is here again");
      if (controller_.loaded()) turn_page(0);
    } else {
      (void)start_.on_key(key, drafts_aside(kParametersDraft) == 0 ? 3 : 4);
    }
    return stay();
  }
  if (is_letter(key, U'r') || (enter && start_.selected == 0)) {
    receive();
  } else if (is_letter(key, U'o') || (enter && start_.selected == 1)) {
    ask_for_file();
  } else if (is_letter(key, U'n') || (enter && start_.selected == 2)) {
    ask_for_machine();
  } else {
    (void)start_.on_key(key, 3);
  }
  return stay();
}

Step ParametersScreen::on_page_key(const Key& key) {
  if (key.name == Key::Name::escape || is_letter(key, U'q')) return leave();
  if (key.name == Key::Name::tab || key.name == Key::Name::back_tab) {
    turn_page(static_cast<int>(page_) + (key.name == Key::Name::tab ? 1 : -1));
  } else if (key.name == Key::Name::letter && key.letter >= U'1' && key.letter < U'1' + kPages) {
    turn_page(static_cast<int>(key.letter - U'1'));
  } else if (key.name == Key::Name::mouse) {
    on_click(key);
  } else if (is_letter(key, U'/')) {
    begin_seeking();
  } else if (on_group() && place().on_key(key, static_cast<int>(rows().size()), page_rows())) {
    const bool upwards = key.name == Key::Name::up || key.name == Key::Name::page_up || key.name == Key::Name::end;
    settle_on_field(upwards ? -1 : 1);
  } else if (page_ == Page::findings &&
             place().on_key(key, static_cast<int>(controller_.findings().size()), page_rows())) {
    return stay();
  } else if (page_ == Page::compare &&
             place().on_key(key, static_cast<int>(controller_.compared().size()), page_rows())) {
    return stay();
  } else if (transfer_.task().running()) {
    message_.say("wait until the exchange with the unit is done, or Esc cancels it", Tone::warning);
  } else if (!on_command(key)) {
    if (on_group())
      on_field_key(key);
    else if (page_ == Page::findings)
      on_findings_key(key);
    else
      on_compare_key(key);
  }
  return stay();
}

bool ParametersScreen::on_command(const Key& key) {
  if (is_letter(key, U's'))
    ask_where_to_save();
  else if (is_letter(key, U't'))
    send();
  else if (is_letter(key, U'r'))
    unless_lost("Receive the parameters of the unit?", [this] { receive(); });
  else if (is_letter(key, U'o'))
    unless_lost("Open another file?", [this] { ask_for_file(); });
  else if (is_letter(key, U'n'))
    unless_lost("Begin with new parameters?", [this] { ask_for_machine(); });
  else if (is_letter(key, U'm'))
    ask_for_check();
  else if (is_letter(key, U'l'))
    look_again();
  else if (is_letter(key, U'u') || (key.name == Key::Name::control && key.letter == U'z'))
    report_undo(controller_.undo(), "taken back");
  else if (is_letter(key, U'y') || (key.name == Key::Name::control && key.letter == U'y'))
    report_undo(controller_.redo(), "done again");
  else
    return false;
  return true;
}

void ParametersScreen::report_undo(const std::string& what, const char* word) {
  if (what.empty())
    message_.say("there is nothing more of that", Tone::warning);
  else
    message_.say(fmt::format("{}: {}", word, what));
  if (on_group()) settle_on_field(1);
}

void ParametersScreen::on_field_key(const Key& key) {
  const std::string here = key_here();
  if (here.empty()) return;
  if (key.name == Key::Name::enter) {
    begin_edit();
  } else if (is_letter(key, U' ') || key.name == Key::Name::right || key.name == Key::Name::left) {
    if (!controller_.cycle(here, key.name == Key::Name::left ? -1 : 1) && is_letter(key, U' ')) begin_edit();
  } else if (is_letter(key, U'd')) {
    controller_.set_default(here);
    message_.say(fmt::format("{} has its default; u takes it back", full_label_of(here)));
  }
  settle_on_field(1);
}

void ParametersScreen::on_findings_key(const Key& key) {
  const auto& findings = controller_.findings();
  if (key.name != Key::Name::enter || findings.empty()) return;
  const auto k = std::min(static_cast<std::size_t>(place().selected), findings.size() - 1);
  if (!findings[k].keys.empty()) go_to(std::string(findings[k].keys.front()));
}

void ParametersScreen::on_compare_key(const Key& key) {
  const auto& compared = controller_.compared();
  if (compared.empty()) return;
  const std::string here = compared[std::min(static_cast<std::size_t>(place().selected), compared.size() - 1)].key;
  if (key.name == Key::Name::enter) {
    return go_to(here);
  }
  if (is_letter(key, U'f') || is_letter(key, U'g')) {
    const bool file = is_letter(key, U'f');
    if (file ? controller_.take_from_file(here) : controller_.take_from_unit(here))
      message_.say(fmt::format("{} taken from the {}; u takes it back", full_label_of(here), file ? "file" : "unit"));
    else
      message_.say(file ? "there is no file to take it from" : "no unit has given a value that could be taken",
                   Tone::warning);
  }
  place().selected = std::clamp(place().selected, 0, std::max(0, static_cast<int>(controller_.compared().size()) - 1));
}

void ParametersScreen::on_click(const Key& key) {
  const int row = key.row - list_area_.row;
  if (row < 0 || row >= list_area_.rows || key.column >= list_area_.column + list_area_.columns) return;
  const int count = on_group() ? static_cast<int>(rows().size())
                               : static_cast<int>(page_ == Page::findings ? controller_.findings().size()
                                                                          : controller_.compared().size());
  place().selected = std::clamp(place().first + row, 0, std::max(0, count - 1));
  if (on_group()) settle_on_field(1);
}

void ParametersScreen::begin_edit() {
  const std::string here = key_here();
  edit_ = ValueEdit{here, TextLine(value_of(here, controller_.set())), !choices_of(here).empty(), ""};
}

void ParametersScreen::on_edit_key(const Key& key) {
  if (key.name == Key::Name::escape) {
    edit_.reset();
  } else if (key.name == Key::Name::enter) {
    if (auto changed = controller_.change(edit_->key, edit_->text.text()); !changed)
      edit_->refusal = changed.error().message;
    else
      edit_.reset();
    if (!edit_) settle_on_field(1);
  } else if (edit_->choosing) {
    const auto choices = choices_of(edit_->key);
    const auto at = std::find(choices.begin(), choices.end(), edit_->text.text());
    const int count = static_cast<int>(choices.size());
    const int now = at == choices.end() ? 0 : static_cast<int>(at - choices.begin());
    const bool onward = is_letter(key, U' ') || key.name == Key::Name::right || key.name == Key::Name::down;
    const bool backward = key.name == Key::Name::left || key.name == Key::Name::up;
    if (onward || backward)
      edit_->text.set(choices[static_cast<std::size_t>((now + (onward ? 1 : count - 1)) % count)]);
  } else if (edit_->text.on_key(key)) {
    edit_->refusal.clear();
  }
}

}  // namespace ecs::app
