// Every verb of `ecs` with its options, as data: the screens make their menus and forms from it, so that what a script
// can do can be done here, under the same names. Does not live here: running a verb (program.hpp).
#pragma once

#include <string>
#include <vector>

#include "app/cli/verb.hpp"

namespace ecs::app {

struct VerbOption {
  std::string name;                  ///< "--machine", or "FILE" for one taken by its place
  std::string help;                  ///<
  std::string value;                 ///< preset; of flags "" or "yes"
  std::vector<std::string> choices;  ///< the words that are allowed; empty: any text
  bool by_place = false;
  bool required = false;
  bool flag = false;
  bool many = false;    ///< takes several words
  bool output = false;  ///< names a file that the verb writes
};

struct VerbEntry {
  std::vector<std::string> words;  ///< {"utility", "datum", "record"}
  std::string help;
  std::string example;
  std::vector<VerbOption> options;
  bool live = false;                       ///< asks while it runs
  [[nodiscard]] std::string name() const;  ///< "utility datum record"
};

/// A menu as thesis figure 5.4 draws them: title and verbs.
struct MenuEntry {
  std::string title;  ///< "PROCESS LASER DATA: measurements"
  std::vector<VerbEntry> verbs;
};

/// In the order of the menus; verbs outside any menu come last, under "OTHER".
[[nodiscard]] std::vector<MenuEntry> verb_catalogue(const Registry& registry);

/// The words to give to run_program(): what was filled in; empty options are left out.
[[nodiscard]] std::vector<std::string> command_line(const VerbEntry& verb, const std::vector<std::string>& values);

/// Words of a text as a shell takes them: blanks part them, quotes keep them together.
[[nodiscard]] std::vector<std::string> split_words(const std::string& text);

}  // namespace ecs::app
