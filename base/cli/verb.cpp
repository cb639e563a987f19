#include "base/cli/verb.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/overwriting.hpp"
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
  return add({name, &into, help, need});
}

Verb& Verb::output_file(const std::string& name, std::string& into, const std::string& help, Need need) {
  VerbArgument argument{name, &into, help, need};
  argument.is_output = true;
  return add(std::move(argument));
}

Verb& Verb::texts(const std::string& name, std::vector<std::string>& into, const std::string& help, Need need) {
  return add({name, &into, help, need});
}

Verb& Verb::number(const std::string& name, double& into, const std::string& help, Need need, double least,
                   double most) {
  return add({name, &into, help, need, least, most});
}

Verb& Verb::number(const std::string& name, std::optional<double>& into, const std::string& help) {
  constexpr double most = std::numeric_limits<double>::max();
  return add({name, &into, help, Need::optional, -most, most});
}

Verb& Verb::integer(const std::string& name, int& into, const std::string& help, int least, int most, Need need) {
  return add({name, &into, help, need, static_cast<double>(least), static_cast<double>(most)});
}

Verb& Verb::choice(const std::string& name, std::string& into, std::vector<std::string> words, const std::string& help,
                   Need need) {
  VerbArgument argument{name, &into, help, need};
  argument.choices = std::move(words);
  return add(std::move(argument));
}

Verb& Verb::seed(std::optional<std::uint64_t>& into, const std::string& help) { return add({"--seed", &into, help}); }

Verb& Verb::flag(const std::string& name, bool& into, const std::string& help) { return add({name, &into, help}); }

Verb& Verb::add(VerbArgument argument) {
  if (argument.group.empty()) argument.group = group_;
  arguments_.push_back(std::move(argument));
  return *this;
}

Verb& Verb::group(std::string heading) {
  group_ = std::move(heading);
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

OutputGuard::OutputGuard(Verb& verb) {
  const auto& declared = verb.arguments();
  if (std::none_of(declared.begin(), declared.end(), [](const VerbArgument& one) { return one.is_output; })) return;
  for (const VerbArgument& argument : declared)
    if (argument.name == "--force" && std::holds_alternative<bool*>(argument.into))
      force_ = std::get<bool*>(argument.into);
  if (force_ == nullptr) {
    own_force_ = std::make_shared<bool>(false);
    force_ = own_force_.get();
    verb.flag("--force", *own_force_, "overwrites an output file that is there");
  }
  arguments_ = declared;
}

Result<void> OutputGuard::check() const {
  if (force_ == nullptr || *force_) return {};
  // Changed in place: the file that the verb takes first; by --params-out that of --params.
  const auto text_of = [&](auto&& is_it) {
    const auto found = std::find_if(arguments_.begin(), arguments_.end(), [&](const VerbArgument& one) {
      return !one.is_output && std::holds_alternative<std::string*>(one.into) && is_it(one);
    });
    return found == arguments_.end() ? std::string() : *std::get<std::string*>(found->into);
  };
  const std::string first = text_of([](const VerbArgument& one) { return one.by_place(); });
  for (const VerbArgument& argument : arguments_)
    if (argument.is_output)
      if (auto kept = spared({*std::get<std::string*>(argument.into)}, false,
                             {first, text_of([&](const auto& one) { return one.name + "-out" == argument.name; })});
          !kept)
        return kept;
  return {};
}

std::vector<std::string> words_of(const std::string& path) {
  std::vector<std::string> words;
  for (const std::string_view word : split(path, ' '))
    if (!word.empty()) words.emplace_back(word);
  return words;
}

}  // namespace ecs::cli
