#include "base/cli/verb.hpp"

#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::cli {

std::string VerbArgument::preset() const {
  if (need == Need::required) return {};
  if (const auto* number = std::get_if<double*>(&into)) return shortest(**number);
  if (const auto* integer = std::get_if<int*>(&into)) return fmt::format("{}", **integer);
  if (const auto* word = std::get_if<std::string*>(&into); word != nullptr && !choices.empty()) return **word;
  return {};
}

Verb& Verb::text(const std::string& name, std::string& into, const std::string& help, Need need) {
  arguments_.push_back({name, &into, help, need});
  return *this;
}

Verb& Verb::texts(const std::string& name, std::vector<std::string>& into, const std::string& help, Need need) {
  arguments_.push_back({name, &into, help, need});
  return *this;
}

Verb& Verb::number(const std::string& name, double& into, const std::string& help, Need need, double least,
                   double most) {
  arguments_.push_back({name, &into, help, need, least, most});
  return *this;
}

Verb& Verb::number(const std::string& name, std::optional<double>& into, const std::string& help) {
  constexpr double most = std::numeric_limits<double>::max();
  arguments_.push_back({name, &into, help, Need::optional, -most, most});
  return *this;
}

Verb& Verb::integer(const std::string& name, int& into, const std::string& help, int least, int most, Need need) {
  arguments_.push_back({name, &into, help, need, static_cast<double>(least), static_cast<double>(most)});
  return *this;
}

Verb& Verb::choice(const std::string& name, std::string& into, std::vector<std::string> words, const std::string& help,
                   Need need) {
  VerbArgument argument{name, &into, help, need};
  argument.choices = std::move(words);
  return add(std::move(argument));
}

Verb& Verb::seed(std::optional<std::uint64_t>& into, const std::string& help) {
  arguments_.push_back({"--seed", &into, help});
  return *this;
}

Verb& Verb::flag(const std::string& name, bool& into, const std::string& help) {
  arguments_.push_back({name, &into, help});
  return *this;
}

Verb& Verb::add(VerbArgument argument) {
  arguments_.push_back(std::move(argument));
  return *this;
}

Verb& Verb::uses_link() {
  return add({"--link", link_, "rtu:/dev/ttyUSB0:115200, tcp:host:port, emulator[:machine.toml]"});
}

Verb& Verb::writes_to_unit() {
  writes_ = true;
  return uses_link().takes_arm_code();
}

Verb& Verb::takes_arm_code() {
  return add({"--arm-code", arm_code_, "the code that the unit shows; without it $ECS_ARM_CODE"});
}

Verb& Verb::add_all(const Verb& other) {
  for (VerbArgument argument : other.arguments_) {
    if (argument.name == "--link") argument.into = link_;
    if (argument.name == "--arm-code") argument.into = arm_code_;
    add(std::move(argument));
  }
  writes_ = writes_ || other.writes_;
  return *this;
}

std::vector<std::string> words_of(const std::string& path) {
  std::vector<std::string> words;
  for (const std::string_view word : split(path, ' ')) words.emplace_back(word);
  return words;
}

}  // namespace ecs::cli
