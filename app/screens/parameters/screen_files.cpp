// What the parameters screen does beyond a single value: files asked for, sending, receiving, finding by name.
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/parameters/screen.hpp"
#include "base/text.hpp"
#include "commissioning/session/recent_files.hpp"

namespace ecs::app {

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
       fmt::format("{} change{} here neither saved nor sent. {} kept as a draft, which is offered again later; "
                   "n, then s saves {} first.",
                   controller_.changes(), controller_.changes() == 1 ? " is" : "s are",
                   controller_.changes() == 1 ? "It is" : "They are", controller_.changes() == 1 ? "it" : "them"),
       "go on, keep the draft", "stay"},
      std::move(what));
}

void ParametersScreen::prompt_for(std::string title, std::string help, const std::string& path,
                                  std::function<void(const std::string&)> done) {
  prompt_.emplace();
  prompt_->title = std::move(title);
  prompt_->help = std::move(help);
  prompt_->path = TextLine(path);
  prompt_->done = std::move(done);
}

void ParametersScreen::choose_file(std::string title, FileWish wish, std::function<void(const std::string&)> done) {
  const std::filesystem::path beside = std::filesystem::path(controller_.file()).parent_path();
  prompt_for(std::move(title), "", "", std::move(done));
  prompt_->chooser.emplace(beside.empty() ? std::filesystem::current_path() : beside, std::move(wish));
}

void ParametersScreen::on_chooser_key(const Key& key) {
  const FileChooser::Answer answer = prompt_->chooser->on_key(key);
  if (answer == FileChooser::Answer::given_up) return prompt_.reset();
  if (answer != FileChooser::Answer::chosen) return;
  const auto done = prompt_->done;  // it ends the prompt, and with it the chooser
  const std::string path = prompt_->chooser->taken().front();
  done(path);
  if (prompt_) prompt_->chooser->refuse(prompt_->hint);
}

Result<void> ParametersScreen::opened(const std::string& path) {
  auto opened = controller_.open_file(path);
  if (!opened) return opened;
  prompt_.reset();
  turn_page(0);
  message_.say(path + " is open");
  return {};
}

Result<void> ParametersScreen::begun_from(const std::string& machine) {
  auto begun = controller_.start_from_machine(machine);
  if (!begun) return begun;
  prompt_.reset();
  turn_page(0);
  message_.say(
      "new parameters: look through pages 1 to 3, above all datum type, output scale and polarity " +
      std::string(controller_.findings().empty() ? "of the control" : "of the control; page 4 says what is missing"));
  return {};
}

void ParametersScreen::open(const std::string& path, FileKind kind) {
  if (draft_) set_draft_aside(kParametersDraft);
  draft_.reset();
  if (const auto done = kind == FileKind::machine ? begun_from(path) : opened(path); !done) message_.say(done.error());
}

void ParametersScreen::ask_for_file() {
  choose_file("open the parameter file", {{FileKind::parameters}}, [this](const std::string& path) {
    if (const auto done = opened(path); !done) prompt_->hint = to_text(done.error());
  });
}

void ParametersScreen::ask_for_machine() {
  choose_file("new parameters for the machine file", {{FileKind::machine}}, [this](const std::string& path) {
    if (const auto done = begun_from(path); !done) prompt_->hint = to_text(done.error());
  });
}

void ParametersScreen::ask_for_check() {
  choose_file("check axes, travels, transducers and datum against the machine file",
              {{FileKind::machine}, false, "without a machine file"}, [this](const std::string& path) {
                if (auto checked = controller_.check_with(path); !checked) {
                  prompt_->hint = to_text(checked.error());
                  return;
                }
                prompt_.reset();
                const std::size_t count = controller_.findings().size();
                message_.say(count == 0 ? "no findings for these parameters"
                                        : fmt::format("{} finding{}: page 4", count, count == 1 ? "" : "s"),
                             count == 0 ? Tone::good : Tone::warning);
              });
}

void ParametersScreen::ask_where_to_save() {
  prompt_for("save as", "Path of the file; Tab completes it. The old file stays whole until the new one is on disc.",
             controller_.file().empty() ? "parameters.toml" : controller_.file(), [this](const std::string& path) {
               const std::string lost = path.empty() ? "" : controller_.overwrites(path);
               if (lost.empty()) return save_to(path);
               asking_.ask({"Save over it?", lost, "save", "do not save"}, [this, path] { save_to(path); });
             });
}

void ParametersScreen::save_to(const std::string& path) {
  if (auto saved = controller_.save(path); !saved) {
    if (prompt_) prompt_->hint = to_text(saved.error());
    return;
  }
  prompt_.reset();
  remember_file(path);
  const std::size_t errors = controller_.errors();
  if (errors == 0)
    message_.say("saved to " + path);
  else
    message_.say(fmt::format("saved to {}, though {} against it: page 4", path,
                             errors == 1 ? "there is an error" : fmt::format("there are {} errors", errors)),
                 Tone::warning);
}

void ParametersScreen::on_prompt_key(const Key& key) {
  if (prompt_->chooser) return on_chooser_key(key);
  if (key.name == Key::Name::escape) {
    prompt_.reset();
  } else if (key.name == Key::Name::enter) {
    const auto done = prompt_->done;  // it ends the prompt
    done(std::string(trimmed(prompt_->path.text())));
  } else if (key.name == Key::Name::tab) {
    const PathCompletion found = completed_path(prompt_->path.text());
    prompt_->path.set(found.completed);
    prompt_->hint = fmt::format("{}", fmt::join(found.choices, "  "));
  } else if (prompt_->path.on_key(key)) {
    prompt_->hint.clear();
  }
}

void ParametersScreen::send() {
  if (controller_.errors() > 0) {
    turn_page(static_cast<int>(Page::findings));
    place().selected = 0;
    message_.say(fmt::format("not sent: {} against these parameters; Enter goes to the field",
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
    message_.say("reading the unit again; page 5 shows what differs");
  else
    message_.say("no unit answers now; it is looked into as soon as one does", Tone::warning);
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
