// A program as its help knows it, and what is written from that: completion of verbs, options and words of a choice in
// a shell; manual pages in the macros of man(7). Does not live here: the help itself (command_tree.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/cli/action.hpp"
#include "base/result.hpp"
#include "base/version.hpp"

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
[[nodiscard]] std::vector<ShownArgument> shown(const Arguments& arguments);

/// @param name, help  of the program
template <class Context>
[[nodiscard]] ShownProgram shown_program(std::string name, std::string help, const Registry<Context>& registry,
                                         const Shared& shared = {}) {
  ShownProgram program{std::move(name), program_version(), std::move(help), registry.menus, {}};
  for (const Action<Context>* action : registry.actions)
    program.verbs.push_back({action->path, action->help, action->example, cli::shown(action->bound(shared).arguments)});
  return program;
}

/// A script for the shell; where an argument is no verb, option or choice, the shell offers files.
[[nodiscard]] std::string bash_completion(const ShownProgram& program);
[[nodiscard]] std::string zsh_completion(const ShownProgram& program);
[[nodiscard]] std::string fish_completion(const ShownProgram& program);

/// The page of a verb, with its synopsis, options, example and exit codes.
[[nodiscard]] std::string manual_page(const ShownProgram& program, const ShownVerb& verb);

/// The page of the program: every verb below its menu.
[[nodiscard]] std::string manual_overview(const ShownProgram& program);

struct ManualPage {
  std::string file;  ///< "ecs-map-build.1"; of the program itself "ecs.1"
  std::string text;
};
/// The overview, then a page for each verb.
[[nodiscard]] std::vector<ManualPage> manual_pages(const ShownProgram& program);
/// Makes the folder. A `usage` problem if a page is there and `force` is not given.
[[nodiscard]] Result<void> write_pages(const std::vector<ManualPage>& pages, const std::filesystem::path& folder,
                                       bool force);

}  // namespace ecs::cli
