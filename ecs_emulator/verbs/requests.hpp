// Verbs of `ecs-emulator` whose options are written into a request (docs/emulator.md).
// Does not live here: what a request does (ecs_emulator/workshop/workshop.hpp).
#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

/// What an option takes.
enum class OptionKind {
  number,
  integer,
  word,
  flag,
  numbers,      ///< parted by commas
  words,        ///< parted by commas
  coordinates,  ///< "y=-700,z=0" → {"Y": -700, "Z": 0}
  path,         ///< made absolute: the server that gets the request may work in another folder
  paths,
};

struct RequestOption {
  const char* option;
  OptionKind kind = OptionKind::number;
  const char* help = "";
  Need need = Need::optional;
  const char* key = nullptr;  ///< in the request; null: as the option, "--dead-path" → dead_path
};

[[nodiscard]] cli::Argument argument_of(const RequestOption& option);
/// Where its value goes: under its key. The request must live as long as the parsing.
[[nodiscard]] cli::Argument::Target target_of(nlohmann::json& request, const RequestOption& option);

/// Options as fields whose request is a member.
template <class Request>
[[nodiscard]] Fields<Request> request_fields(nlohmann::json Request::*member, std::span<const RequestOption> options) {
  Fields<Request> all;
  for (const RequestOption& option : options)
    all.add({argument_of(option), [member, option](Request& request) { return target_of(request.*member, option); }});
  return all;
}

}  // namespace ecs::emulator
