#include "modules/controllers/format_arguments.hpp"

#include "base/text.hpp"

namespace ecs::app {

Fields<FormatValues> field_of(const controllers::FormatOption& option, const std::string& help) {
  cli::Argument argument{"--" + std::string(option.name), {}, help};
  if (option.range)
    say(argument, Range{static_cast<double>(option.range->least), static_cast<double>(option.range->most)});
  if (!option.words.empty()) say(argument, Words(option.words.begin(), option.words.end()));
  return {std::move(argument), [option](FormatValues& formats) -> cli::Argument::Target {
            auto& value = formats.typed[std::string(option.name)];
            if (option.is_flag) return &value.emplace<bool>(false);
            if (option.range) return &value.emplace<int>(static_cast<int>(integer_in(option.fallback).value_or(0)));
            return &value.emplace<std::string>(option.fallback);
          }};
}

controllers::OptionValues FormatValues::values() const {
  controllers::OptionValues values;
  for (const auto& [name, value] : typed) {
    if (const auto* text = std::get_if<std::string>(&value)) values.set(name, *text);
    if (const auto* number = std::get_if<int>(&value)) values.set(name, std::to_string(*number));
    if (const auto* given = std::get_if<bool>(&value)) values.set(name, *given ? "1" : "");
  }
  return values;
}

}  // namespace ecs::app
