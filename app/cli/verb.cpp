#include "app/cli/verb.hpp"

#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/cli/verb_unit.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

CLI::Option* as_needed(CLI::Option* option, Need need) { return option->required(need == Need::required); }

/// A default that means something is shown in the help.
CLI::Option* with_default(CLI::Option* option, Need need, const std::string& value) {
  return need == Need::required || value.empty() ? option : option->default_str(value);
}

std::string range_text(double least, double most) {
  if (most == std::numeric_limits<double>::max()) return fmt::format("a number of at least {}", least);
  if (least == std::numeric_limits<double>::lowest()) return fmt::format("a number of at most {}", most);
  return fmt::format("a number from {} to {}", least, most);
}

CLI::Validator finite_number(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        const auto value = number_in(text);
        if (!value) return fmt::format("expected a number, got \"{}\"", text);
        if (*value < least || *value > most) return fmt::format("expected {}, got {}", range_text(least, most), text);
        return std::string();
      },
      std::string(), std::string());
}

CLI::Validator one_of(std::vector<std::string> words) {
  return CLI::Validator(
      [words = std::move(words)](std::string& text) {
        for (const std::string& word : words)
          if (lower(word) == lower(text)) {
            text = word;
            return std::string();
          }
        return fmt::format("expected {}, got \"{}\"", fmt::join(words, " or "), text);
      },
      std::string(), std::string());
}

}  // namespace

Verb& Verb::text(const std::string& name, std::string& into, const std::string& help, Need need) {
  as_needed(app_->add_option(name, into, help), need)->type_name("");
  return *this;
}

Verb& Verb::texts(const std::string& name, std::vector<std::string>& into, const std::string& help, Need need) {
  as_needed(app_->add_option(name, into, help), need)->type_name("");
  return *this;
}

Verb& Verb::number(const std::string& name, double& into, const std::string& help, Need need, double least,
                   double most) {
  with_default(as_needed(app_->add_option(name, into, help), need), need, shortest(into))
      ->check(finite_number(least, most))
      ->type_name("NUMBER");
  return *this;
}

Verb& Verb::number(const std::string& name, std::optional<double>& into, const std::string& help) {
  constexpr double most = std::numeric_limits<double>::max();
  app_->add_option_function<double>(
          name, [&into](const double& value) { into = value; }, help)
      ->check(finite_number(-most, most))
      ->type_name("NUMBER");
  return *this;
}

Verb& Verb::integer(const std::string& name, int& into, const std::string& help, int least, int most, Need need) {
  with_default(as_needed(app_->add_option(name, into, help), need), need, fmt::format("{}", into))
      ->check(CLI::Range(least, most).description(""))
      ->type_name("INTEGER");
  return *this;
}

Verb& Verb::choice(const std::string& name, std::string& into, std::vector<std::string> words, const std::string& help,
                   Need need) {
  with_default(as_needed(app_->add_option(name, into, help), need), need, into)
      ->type_name(fmt::format("{}", fmt::join(words, "|")))
      ->check(one_of(std::move(words)));
  return *this;
}

Verb& Verb::flag(const std::string& name, bool& into, const std::string& help) {
  app_->add_flag(name, into, help);
  return *this;
}

Verb& Verb::writes_to_unit() {
  writes_ = true;
  return uses_link();
}

Verb& Verb::uses_link() {
  app_->add_option("--link", *link_, "rtu:/dev/ttyUSB0:115200, tcp:host:port, emulator[:machine.toml]")->type_name("");
  return *this;
}

void Verb::runs(Action action) {
  if (writes_)
    action = [inner = std::move(action)](VerbContext& context) {
      announce_writing(context);
      return inner(context);
    };
  app_->callback([chosen = chosen_, action = std::move(action)] { *chosen = action; });
}

Menu Menu::menu(const std::string& name, const std::string& help) {
  CLI::App* sub = app_->add_subcommand(name, help);
  sub->require_subcommand(0, 1);
  sub->add_flag("--json", common_->json, "the answer as one JSON object on stdout");
  sub->add_flag("--quiet", common_->quiet, "no notes and no progress bar");
  return {*sub, *common_, *chosen_};
}

Verb Menu::verb(const std::string& name, const std::string& help, const std::string& example) {
  CLI::App* sub = app_->add_subcommand(name, help);
  sub->add_flag("--json", common_->json, "the answer as one JSON object on stdout");
  sub->add_flag("--quiet", common_->quiet, "no notes and no progress bar");
  sub->footer("Example:\n  " + example);
  return {*sub, *chosen_, common_->link};
}

}  // namespace ecs::app
