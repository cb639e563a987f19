// What the parameters screen does beyond a single value: files asked for, sending, receiving, finding by name.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/parameters/screen.hpp"
#include "base/text.hpp"

namespace ecs::app {

void ParametersScreen::after(const Result<void>& done, const std::string& said) {
  if (done)
    message_.say(said);
  else
    message_.say(done.error());
}

void ParametersScreen::unless_lost(const std::string& title, std::function<void()> what) {
  if (!controller_.unsaved()) return what();
  asking_.ask({title,
               fmt::format("{} change{} here neither saved nor sent and would be lost. n, then s saves them first.",
                           controller_.changes(), controller_.changes() == 1 ? " is" : "s are"),
               "go on, lose them", "stay"},
              std::move(what));
}

void ParametersScreen::prompt_for(std::string title, std::string help, const std::string& path,
                                  std::function<void(const std::string&)> done) {
  prompt_ = PathPrompt{std::move(title), std::move(help), TextLine(path), "", std::move(done)};
}

void ParametersScreen::ask_for_file() {
  const std::string beside = controller_.file().substr(0, controller_.file().rfind('/') + 1);
  prompt_for("open the parameter file", "Path of a .toml file; Tab completes it.", beside,
             [this](const std::string& path) {
               auto opened = controller_.open_file(path);
               if (!opened) {
                 prompt_->hint = to_text(opened.error());
                 return;
               }
               prompt_.reset();
               turn_page(0);
               message_.say(path + " is open");
             });
}

void ParametersScreen::ask_for_machine() {
  prompt_for(
      "new parameters for the machine file", "Path of a machine file (.toml); Tab completes it.", "",
      [this](const std::string& path) {
        auto begun = controller_.start_from_machine(path);
        if (!begun) {
          prompt_->hint = to_text(begun.error());
          return;
        }
        prompt_.reset();
        turn_page(0);
        message_.say("new parameters: look through pages 1 to 3, above all datum type, output scale and polarity " +
                     std::string(controller_.findings().empty() ? "of the control"
                                                                : "of the control; page 4 says what is missing"));
      });
}

void ParametersScreen::ask_for_check() {
  prompt_for(
      "check against the machine file",
      "Path of a machine file (.toml): axes, travels, transducers and datum are compared with it. Empty: without.", "",
      [this](const std::string& path) {
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
             controller_.file(), [this](const std::string& path) {
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
  const std::size_t errors = controller_.errors();
  if (errors == 0)
    message_.say("saved to " + path);
  else
    message_.say(fmt::format("saved to {}, though {} against it: page 4", path,
                             errors == 1 ? "there is an error" : fmt::format("there are {} errors", errors)),
                 Tone::warning);
}

void ParametersScreen::on_prompt_key(const Key& key) {
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
