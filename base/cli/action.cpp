#include "base/cli/action.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::cli {

std::string Argument::preset() const {
  if (need == Need::required) return {};
  if (const auto* number = std::get_if<double*>(&into)) return shortest(**number);
  if (const auto* integer = std::get_if<int*>(&into)) return fmt::format("{}", **integer);
  if (const auto* size = std::get_if<std::size_t*>(&into)) return fmt::format("{}", **size);
  if (const auto* word = std::get_if<std::string*>(&into); word != nullptr && !choices.empty()) return **word;
  return {};
}

Arguments with_shared(Arguments own, const Shared& shared, Link link) {
  Arguments all = shared.always;
  all.insert(all.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
  if (link != Link::none)
    all.push_back(
        {"--link", shared.link, "link to the unit: rtu:/dev/ttyUSB0:115200, tcp:host:port, emulator[:machine.toml]"});
  if (link == Link::may_write || link == Link::writes) {
    all.push_back({"--arm-code", shared.arm_code, "arming code shown by the unit; default: $ECS_ARM_CODE"});
    all.back().is_secret = true;
  }
  return all;
}

OutputGuard::OutputGuard(Arguments& arguments) {
  if (std::none_of(arguments.begin(), arguments.end(), [](const Argument& one) { return one.is_output; })) return;
  for (const Argument& argument : arguments)
    if (argument.name == "--force" && std::holds_alternative<bool*>(argument.into))
      force_ = std::get<bool*>(argument.into);
  if (force_ == nullptr) {
    own_force_ = std::make_shared<bool>(false);
    force_ = own_force_.get();
    arguments.push_back({"--force", own_force_.get(), "overwrite an existing output file"});
  }
  arguments_ = arguments;
}

Result<void> OutputGuard::check() const {
  if (force_ == nullptr || *force_) return {};
  // Changed in place: the file that the action takes first; by --params-out that of --params.
  const auto text_of = [&](auto&& is_it) {
    const auto found = std::find_if(arguments_.begin(), arguments_.end(), [&](const Argument& one) {
      return !one.is_output && std::holds_alternative<std::string*>(one.into) && is_it(one);
    });
    return found == arguments_.end() ? std::string() : *std::get<std::string*>(found->into);
  };
  const std::string first = text_of([](const Argument& one) { return one.by_place(); });
  for (const Argument& argument : arguments_)
    if (argument.is_output)
      ECS_DO(spared({*std::get<std::string*>(argument.into)}, false,
                    {first, text_of([&](const auto& one) { return one.name + "-out" == argument.name; })}));
  return {};
}

std::vector<std::string> words_of(const std::string& path) {
  std::vector<std::string> words;
  for (const std::string_view word : split(path, ' '))
    if (!word.empty()) words.emplace_back(word);
  return words;
}

}  // namespace ecs::cli
