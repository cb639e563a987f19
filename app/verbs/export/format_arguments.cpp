#include "app/verbs/export/format_arguments.hpp"

#include "base/text.hpp"

namespace ecs::app {

void FormatArguments::take(Verb& verb, const controllers::FormatOption& option, const std::string& help) {
  const std::string name = "--" + std::string(option.name);
  Typed& typed = typed_.emplace_back(Typed{std::string(option.name), std::string(option.fallback)});
  if (option.is_flag) {
    verb.flag(name, typed.value.emplace<bool>(false), help);
  } else if (option.range) {
    const int fallback = static_cast<int>(integer_in(option.fallback).value_or(0));
    verb.integer(name, typed.value.emplace<int>(fallback), help, option.range->least, option.range->most);
  } else if (!option.words.empty()) {
    verb.choice(name, std::get<std::string>(typed.value), {option.words.begin(), option.words.end()}, help);
  } else {
    verb.text(name, std::get<std::string>(typed.value), help);
  }
}

controllers::OptionValues FormatArguments::values() const {
  controllers::OptionValues values;
  for (const Typed& typed : typed_) {
    if (const auto* text = std::get_if<std::string>(&typed.value)) values.set(typed.name, *text);
    if (const auto* number = std::get_if<int>(&typed.value)) values.set(typed.name, std::to_string(*number));
    if (const auto* given = std::get_if<bool>(&typed.value)) values.set(typed.name, *given ? "1" : "");
  }
  return values;
}

}  // namespace ecs::app
