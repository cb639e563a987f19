// A program as its help knows it, for what is written from the same source: manual pages and completions.
// Does not live here: the help itself (command_tree.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/cli/verb.hpp"

namespace ecs::cli {

struct ShownArgument {
  std::vector<std::string> names;  ///< {"-o", "--output"}; {"FILE"} of one that is taken by its place
  std::string help;
  std::string preset;                ///< empty: none that means something
  std::vector<std::string> choices;  ///< empty: any text
  bool by_place = false;
  bool required = false;
  bool flag = false;  ///< takes no value
  bool many = false;
};

struct ShownVerb {
  std::string path;  ///< "map build"
  std::string help;
  std::string example;
  std::vector<ShownArgument> arguments;
};

struct ShownProgram {
  std::string name;     ///< "ecs"
  std::string version;  ///< "ecs 0.2.0"
  std::string help;
  std::vector<Menu> menus;
  std::vector<ShownVerb> verbs;

  /// The help of a menu or verb; empty: there is none of that path.
  [[nodiscard]] std::string help_of(const std::string& path) const;
  /// The words that may follow those of a path, in the order of the help.
  [[nodiscard]] std::vector<std::string> next_words(const std::string& path) const;
  /// Every menu, "" for the program itself, then every verb.
  [[nodiscard]] std::vector<std::string> paths() const;
};

/// --help stands first.
[[nodiscard]] std::vector<ShownArgument> shown(const std::vector<VerbArgument>& arguments);

}  // namespace ecs::cli
