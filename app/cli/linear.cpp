#include "app/cli/linear.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/outcome.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

using cli::ShownArgument;
using cli::ShownProgram;
using cli::ShownVerb;

class LineDialogue {
 public:
  LineDialogue(const ShownProgram& program, const RunWords& run, std::istream& in, std::ostream& out)
      : program_(program), run_(run), in_(in), out_(out) {}

  int run() {
    say("Each menu is a numbered list. Type a number to choose, an empty line to go back, q to quit.");
    choose("");
    return code_;
  }

 private:
  void say(const std::string& line) { out_ << line << "\n" << std::flush; }

  /// Nothing at the end of the input.
  std::optional<std::string> answer(const std::string& question) {
    out_ << question << ": " << std::flush;
    std::string line;
    if (!std::getline(in_, line)) {
      left_ = true;
      return std::nullopt;
    }
    return std::string(trimmed(line));
  }

  void choose(const std::string& path) {
    while (!left_) {
      const std::vector<std::string> words = program_.next_words(path);
      say("");
      say(path.empty() ? program_.help : program_.help_of(path));
      for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string below = path.empty() ? words[i] : path + " " + words[i];
        say(fmt::format("{} {}: {}", i + 1, words[i], program_.help_of(below)));
      }
      const auto given = answer("number");
      if (!given || *given == "q") left_ = true;
      if (left_ || given->empty()) return;
      const auto number = number_in(*given);
      const auto chosen = number
                              ? static_cast<std::size_t>(*number) - 1
                              : static_cast<std::size_t>(std::find(words.begin(), words.end(), *given) - words.begin());
      if ((number && *number < 1.0) || chosen >= words.size()) {
        say(fmt::format("expected a number from 1 to {}, got \"{}\"", words.size(), *given));
        continue;
      }
      const std::string below = path.empty() ? words[chosen] : path + " " + words[chosen];
      const auto verb = std::find_if(program_.verbs.begin(), program_.verbs.end(),
                                     [&](const ShownVerb& one) { return one.path == below; });
      if (verb == program_.verbs.end())
        choose(below);
      else
        ask_and_run(*verb);
    }
  }

  static std::string question_for(const ShownArgument& argument) {
    std::string question = fmt::format("{}, {}", argument.names.back(), argument.help);
    if (!argument.choices.empty()) question += fmt::format(" ({})", fmt::join(argument.choices, ", "));
    if (argument.many) question += " (several: separate them by spaces)";
    if (argument.flag) question += " (y for yes)";
    if (!argument.required)
      question += argument.preset.empty() ? " (Enter: omit)" : " (Enter: " + argument.preset + ")";
    return question;
  }

  /// Puts what was typed for an argument behind `words`. @return false at the end of the input or where it is refused
  bool take(const ShownArgument& argument, std::vector<std::string>& words) {
    const auto given = answer(question_for(argument));
    if (!given) return false;
    if (given->empty()) {
      if (argument.required) say(fmt::format("{} needs a value: back to the menu", argument.names.back()));
      return !argument.required;
    }
    if (argument.flag) {
      if (lower(*given) == "y" || lower(*given) == "yes") words.push_back(argument.names.back());
      return true;
    }
    if (!argument.by_place) words.push_back(argument.names.back());
    if (!argument.many) {
      words.push_back(*given);
      return true;
    }
    for (const std::string_view word : split(*given, ' '))
      if (!word.empty()) words.emplace_back(word);
    return true;
  }

  void ask_and_run(const ShownVerb& verb) {
    std::vector<std::string> words = cli::words_of(verb.path);
    const auto asked_always = [](const ShownArgument& argument) { return argument.required || argument.by_place; };
    for (const ShownArgument& argument : verb.arguments)
      if (asked_always(argument) && !take(argument, words)) return;
    const auto more = answer("set options too? (y: ask for each of them, Enter: run)");
    if (!more) return;
    if (lower(*more) == "y" || lower(*more) == "yes")
      for (const ShownArgument& argument : verb.arguments)
        if (!asked_always(argument) && argument.names.back() != "--help" && !take(argument, words)) return;
    say(fmt::format("{} {}", program_.name, fmt::join(words, " ")));
    code_ = run_(words);
    say(code_ == 0 ? "done"
                   : fmt::format("{} (exit code {})", code_ == kDoesNotHold ? "negative result" : "not done", code_));
  }

  const ShownProgram& program_;
  const RunWords& run_;
  std::istream& in_;
  std::ostream& out_;
  bool left_ = false;
  int code_ = 0;
};

}  // namespace

int run_linear(const ShownProgram& program, const RunWords& run, std::istream& in, std::ostream& out) {
  return LineDialogue(program, run, in, out).run();
}

}  // namespace ecs::app
