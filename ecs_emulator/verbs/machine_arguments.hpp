// The machine that a verb of `ecs-emulator` makes.
#pragma once

#include <optional>
#include <string>

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

struct MachineArguments {
  std::string machine;
  std::string errors;
  std::optional<std::uint64_t> seed;

  void declare(Verb& verb) {
    verb.text("--machine", machine, "machine file (TOML)", Need::required)
        .text("--errors", errors, "errors file (TOML); default: the one that the machine file names")
        .seed(seed, "seed of everything random");
  }
};

}  // namespace ecs::emulator
