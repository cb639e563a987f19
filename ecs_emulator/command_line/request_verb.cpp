#include "ecs_emulator/command_line/request_verb.hpp"

#include <cctype>
#include <cstdio>
#include <filesystem>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/outcome.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;

Json coordinates_in(const std::vector<std::string>& texts) {
  Json place = Json::object();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    std::string name = text.substr(0, equals);
    for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    const Json value = equals == std::string::npos ? Json() : Json::parse(text.substr(equals + 1), nullptr, false);
    place[name] = value.is_discarded() ? Json(text.substr(equals + 1)) : value;
  }
  return place;
}

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).string(); }

}  // namespace

CLI::Option* RequestVerb::number(const std::string& option, const std::string& key, const std::string& help) {
  return verb_.add_option_function<double>(
      option, [&request = request_, key](double v) { request[key] = v; }, help);
}

CLI::Option* RequestVerb::whole(const std::string& option, const std::string& key, const std::string& help) {
  return verb_.add_option_function<long long>(
      option, [&request = request_, key](long long v) { request[key] = v; }, help);
}

CLI::Option* RequestVerb::word(const std::string& option, const std::string& key, const std::string& help) {
  return verb_.add_option_function<std::string>(
      option, [&request = request_, key](const std::string& v) { request[key] = v; }, help);
}

CLI::Option* RequestVerb::flag(const std::string& option, const std::string& key, const std::string& help) {
  return verb_.add_flag_function(
      option, [&request = request_, key](auto) { request[key] = true; }, help);
}

CLI::Option* RequestVerb::numbers(const std::string& option, const std::string& key, const std::string& help) {
  return verb_
      .add_option_function<std::vector<double>>(
          option, [&request = request_, key](const auto& v) { request[key] = v; }, help)
      ->delimiter(',');
}

CLI::Option* RequestVerb::words(const std::string& option, const std::string& key, const std::string& help) {
  return verb_
      .add_option_function<std::vector<std::string>>(
          option, [&request = request_, key](const auto& v) { request[key] = v; }, help)
      ->delimiter(',');
}

CLI::Option* RequestVerb::coordinates(const std::string& option, const std::string& key, const std::string& help) {
  return verb_
      .add_option_function<std::vector<std::string>>(
          option, [&request = request_, key](const auto& v) { request[key] = coordinates_in(v); }, help)
      ->delimiter(',');
}

CLI::Option* RequestVerb::path(const std::string& option, const std::string& key, const std::string& help) {
  return verb_.add_option_function<std::string>(
      option, [&request = request_, key](const std::string& v) { request[key] = absolute(v); }, help);
}

CLI::Option* RequestVerb::paths(const std::string& option, const std::string& key, const std::string& help) {
  return verb_.add_option_function<std::vector<std::string>>(
      option,
      [&request = request_, key](const auto& v) {
        request[key] = Json::array();
        for (const auto& path : v) request[key].push_back(absolute(path));
      },
      help);
}

CLI::App* add_request_verb(CLI::App& app, Json& request, const std::string& name, const std::string& help) {
  CLI::App* verb = app.add_subcommand(name, help);
  verb->callback([&request, name] { request["action"] = name; });
  return verb;
}

int exit_code_after(const Problem& problem) {
  fmt::print(stderr, "{}\n", to_text(problem));
  return exit_code_of(problem.kind);
}

}  // namespace ecs::emulator
