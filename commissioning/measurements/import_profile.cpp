// Import profiles: named answers to what a kind of file does not say, and those that come with the program, found by
// what a file contains.
#include <algorithm>
#include <array>
#include <sstream>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/toml_reader.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/measurements/files.hpp"

namespace ecs::commissioning {
namespace fs = std::filesystem;
namespace {

using Answers = ImportArguments;
using AnswerMember =
    std::variant<std::string Answers::*, int Answers::*, bool Answers::*, std::optional<double> Answers::*>;
/// The keys of profiles, as a problem lists them.
const std::array<std::pair<std::string_view, AnswerMember>, 33> kProfileKeys{
    {{"columns", &Answers::columns},
     {"skip", &Answers::skip},
     {"rows", &Answers::rows},
     {"delimiter", &Answers::delimiter},
     {"decimal", &Answers::decimal},
     {"values", &Answers::values},
     {"axis", &Answers::axis},
     {"sense", &Answers::sense},
     {"parked", &Answers::parked},
     {"encoding", &Answers::encoding},
     {"target_unit", &Answers::target_unit},
     {"reading_unit", &Answers::reading_unit},
     {"channel", &Answers::channel},
     {"channels", &Answers::channels},
     {"join", &Answers::join},
     {"max_gap_s", &Answers::max_gap_s},
     {"at_rest_mm", &Answers::at_rest_mm},
     {"average", &Answers::average},
     {"environment_every_s", &Answers::environment_every_s},
     {"keep_set_up", &Answers::keep_set_up},
     {"channel_column", &Answers::channel_column},
     {"row_begins", &Answers::row_begins},
     {"target_lines", &Answers::target_lines},
     {"matrix", &Answers::matrix},
     {"section", &Answers::section},
     {"line_prefix", &Answers::line_prefix},
     {"absent", &Answers::absent},
     {"note", &Answers::note},
     {"accept_truncated", &Answers::accept_truncated},
     {"table_holds_errors", &Answers::table_holds_errors},
     {"recognised_by", &Answers::recognised_by},
     {"headings", &Answers::headings},
     {"used_for", &Answers::used_for}}};

// The value of a key; nothing, and what was expected of it, where it is none.

std::optional<std::string> profile_value(const toml::node& node, const std::string&, std::string& expected) {
  expected = "a text";
  return node.value_exact<std::string>();
}
std::optional<int> profile_value(const toml::node& node, int, std::string& expected) {
  expected = "a whole number from 0 to 1000000";
  const auto value = node.value_exact<std::int64_t>();
  if (!value || *value < 0 || *value > 1'000'000) return std::nullopt;
  return static_cast<int>(*value);
}
std::optional<bool> profile_value(const toml::node& node, bool, std::string& expected) {
  expected = "true or false";
  return node.value_exact<bool>();
}
std::optional<double> profile_value(const toml::node& node, const std::optional<double>&, std::string& expected) {
  expected = "a number of at least 0";
  const auto value = node.value<double>();
  return value && *value >= 0.0 ? value : std::nullopt;
}

bool is_path(const std::string& name) { return name.find('/') != std::string::npos || name.ends_with(".toml"); }

fs::path own_profile_file(const std::string& name) {
  return is_path(name) ? fs::path(name) : configuration_file().parent_path() / "import" / (name + ".toml");
}

std::vector<fs::path> profiles_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The profiles that come with the program.
std::vector<fs::path> shipped_profiles() {
  const auto one = sample_file(fs::path("profiles") / "klipper_bed_mesh.toml");
  return one ? profiles_in(one->parent_path()) : std::vector<fs::path>();
}

std::string known_profiles() {
  std::vector<std::string> names;
  for (const fs::path& file : profiles_in(own_profile_file("x").parent_path())) names.push_back(file.stem().string());
  for (const fs::path& file : shipped_profiles()) names.push_back(file.stem().string());
  std::sort(names.begin(), names.end());
  if (names.empty()) return "none is saved yet (use --save-profile NAME)";
  return fmt::format("there are {}", fmt::join(names, ", "));
}

/// Takes one key into what the command line left open; what was expected of it, or nothing.
std::string take(ImportArguments& arguments, const ImportArguments& given, std::string_view key,
                 const toml::node& node) {
  const auto* const known = std::ranges::find(kProfileKeys, key, [](const auto& one) { return one.first; });
  if (known == kProfileKeys.end()) {
    std::vector<std::string_view> names;
    for (const auto& one : kProfileKeys) names.push_back(one.first);
    return fmt::format("a key of import profiles ({})", fmt::join(names, ", "));
  }
  std::string expected;
  std::visit(
      [&](auto member) {
        const auto value = profile_value(node, given.*member, expected);
        if (!value) return;
        expected.clear();
        if (given.*member == ImportArguments{}.*member) arguments.*member = *value;
      },
      known->second);
  return expected;
}

/// What is given as a profile; empty: nothing is.
std::string profile_text(const ImportArguments& arguments) {
  toml::table table;
  for (const auto& [key, member] : kProfileKeys)
    std::visit(
        [&, name = key](auto of) {
          if (arguments.*of == ImportArguments{}.*of) return;
          if constexpr (std::is_same_v<decltype(of), std::optional<double> Answers::*>)
            table.insert(name, *(arguments.*of));
          else
            table.insert(name, arguments.*of);
        },
        member);
  if (table.empty()) return {};
  // A line break as \n: the library loses the first one behind three quotes.
  constexpr auto kOneLine = toml::toml_formatter::default_flags &
                            ~(toml::format_flags::allow_multi_line_strings | toml::format_flags::allow_literal_strings);
  std::ostringstream text;
  text << "# import profile of ecs laser import\n" << toml::toml_formatter(table, kOneLine) << '\n';
  return text.str();
}

/// Of a table with headings, by which how it was read is kept; empty: it has none.
std::string headings_of(const laser::TableShape& shape) {
  const bool named = std::ranges::any_of(shape.headings, [](const std::string& heading) { return !heading.empty(); });
  return named ? fmt::format("{}", fmt::join(shape.headings, "\t")) : std::string();
}

fs::path remembered_file(const std::string& headings) {
  constexpr std::size_t kDigits = 16;
  return configuration_file().parent_path() / "import" / "by_headings" /
         (sha256_hex(headings).substr(0, kDigits) + ".toml");
}

/// The text holds the mark of the profile or, where it has none, two lines that begin as its rows.
bool is_for(const fs::path& profile, std::string_view text) {
  ImportArguments arguments;
  arguments.profile = profile.string();
  const auto whole = with_profile(arguments);
  if (!whole) return false;
  if (!whole->recognised_by.empty()) return text.find(whole->recognised_by) != std::string_view::npos;
  const auto options = import_options(*whole);
  return options && options->mapping && !options->mapping->row_begins.empty() &&
         laser::rows_begun(text, *options->mapping) >= 2;
}

}  // namespace

fs::path profile_file(const std::string& name) {
  fs::path own = own_profile_file(name);
  if (is_path(name) || disc::exists(own)) return own;
  return sample_file(fs::path("profiles") / (name + ".toml")).value_or(own);
}

Result<ImportArguments> with_profile(ImportArguments arguments) {
  if (arguments.profile.empty()) return arguments;
  const fs::path path = profile_file(arguments.profile);
  if (!disc::exists(path))
    return problem(ProblemKind::usage, "--profile: no import profile {}: {}", path.string(), known_profiles());
  ECS_TRY(text, read_file(path));
  ECS_TRY(table, parse_toml(text, path.string()));
  const ImportArguments given = arguments;
  std::vector<Problem> problems;
  for (const auto& [key, node] : table) {
    const std::string expected = take(arguments, given, key.str(), node);
    if (!expected.empty())
      problems.push_back({ProblemKind::bad_input,
                          fmt::format("{}: expected {}", key.str(), expected),
                          path.string(),
                          static_cast<int>(key.source().begin.line),
                          static_cast<int>(key.source().begin.column),
                          {}});
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return arguments;
}

ImportArguments with_found_profile(std::string_view bytes, const std::string& file, ImportArguments given) {
  if (!given.profile.empty() || !given.columns.empty() || !given.matrix.empty()) return given;
  constexpr std::size_t kHeadBytes = 16 * 1024;  // what identifies a file is at its start
  const auto text = laser::decoded(bytes.substr(0, kHeadBytes), file);
  // a measurement CSV made from such a file keeps its words as a comment
  if (const auto* format = text ? laser::recognised_format(text->text, file) : nullptr;
      format == laser::file_formats().front())
    return given;
  const auto profiles = shipped_profiles();
  const auto found = std::find_if(profiles.begin(), profiles.end(),
                                  [&](const fs::path& path) { return text && is_for(path, text->text); });
  if (found != profiles.end()) given.profile = found->string();
  return given;
}

Result<fs::path> save_profile(const std::string& name, const ImportArguments& arguments, bool force) {
  if (name.empty() || name.find_first_of("\"\\\n\r\t") != std::string::npos || name == "." || name == "..")
    return problem(ProblemKind::usage, "--save-profile: expected a name or a path, found \"" + name + "\"");
  const std::string text = profile_text(arguments);
  if (text.empty())
    return problem(ProblemKind::usage,
                   "--save-profile: expected --columns or another import option to save, found none");
  const fs::path path = own_profile_file(name);
  ECS_DO(spared({path.string()}, force));
  if (path.has_parent_path()) disc::make_folders(path.parent_path());
  ECS_DO(write_file(path, text));
  return path;
}

std::optional<RememberedMapping> remembered_mapping(const laser::TableShape& shape) {
  const std::string headings = headings_of(shape);
  if (headings.empty()) return std::nullopt;
  RememberedMapping kept{{}, {}, remembered_file(headings)};
  if (!disc::exists(kept.kept_in)) return std::nullopt;
  kept.options.profile = kept.kept_in.string();
  auto options = with_profile(kept.options);
  if (!options || options->headings != headings) return std::nullopt;
  kept.options = std::move(*options);
  kept.file = kept.options.used_for;
  for (std::string* only_kept : {&kept.options.profile, &kept.options.headings, &kept.options.used_for})
    only_kept->clear();
  if (kept.options.skip == 0) kept.options.skip = laser::rows_of(shape).skip;
  if (kept.options.rows == 0) kept.options.rows = static_cast<int>(laser::rows_of(shape).count);
  return kept;
}

void remember_mapping(const std::string& file, const ImportArguments& options) {
  const auto head = beginning_of_text(file, options.encoding);
  const auto shape = head ? laser::table_shape(head->text) : std::nullopt;
  const auto rules = laser::column_rules(options.columns);
  const auto numbered = rules && shape ? laser::by_number(*rules, shape->headings) : std::nullopt;
  const bool any = numbered && std::ranges::any_of(*numbered, [](const auto& rule) { return rule.column > 0; });
  if (!any || headings_of(*shape).empty()) return;
  ImportArguments kept = options;
  kept.headings = headings_of(*shape);
  kept.columns = laser::rules_text(*numbered);
  kept.used_for = fs::path(file).filename().string();
  const bool from_heading =
      std::ranges::any_of(*rules, [](const auto& rule) { return rule.column == 0 && !laser::is_word_rule(rule); });
  const laser::SuggestedRows rows = laser::rows_of(*shape);
  if (from_heading || kept.skip == rows.skip) kept.skip = 0;
  if (kept.rows == static_cast<int>(rows.count)) kept.rows = 0;
  const fs::path path = remembered_file(kept.headings);
  disc::make_folders(path.parent_path());
  (void)write_file(path, profile_text(kept));
}

}  // namespace ecs::commissioning
