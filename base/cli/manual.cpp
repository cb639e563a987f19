#include "base/cli/manual.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/overwriting.hpp"
#include "base/text.hpp"

namespace ecs::cli {
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
    ".SH EXIT STATUS\n.TP\n.B 0\ndone\n.TP\n.B 1\nthe thing asked for does not hold\n.TP\n.B 2\nusage\n"
    ".TP\n.B 3\na file that is unfit\n.TP\n.B 4\nlink or unit\n.TP\n.B 5\nnot written, or an internal failure\n"
    ".TP\n.B 128+n\nended by signal n\n";

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
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const ManualPage& page : pages)
    if (auto written = write_file(folder / page.file, page.text); !written) return written;
  return {};
}

}  // namespace ecs::cli
