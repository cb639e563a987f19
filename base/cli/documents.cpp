#include "base/cli/documents.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::cli {

std::string ShownProgram::help_of(const std::string& path) const {
  for (const ShownVerb& verb : verbs)
    if (verb.path == path) return verb.help;
  for (const Menu& menu : menus)
    if (menu.path == path) return menu.help;
  return path.empty() ? help : std::string();
}

std::vector<std::string> ShownProgram::next_words(const std::string& path) const {
  const std::vector<std::string> before = words_of(path);
  std::vector<std::string> next;
  for (const ShownVerb& verb : verbs) {
    const std::vector<std::string> words = words_of(verb.path);
    if (words.size() <= before.size() || !std::equal(before.begin(), before.end(), words.begin())) continue;
    if (std::find(next.begin(), next.end(), words[before.size()]) == next.end()) next.push_back(words[before.size()]);
  }
  return next;
}

std::vector<std::string> ShownProgram::paths() const {
  std::vector<std::string> all{""};
  for (const Menu& menu : menus) all.push_back(menu.path);
  for (const ShownVerb& verb : verbs) all.push_back(verb.path);
  return all;
}

std::vector<ShownArgument> shown(const Arguments& arguments) {
  std::vector<ShownArgument> all{{{"-h", "--help"}, "the help", {}, {}, false, false, true, false}};
  for (const Argument& argument : arguments) {
    ShownArgument one;
    for (const std::string_view name : split(argument.name, ',')) one.names.emplace_back(name);
    one.help = argument.help;
    one.preset = argument.preset();
    one.choices = argument.choices;
    one.by_place = argument.by_place();
    one.required = argument.need == Need::required;
    one.flag = argument.is_flag();
    one.many = argument.takes_many();
    all.push_back(std::move(one));
  }
  return all;
}

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

namespace {

/// The code point that begins at `at`, and how many bytes it takes; a byte that begins none stands for itself.
std::pair<char32_t, std::size_t> code_point(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = byte(at) >= 0xF0 ? 4 : byte(at) >= 0xE0 ? 3 : byte(at) >= 0xC0 ? 2 : 1;
  if (length == 1 || at + length > text.size()) return {byte(at), 1};
  char32_t code = byte(at) & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(at + i) & 0x3Fu);
  return {code, length};
}

/// Text that roff leaves alone: backslashes, dashes that are typed, a dot or quote that begins a line, and what is not
/// ASCII by its code point.
std::string roff(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto [code, length] = code_point(text, at);
    const char c = text[at];
    at += length;
    if (code >= 0x80) {
      out += fmt::format("\\[u{:04X}]", static_cast<std::uint32_t>(code));
      continue;
    }
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string page_title(const ShownProgram& program, const std::string& path) {
  std::string name = program.name;
  for (const std::string& word : words_of(path)) name += "-" + word;
  return name;
}

std::string head(const ShownProgram& program, const std::string& path, const std::string& help) {
  std::string name = page_title(program, path), capitals = name;
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return fmt::format(".TH {} 1 \"\" \"{}\" \"User commands\"\n.nh\n.ad l\n.SH NAME\n{} \\- {}\n", roff(capitals),
                     program.version, roff(name), roff(help));
}

/// FILE, of a choice its words.
std::string value_of(const ShownArgument& argument) {
  std::string words;
  for (const std::string& choice : argument.choices) words += (words.empty() ? "" : "|") + choice;
  return words.empty() ? "VALUE" : words;
}

std::string option_text(const ShownArgument& argument) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < argument.names.size(); ++i)
    text += fmt::format("{}\\fB{}\\fR", i == 0 ? "" : ", ", roff(argument.names[i]));
  if (!argument.flag && !argument.by_place) text += fmt::format(" \\fI{}\\fR", roff(value_of(argument)));
  if (argument.many) text += " ...";
  text += "\n" + roff(argument.help);
  if (argument.required) text += " (required)";
  if (!argument.preset.empty()) text += fmt::format(" ({} unless given)", roff(argument.preset));
  return text + "\n";
}

std::string synopsis(const ShownProgram& program, const ShownVerb& verb) {
  std::string text = fmt::format(".B {} {}\n", program.name, roff(verb.path));
  for (const ShownArgument& argument : verb.arguments) {
    if (argument.by_place) {
      const std::string name = fmt::format("{}{}", argument.names.front(), argument.many ? "..." : "");
      text += argument.required ? roff(name) + "\n" : fmt::format("[{}]\n", roff(name));
    } else if (argument.required) {
      text += fmt::format("\\fB{}\\fR \\fI{}\\fR\n", roff(argument.names.back()), roff(value_of(argument)));
    }
  }
  return text + "[\\fIOPTIONS\\fR]\n";
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n.TP\n.B 0\ndone\n.TP\n.B 1\nthe check failed or the result does not hold\n.TP\n.B "
    "2\nusage\n.TP\n.B 3\nan unusable input file\n.TP\n.B 4\nlink or unit fault\n.TP\n.B 5\ncannot write, or internal "
    "failure\n.TP\n.B 128+n\nended by signal n\n";

}  // namespace

std::string manual_page(const ShownProgram& program, const ShownVerb& verb) {
  std::string text = head(program, verb.path, verb.help) + ".SH SYNOPSIS\n" + synopsis(program, verb);
  text += ".SH OPTIONS\n";
  for (const ShownArgument& argument : verb.arguments) text += option_text(argument);
  if (!verb.example.empty()) {
    text += ".SH EXAMPLES\n.nf\n";
    for (const std::string_view line : lines_of(verb.example)) text += roff(trimmed(line)) + "\n";
    text += ".fi\n";
  }
  return text + kExitStatus + fmt::format(".SH SEE ALSO\n.BR {} (1)\n", roff(program.name));
}

std::string manual_overview(const ShownProgram& program) {
  std::string text = head(program, "", program.help);
  text +=
      fmt::format(".SH SYNOPSIS\n.B {}\nVERB [ARGUMENTS]\n.br\n.B {} VERB \\-\\-help\n", program.name, program.name);
  text += ".SH VERBS\nEach has a page of its own.\n";
  std::string menu;
  for (const ShownVerb& verb : program.verbs) {
    const std::string first = words_of(verb.path).front();
    if (first != menu && program.help_of(first) != verb.help)
      text += fmt::format(".SS {}\n", roff(program.help_of(first).empty() ? first : program.help_of(first)));
    menu = first;
    text += fmt::format(".TP\n.B {}\n{}\n", roff(verb.path), roff(verb.help));
  }
  return text + kExitStatus;
}

std::vector<ManualPage> manual_pages(const ShownProgram& program) {
  std::vector<ManualPage> pages{{page_title(program, "") + ".1", manual_overview(program)}};
  for (const ShownVerb& verb : program.verbs)
    pages.push_back({page_title(program, verb.path) + ".1", manual_page(program, verb)});
  return pages;
}

Result<void> write_pages(const std::vector<ManualPage>& pages, const std::filesystem::path& folder, bool force) {
  std::vector<std::string> names;
  for (const ManualPage& page : pages) names.push_back((folder / page.file).string());
  if (auto kept = spared(names, force); !kept) return kept;
  disc::make_folders(folder);
  for (const ManualPage& page : pages)
    if (auto written = write_file(folder / page.file, page.text); !written) return written;
  return {};
}

}  // namespace ecs::cli
