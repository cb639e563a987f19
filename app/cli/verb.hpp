// The verbs of `ecs`: actions as base/cli defines them, and what the program gives to each that it runs.
// Does not live here: the list of verbs (app/verbs/registry.cpp), parsing (program.hpp).
#pragma once

#include <string>

#include "app/cli/console.hpp"
#include "base/cli/action.hpp"

namespace ecs::app {

using cli::action;
using cli::Fields;
using cli::fields_of;
using cli::Is;
using cli::Link;
using cli::Logged;
using cli::Need;
using cli::Range;
using cli::Words;

/// The runner: the console that a verb speaks through, the options that all verbs share, the link it opened.
struct VerbContext {
  Console& console;
  std::string link_option{};  ///< --link as given; empty: not given
  std::string arm_code{};     ///< --arm-code as given; empty: not given
  std::string link_name{};    ///< of the link that was opened; goes into the JSON answer as "link"
  Link link = Link::none;     ///< what the action that runs does with it
};

using MenuDefinition = cli::Menu;
using Action = cli::Action<VerbContext>;
using Registry = cli::Registry<VerbContext>;

/// What `ecs --help` says first.
inline constexpr const char* kProgramHelp =
    "ECS: parameters, error maps and tests of an error compensation system for machine tools";

}  // namespace ecs::app
