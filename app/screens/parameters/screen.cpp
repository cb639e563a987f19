#include "app/screens/parameters/screen.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/session/remembered.hpp"

namespace ecs::app {
namespace {

/// Empty: none.
std::string refusal_of(const Result<void>& done) { return done ? "" : to_text(done.error()); }

}  // namespace

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
  message_.say(fmt::format("{} belongs to an axis that is not in configuration.axes", key), Tone::warning);
}

bool ParametersScreen::typing() const { return prompt_.active() || seeking_ || (edit_ && !edit_->choosing); }

std::string ParametersScreen::unsaved() const {
  if (!controller_.unsaved()) return {};
  return fmt::format("Parameters: {} change{} neither saved nor sent. A draft is kept and offered next time.",
                     controller_.changes(), controller_.changes() == 1 ? "" : "s");
}

bool ParametersScreen::advance() {
  bool changed = transfer_.advance();
  changed = prompt_.advance() || changed;
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
  if (prompt_.on_key(key)) return stay();
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
          {"Delete the unsaved work?", fmt::format("The edits made at {} will be lost.", draft_->kept), "drop", "keep"},
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
      after(controller_.take_up_draft(), "the unsaved work is restored");
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
    message_.say("wait until the exchange with the unit is done, or press Esc to cancel it", Tone::warning);
  } else if (!act_on(keys_, key) && on_group()) {
    on_field_key(key);
  }
  return stay();
}

std::vector<KeyRow> ParametersScreen::key_table() {
  const auto fields = [this] { return on_group(); };
  const auto findings = [this] { return page_ == Page::findings; };
  const auto compare = [this] { return page_ == Page::compare; };
  const auto undo = [this] { report_undo(controller_.undo(), "undone"); };
  const auto redo = [this] { report_undo(controller_.redo(), "redone"); };
  const auto default_here = [this] {
    const std::string here = key_here();
    if (here.empty()) return;
    controller_.set_default(here);
    message_.say(fmt::format("{} has its default; press u to undo", full_label_of(here)));
    settle_on_field(1);
  };
  const auto save = [this] { ask_where_to_save(controller_.file().empty() ? "parameters.toml" : controller_.file()); };
  const auto to_compared = [this] {
    if (const std::string here = compared_here(); !here.empty()) go_to(here);
  };
  return {{"Enter", "edit", {}, fields},
          {"Space", "next value", {}, fields},
          {"Enter", "go to field", [this] { go_to_finding(); }, findings},
          {"Enter", "go to field", to_compared, compare},
          {"f", "use file's", [this] { take_compared(true); }, compare},
          {"g", "use unit's", [this] { take_compared(false); }, compare},
          {"u", "undo", undo},
          {"s", "save", save},
          {"t", "send", [this] { send(); }},
          {"r", "receive", [this] { unless_lost("Receive the parameters of the unit?", [this] { receive(); }); }},
          {"/", "find"},
          {"Tab 1-5", "page"},
          {"d", "default of the field", default_here},
          {"y", "redo", redo},
          {"m", "check against a machine file", [this] { ask_for_check(); }},
          {"o", "open a file", [this] { unless_lost("Open another file?", [this] { ask_for_file(); }); }},
          {"n", "new from a machine file",
           [this] { unless_lost("Begin with new parameters?", [this] { ask_for_machine(); }); }},
          {"l", "read the unit again", [this] { look_again(); }},
          {"Ctrl-Z", "", undo},
          {"Ctrl-Y", "", redo}};
}

void ParametersScreen::report_undo(const std::string& what, const char* word) {
  if (what.empty())
    message_.say("no more changes to undo or redo", Tone::warning);
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
  }
  settle_on_field(1);
}

void ParametersScreen::go_to_finding() {
  const auto& findings = controller_.findings();
  if (findings.empty()) return;
  const auto k = std::min(static_cast<std::size_t>(place().selected), findings.size() - 1);
  if (!findings[k].keys.empty()) go_to(std::string(findings[k].keys.front()));
}

std::string ParametersScreen::compared_here() const {
  const auto& compared = controller_.compared();
  if (compared.empty()) return {};
  return compared[std::min(static_cast<std::size_t>(place().selected), compared.size() - 1)].key;
}

void ParametersScreen::take_compared(bool of_file) {
  const std::string here = compared_here();
  if (here.empty()) return;
  if (of_file ? controller_.take_from_file(here) : controller_.take_from_unit(here))
    message_.say(fmt::format("{} copied from the {}; press u to undo", full_label_of(here), of_file ? "file" : "unit"));
  else
    message_.say(of_file ? "no file to copy from" : "no value from a unit to copy", Tone::warning);
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
  edit_ = ValueEdit{here, TextLine(), !choices_of(here).empty(), ""};
  edit_->text.propose(value_of(here, controller_.set()));
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

void ParametersScreen::after(const Result<void>& done, const std::string& said) {
  if (done)
    message_.say(said);
  else
    message_.say(done.error());
}

void ParametersScreen::unless_lost(const std::string& title, std::function<void()> what) {
  if (!controller_.unsaved()) return what();
  asking_.ask(
      {title,
       fmt::format("{} change{} been neither saved nor sent. {} kept as a draft, which is offered again later. Press "
                   "n, then s, to save {} first.",
                   controller_.changes(), controller_.changes() == 1 ? " has" : "s have",
                   controller_.changes() == 1 ? "It is" : "They are", controller_.changes() == 1 ? "it" : "them"),
       "continue, keep the draft", "stay"},
      std::move(what));
}

void ParametersScreen::choose_file(const std::string& title, FileWish wish,
                                   std::function<Result<void>(const std::string&)> take) {
  const std::filesystem::path beside = std::filesystem::path(controller_.file()).parent_path();
  if (!beside.empty()) prompt_.begin_in(beside);
  prompt_.choose(title, std::move(wish),
                 [take = std::move(take)](const std::string& path) { return refusal_of(take(path)); });
}

Result<void> ParametersScreen::opened(const std::string& path) {
  auto opened = controller_.open_file(path);
  if (!opened) return opened;
  turn_page(0);
  message_.say(path + " is open");
  return {};
}

Result<void> ParametersScreen::begun_from(const std::string& machine) {
  auto begun = controller_.start_from_machine(machine);
  if (!begun) return begun;
  turn_page(0);
  message_.say(
      "new parameters: look through pages 1 to 3, above all datum type, output scale and compensation polarity" +
      std::string(controller_.findings().empty() ? "" : "; page 4 shows missing values"));
  return {};
}

void ParametersScreen::open(const std::string& path, FileKind kind) {
  if (draft_) set_draft_aside(kParametersDraft);
  draft_.reset();
  if (const auto done = kind == FileKind::machine ? begun_from(path) : opened(path); !done) message_.say(done.error());
}

void ParametersScreen::ask_for_file() {
  choose_file("open the parameter file", {{FileKind::parameters}},
              [this](const std::string& path) { return opened(path); });
}

void ParametersScreen::ask_for_machine() {
  choose_file("new parameters for the machine file", {{FileKind::machine}},
              [this](const std::string& path) { return begun_from(path); });
}

void ParametersScreen::ask_for_check() {
  choose_file("check axes, travels, transducers and datum against the machine file",
              {{FileKind::machine}, false, "without a machine file"}, [this](const std::string& path) -> Result<void> {
                ECS_DO(controller_.check_with(path));
                const std::size_t count = controller_.findings().size();
                message_.say(count == 0 ? "no findings for these parameters"
                                        : fmt::format("{} finding{}: page 4", count, count == 1 ? "" : "s"),
                             count == 0 ? Tone::good : Tone::warning);
                return {};
              });
}

void ParametersScreen::ask_where_to_save(const std::string& proposed) {
  prompt_.ask(
      "save as:", Prompt::Kind::path, proposed,
      [this](const std::string& typed) {
        const std::string path(trimmed(typed));
        const std::string lost = controller_.overwrites(path);
        if (lost.empty()) return refusal_of(save_to(path));
        const auto again = [this, path] { ask_where_to_save(path); };
        asking_.ask(
            {"Save over it?", lost, "save", "do not save"},
            [this, path, again] {
              const auto saved = save_to(path);
              if (!saved) again();
              if (!saved) message_.say(saved.error());
            },
            again);
        return std::string();
      },
      "Ctrl-U clears the name");
}

Result<void> ParametersScreen::save_to(const std::string& path) {
  ECS_DO(controller_.save(path));
  remember_file(path);
  const std::size_t errors = controller_.errors();
  if (errors == 0)
    message_.say("saved to " + path);
  else
    message_.say(fmt::format("saved to {}, but {}: see page 4", path,
                             errors == 1 ? "there is an error" : fmt::format("there are {} errors", errors)),
                 Tone::warning);
  return {};
}

void ParametersScreen::send() {
  if (controller_.errors() > 0) {
    turn_page(static_cast<int>(Page::findings));
    place().selected = 0;
    message_.say(fmt::format("not sent: {} in these parameters; press Enter to go to the field",
                             controller_.errors() == 1 ? "there is an error"
                                                       : fmt::format("there are {} errors", controller_.errors())),
                 Tone::warning);
    return;
  }
  transfer_.send();
}

void ParametersScreen::receive() {
  if (!transfer_.task().running()) transfer_.receive();
}

void ParametersScreen::look_again() {
  transfer_.look();
  if (transfer_.connection().snapshot().open)
    message_.say("reading the unit again; page 5 shows the differences");
  else
    message_.say("no unit answers; it is read as soon as it does", Tone::warning);
}

void ParametersScreen::begin_seeking() {
  if (!on_group()) turn_page(0);
  seeking_ = Seeking{TextLine(), {}, 0, page_, place().selected};
}

/// Names first, then help and the words of the thesis.
void ParametersScreen::seek() {
  const std::string sought = lower(seeking_->text.text());
  seeking_->found.clear();
  seeking_->at = 0;
  if (sought.empty()) return;
  std::vector<std::string> by_help;
  for (const params::Group group : {params::Group::configuration, params::Group::compensation, params::Group::datuming})
    for (const ParameterRow& row : rows_of(group, controller_.set().parameters)) {
      if (row.key.empty()) continue;
      const KeyWords words = words_of(row.key);
      if (lower(row.key + " " + full_label_of(row.key)).find(sought) != std::string::npos)
        seeking_->found.push_back(row.key);
      else if (lower(words.help + " " + words.thesis_name).find(sought) != std::string::npos)
        by_help.push_back(row.key);
    }
  seeking_->found.insert(seeking_->found.end(), by_help.begin(), by_help.end());
  if (!seeking_->found.empty()) go_to(seeking_->found.front());
}

void ParametersScreen::on_seek_key(const Key& key) {
  const int count = static_cast<int>(seeking_->found.size());
  if (key.name == Key::Name::enter) {
    seeking_.reset();
  } else if (key.name == Key::Name::escape) {
    page_ = seeking_->page;
    place().selected = seeking_->row;
    seeking_.reset();
  } else if ((key.name == Key::Name::down || key.name == Key::Name::up) && count > 0) {
    seeking_->at = (seeking_->at + (key.name == Key::Name::down ? 1 : count - 1)) % count;
    go_to(seeking_->found[static_cast<std::size_t>(seeking_->at)]);
  } else if (seeking_->text.on_key(key)) {
    seek();
  }
}

}  // namespace ecs::app
