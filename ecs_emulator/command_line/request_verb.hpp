// A verb of `ecs-emulator` whose options are written into a request (docs/emulator.md), and the exit code of a verb.
// Does not live here: what a request does (ecs_emulator/workshop/workshop.hpp).
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "base/result.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ecs::emulator {

/// Every option that is given appears under its key. App and request must live as long as the parsing.
class RequestVerb {
 public:
  RequestVerb(CLI::App& verb, nlohmann::json& request) : verb_(verb), request_(request) {}

  CLI::Option* number(const std::string& option, const std::string& key, const std::string& help = "");
  CLI::Option* whole(const std::string& option, const std::string& key, const std::string& help = "");
  CLI::Option* word(const std::string& option, const std::string& key, const std::string& help = "");
  CLI::Option* flag(const std::string& option, const std::string& key, const std::string& help = "");
  /// Parted by commas.
  CLI::Option* numbers(const std::string& option, const std::string& key, const std::string& help = "");
  CLI::Option* words(const std::string& option, const std::string& key, const std::string& help = "");
  /// "y=-700,z=0" → {"Y": -700, "Z": 0}
  CLI::Option* coordinates(const std::string& option, const std::string& key, const std::string& help = "");
  /// Made absolute: the server that gets the request may work in another folder.
  CLI::Option* path(const std::string& option, const std::string& key, const std::string& help = "");
  CLI::Option* paths(const std::string& option, const std::string& key, const std::string& help = "");

 private:
  CLI::App& verb_;
  nlohmann::json& request_;
};

/// Adds a verb that writes its name into the request as "action".
[[nodiscard]] CLI::App* add_request_verb(CLI::App& app, nlohmann::json& request, const std::string& name,
                                         const std::string& help);

/// Prints the problem to stderr. @return exit code of the program
[[nodiscard]] int exit_code_after(const Problem& problem);

}  // namespace ecs::emulator
