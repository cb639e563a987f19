// What every verb is given: the console it speaks through and the options that all verbs share.
#pragma once

#include <string>

#include "app/cli/console.hpp"

namespace ecs::app {

struct VerbContext {
  Console& console;
  std::string link_option;  ///< --link as given; empty: not given
  std::string arm_code;     ///< --arm-code as given; empty: not given
  std::string link_name;    ///< of the link that was opened; goes into the JSON answer as "link"
};

}  // namespace ecs::app
