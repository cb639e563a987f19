// The workshop's verbs as options of the command line, written into one request (docs/emulator.md).
// Does not live here: what a request does (workshop.hpp).
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ecs::emulator {

/// Every verb writes its name and its options into `request`, which must live as long as the parsing.
class WorkshopVerbs {
 public:
  explicit WorkshopVerbs(nlohmann::json& request) : request_(request) {}

  void add_all(CLI::App& app);
  CLI::App* add(CLI::App& app, const std::string& name, const std::string& help);
  void measure(CLI::App* verb);
  void capture(CLI::App* verb);
  void survey(CLI::App* verb);

 private:
  CLI::Option* number(CLI::App* verb, const std::string& option, const std::string& key);
  CLI::Option* whole(CLI::App* verb, const std::string& option, const std::string& key);
  CLI::Option* word(CLI::App* verb, const std::string& option, const std::string& key);
  void list(CLI::App* verb, const std::string& option, const std::string& key);
  void flag(CLI::App* verb, const std::string& option, const std::string& key);
  void jog(CLI::App* verb);
  void outputs(CLI::App* verb, const std::string& help);
  void setting(CLI::App* verb);
  void fault(CLI::App* verb);

  nlohmann::json& request_;
};

}  // namespace ecs::emulator
