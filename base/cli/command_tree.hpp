// Words of a command line against menus and verbs: help, errors and the verb to run. The command-line library stops
// in command_tree.cpp. Does not live here: running what was asked for.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/cli/action.hpp"

namespace CLI {
class App;
}

namespace ecs::cli {

/// What the words ask for.
struct Request {
  enum class Kind { run, help, version, no_words, wrong };
  Kind kind = Kind::wrong;
  std::string text;  ///< the help, or what is wrong and what to do; of no_words: the verbs there are
};

/// Menus, verbs and their options. The variables of the arguments must live as long.
class CommandTree {
 public:
  /// @param menus  those of the verbs to come
  CommandTree(const std::string& program, const Menu& root, std::vector<Menu> menus);
  ~CommandTree();
  CommandTree(const CommandTree&) = delete;
  CommandTree& operator=(const CommandTree&) = delete;

  /// @param path    "utility datum record"; the menus before the verb's own word come into being with their first verb
  /// @param chosen  called by parsed() where the words name this verb
  void add_verb(const std::string& path, const std::string& help, const std::string& example,
                const Arguments& arguments, std::function<void()> chosen);

  /// @param words  without the name of the program
  [[nodiscard]] Request parsed(const std::vector<std::string>& words);

 private:
  [[nodiscard]] CLI::App& menu_at(CLI::App& parent, const std::string& name, const std::string& path);

  std::unique_ptr<CLI::App> root_;
  std::vector<Menu> menus_;
};

}  // namespace ecs::cli
