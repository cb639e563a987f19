#include "app/screens/start.hpp"

#include <chrono>
#include <cstdio>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "app/screens/forms/rows.hpp"
#include "app/screens/laser/screen.hpp"
#include "app/screens/memory/screen.hpp"
#include "app/screens/model/form.hpp"
#include "app/screens/parameters/screen.hpp"
#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/screens.hpp"
#include "app/ui/menu_screen.hpp"
#include "app/ui/screen_program.hpp"
#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "base/outcome.hpp"
#include "base/text.hpp"
#include "commissioning/files/known_files.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/records.hpp"
#include "commissioning/session/remembered.hpp"
#include "core/fault.hpp"
#include "core/mode_word.hpp"

namespace ecs::app {
namespace {

using Files = std::map<FileKind, std::vector<std::string>>;

std::string first_of(const Files& files, FileKind kind) {
  const auto found = files.find(kind);
  return found == files.end() ? std::string() : found->second.front();
}

}  // namespace

std::unique_ptr<Screen> screen_for_files(const std::vector<std::string>& paths,
                                         const std::shared_ptr<UnitConnection>& connection) {
  Files files;
  for (const std::string& path : paths) {
    const std::string whole = disc::absolute(path).lexically_normal().string();
    files[looked_at(whole).kind].push_back(whole);
    remember_file(whole);
  }
  const auto has = [&files](FileKind kind) { return files.contains(kind); };
  if (has(FileKind::model)) {
    const auto data = files.find(FileKind::measurements);
    return model_form(connection, {first_of(files, FileKind::model), first_of(files, FileKind::machine),
                                   data == files.end() ? std::vector<std::string>{} : data->second});
  }
  for (const FormEntry& form : form_entries()) {
    if (form.row.opens.empty() || !has(form.row.opens.front().first)) continue;
    FormValues values;
    for (const auto& [kind, field] : form.row.opens) values[field] = first_of(files, kind);
    return form_titled(form.row.title, connection, values, true);
  }
  if (has(FileKind::measurements) || has(FileKind::map)) {
    auto screen = std::make_unique<LaserScreen>(connection);
    const FileKind kind = has(FileKind::measurements) ? FileKind::measurements : FileKind::map;
    screen->open(files.at(kind), kind, has(FileKind::parameters) ? first_of(files, FileKind::parameters) : "");
    return screen;
  }
  for (const FileKind kind : {FileKind::parameters, FileKind::machine})
    if (has(kind)) {
      auto screen = std::make_unique<ParametersScreen>(connection);
      screen->open(first_of(files, kind), kind);
      return screen;
    }
  if (has(FileKind::memory)) {
    auto screen = std::make_unique<MemoryScreen>(connection);
    screen->open(first_of(files, FileKind::memory));
    return screen;
  }
  if (has(FileKind::datum_record)) return datum_view_screen(std::nullopt, first_of(files, FileKind::datum_record));
  if (has(FileKind::status)) return status_screen(connection, first_of(files, FileKind::status));
  log_event(Tone::bad,
            fmt::format("{}: no screen uses this file; `ecs laser import --help` lists the formats that can be read",
                        paths.front()));
  return nullptr;
}

namespace {

constexpr std::chrono::seconds kRecordsRest{2};  ///< without a new one: then they are one file again

struct Asked {
  bool ascii = false;
  std::string link;
  std::vector<std::string> files;  ///< to be opened
};

/// A word that names no verb and no option, but a file.
bool is_file_to_open(const std::string& word) {
  return !word.starts_with("-") && all_verbs().menu_help(word).empty() && disc::is_file(word);
}

std::optional<Asked> asked_for(const std::vector<std::string>& words) {
  Asked asked;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == "--ascii") {
      asked.ascii = true;
    } else if (words[k] == "--link" && k + 1 < words.size()) {
      asked.link = words[++k];
    } else if (is_file_to_open(words[k])) {
      asked.files.push_back(words[k]);
    } else {
      return std::nullopt;
    }
  }
  return asked;
}

/// The unit in a few words, for the status line of every screen.
StatusLine status_line_of(const WatchedUnit& unit, const std::optional<protocol::MonitorSample>& newest) {
  StatusLine status;
  status.link = unit.emulator ? "EMULATOR" : unit.link;
  if (unit.lent) {
    status.state = "busy";
  } else if (!unit.problem.empty()) {
    status.state = "no answer";
    status.bad = true;
  } else if (newest) {
    status.state = word_of(newest->mode);
    if (newest->fault != Fault::none) {
      status.state += fmt::format(", FAULT {}", ecs::text_of(newest->fault).name);
      status.bad = true;
    }
  } else {
    status.state = unit.open ? "..." : "opening";
  }
  if (status.link.empty()) status.link = "line";
  return status;
}

/// What was given on the command line, in its screen.
ScreenInFront opening(const std::vector<std::string>& files, const std::shared_ptr<UnitConnection>& connection) {
  return [files, connection, opened = false]() mutable -> std::unique_ptr<Screen> {
    if (files.empty() || std::exchange(opened, true)) return arm_screen_if_wanted(connection);
    return screen_for_files(files, connection);
  };
}

}  // namespace

std::optional<int> screens_started(const std::vector<std::string>& words) {
  const auto asked = asked_for(words);
  if (!asked || ::isatty(STDIN_FILENO) == 0 || ::isatty(STDOUT_FILENO) == 0) return std::nullopt;
  TerminalOptions options;
  options.ascii = asked->ascii;
  auto terminal = Terminal::open(options);
  if (terminal) {
    auto connection = std::make_shared<UnitConnection>(asked->link);
    const int code = run_screens(**terminal, main_menu(connection),
                                 {[connection] {
                                    let_records_rest(kRecordsRest);
                                    return status_line_of(connection->snapshot(), connection->newest());
                                  },
                                  opening(asked->files, connection), [connection] { return finder(connection); },
                                  [] { return commands_screen(); }});
    let_records_rest();
    terminal->reset();  // the screens are gone: what matters still is said to the shell
    for (const std::string& word : words_left()) fmt::print(stderr, "{}\n", shown(word));
    return code == 0 && !words_left().empty() ? exit_code_of(ProblemKind::link) : code;
  }
  fmt::print(stderr, "{}\n", shown(to_text(terminal.error())));
  return exit_code_of(ProblemKind::usage);
}

}  // namespace ecs::app
