#include "base/cli/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::cli {
namespace {

/// A word of any shell: letters and dashes only go without quotes.
std::string in_single_quotes(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// fish knows \\ and \' inside single quotes.
std::string in_fish_quotes(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string function_name(const ShownProgram& program) {
  std::string name = "_" + program.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}

std::vector<std::string> option_names(const ShownVerb& verb) {
  std::vector<std::string> names;
  for (const ShownArgument& argument : verb.arguments)
    if (!argument.by_place) names.insert(names.end(), argument.names.begin(), argument.names.end());
  return names;
}

/// Rows of the three tables that bash and zsh look up: words that may follow a path, options of a verb, words of a
/// choice by "path option".
std::string shell_tables(const ShownProgram& program, const std::string& f) {
  std::string text = fmt::format("typeset -gA {0}_next {0}_options {0}_choices\n", f);
  const auto row = [&](const char* table, const std::string& key, const std::vector<std::string>& words) {
    if (!words.empty())
      text += fmt::format("{}_{}[{}]={}\n", f, table, key, in_single_quotes(fmt::format("{}", fmt::join(words, " "))));
  };
  // The subscript of a table is a variable: both shells take any text there.
  const auto keyed = [&](const std::string& key, auto put) {
    text += fmt::format("key={}\n", in_single_quotes(key));
    put();
  };
  for (const std::string& path : program.paths())
    keyed("/" + path, [&] { row("next", "$key", program.next_words(path)); });
  for (const ShownVerb& verb : program.verbs) {
    keyed("/" + verb.path, [&] { row("options", "$key", option_names(verb)); });
    for (const ShownArgument& argument : verb.arguments)
      for (const std::string& name : argument.names)
        if (!argument.choices.empty() && !argument.by_place)
          keyed("/" + verb.path + " " + name, [&] { row("choices", "$key", argument.choices); });
  }
  return text + "unset key\n";
}

}  // namespace

std::string bash_completion(const ShownProgram& program) {
  const std::string f = function_name(program);
  std::string tables = shell_tables(program, f);
  const std::string zsh_only = "typeset -gA";
  tables.replace(tables.find(zsh_only), zsh_only.size(), "declare -gA");
  return fmt::format(
      R"(# bash completion of {0}, written by `{0} completion bash`
{2}{1}() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} path= word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    [[ " ${{{1}_next["/$path"]}} " == *" $word "* ]] && path=${{path:+$path }}$word
  done
  local choices=${{{1}_choices["/$path $prev"]}}
  if [[ -n $choices ]]; then
    COMPREPLY=($(compgen -W "$choices" -- "$cur"))
  elif [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "${{{1}_options["/$path"]:---help}}" -- "$cur"))
  else
    COMPREPLY=($(compgen -W "${{{1}_next["/$path"]}}" -- "$cur"))
  fi
}}
complete -o default -o bashdefault -F {1} {0}
)",
      program.name, f, tables);
}

std::string zsh_completion(const ShownProgram& program) {
  const std::string f = function_name(program);
  return fmt::format(
      R"(#compdef {0}
# zsh completion of {0}, written by `{0} completion zsh`
{2}{1}() {{
  local verb= word key
  for word in ${{words[2,CURRENT-1]}}; do
    key="/$verb"
    if [[ " ${{{1}_next[$key]}} " == *" $word "* ]]; then verb="${{verb:+$verb }}$word"; fi
  done
  key="/$verb ${{words[CURRENT-1]}}"
  if [[ -n ${{{1}_choices[$key]}} ]]; then
    compadd -- ${{=${{{1}_choices[$key]}}}}
    return
  fi
  key="/$verb"
  if [[ ${{words[CURRENT]}} == -* ]]; then
    compadd -- ${{=${{{1}_options[$key]:---help}}}}
  elif [[ -n ${{{1}_next[$key]}} ]]; then
    compadd -- ${{=${{{1}_next[$key]}}}}
  else
    _files
  fi
}}
if [[ ${{funcstack[1]}} == {1} ]]; then {1} "$@"; else compdef {1} {0}; fi
)",
      program.name, f, shell_tables(program, f));
}

std::string fish_completion(const ShownProgram& program) {
  const std::string f = "_" + function_name(program) + "_path";
  std::string text = fmt::format(
      R"(# fish completion of {0}, written by `{0} completion fish`
function {1}
    set -l known {2}
    set -l path
    for word in (commandline -opc)[2..]
        contains -- (string join ' ' $path $word) $known; and set -a path $word
    end
    string join ' ' $path
end
)",
      program.name, f, [&] {
        std::string known;
        for (const std::string& path : program.paths())
          if (!path.empty()) known += (known.empty() ? "" : " ") + in_fish_quotes(path);
        return known;
      }());
  for (const std::string& path : program.paths()) {
    const std::string at =
        fmt::format("complete -c {} -n 'test (string join \" \" ({})) = \"{}\"'", program.name, f, path);
    for (const std::string& word : program.next_words(path))
      text += fmt::format("{} -f -a {} -d {}\n", at, word,
                          in_fish_quotes(program.help_of(path.empty() ? word : path + " " + word)));
  }
  for (const ShownVerb& verb : program.verbs)
    for (const ShownArgument& argument : verb.arguments) {
      if (argument.by_place) continue;
      text += fmt::format("complete -c {} -n 'test (string join \" \" ({})) = \"{}\"'", program.name, f, verb.path);
      for (const std::string& name : argument.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!argument.flag)
        text += argument.choices.empty() ? " -r" : fmt::format(" -x -a '{}'", fmt::join(argument.choices, " "));
      text += fmt::format(" -d {}\n", in_fish_quotes(argument.help));
    }
  return text;
}

}  // namespace ecs::cli
