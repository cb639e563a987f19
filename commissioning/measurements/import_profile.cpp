#include "commissioning/measurements/import_profile.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/file_watch.hpp"
#include "base/overwriting.hpp"
#include "base/toml_reader.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::commissioning {
namespace fs = std::filesystem;
namespace {

using Text = std::pair<const char*, std::string ImportArguments::*>;
constexpr std::array<Text, 21> kTexts{{{"columns", &ImportArguments::columns},
                                       {"delimiter", &ImportArguments::delimiter},
                                       {"decimal", &ImportArguments::decimal},
                                       {"values", &ImportArguments::values},
                                       {"axis", &ImportArguments::axis},
                                       {"sense", &ImportArguments::sense},
                                       {"parked", &ImportArguments::parked},
                                       {"encoding", &ImportArguments::encoding},
                                       {"target_unit", &ImportArguments::target_unit},
                                       {"reading_unit", &ImportArguments::reading_unit},
                                       {"channel", &ImportArguments::channel},
                                       {"channels", &ImportArguments::channels},
                                       {"join", &ImportArguments::join},
                                       {"matrix", &ImportArguments::matrix},
                                       {"section", &ImportArguments::section},
                                       {"line_prefix", &ImportArguments::line_prefix},
                                       {"absent", &ImportArguments::absent},
                                       {"row_begins", &ImportArguments::row_begins},
                                       {"target_lines", &ImportArguments::target_lines},
                                       {"note", &ImportArguments::note},
                                       {"recognised_by", &ImportArguments::recognised_by}}};
using Count = std::pair<const char*, int ImportArguments::*>;
constexpr std::array<Count, 3> kCounts{{{"skip", &ImportArguments::skip},
                                        {"rows", &ImportArguments::rows},
                                        {"channel_column", &ImportArguments::channel_column}}};
using Flag = std::pair<const char*, bool ImportArguments::*>;
constexpr std::array<Flag, 4> kFlags{{{"accept_truncated", &ImportArguments::accept_truncated},
                                      {"table_holds_errors", &ImportArguments::table_holds_errors},
                                      {"average", &ImportArguments::average},
                                      {"keep_set_up", &ImportArguments::keep_set_up}}};
using Number = std::pair<const char*, std::optional<double> ImportArguments::*>;
constexpr std::array<Number, 3> kNumbers{{{"max_gap_s", &ImportArguments::max_gap_s},
                                          {"at_rest_mm", &ImportArguments::at_rest_mm},
                                          {"environment_every_s", &ImportArguments::environment_every_s}}};

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
  if (names.empty()) return "none is saved yet (--save-profile NAME)";
  return fmt::format("there are {}", fmt::join(names, ", "));
}

/// Takes one key into what the command line left open; what was expected of it, or nothing.
std::string take(ImportArguments& arguments, const ImportArguments& given, std::string_view key,
                 const toml::node& node) {
  const ImportArguments open;
  for (const auto& [name, member] : kTexts) {
    if (key != name) continue;
    const auto value = node.value_exact<std::string>();
    if (!value) return "a text";
    if (given.*member == open.*member) arguments.*member = *value;
    return {};
  }
  for (const auto& [name, member] : kCounts) {
    if (key != name) continue;
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < 0 || *value > 1'000'000) return "a whole number from 0 to 1000000";
    if (given.*member == open.*member) arguments.*member = static_cast<int>(*value);
    return {};
  }
  for (const auto& [name, member] : kFlags) {
    if (key != name) continue;
    const auto value = node.value_exact<bool>();
    if (!value) return "true or false";
    arguments.*member = given.*member || *value;
    return {};
  }
  for (const auto& [name, member] : kNumbers) {
    if (key != name) continue;
    const auto value = node.value<double>();
    if (!value || *value < 0.0) return "a number of at least 0";
    if (!(given.*member)) arguments.*member = *value;
    return {};
  }
  return "a key of import profiles (columns, skip, rows, delimiter, decimal, values, axis, sense, parked, encoding, "
         "target_unit, reading_unit, channel, channels, join, max_gap_s, at_rest_mm, average, environment_every_s, "
         "keep_set_up, channel_column, row_begins, target_lines, matrix, section, line_prefix, "
         "absent, note, accept_truncated, table_holds_errors, recognised_by)";
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
  const fs::path own = own_profile_file(name);
  std::error_code error;
  if (is_path(name) || fs::exists(own, error)) return own;
  return sample_file(fs::path("profiles") / (name + ".toml")).value_or(own);
}

Result<ImportArguments> with_profile(ImportArguments arguments) {
  if (arguments.profile.empty()) return arguments;
  const fs::path path = profile_file(arguments.profile);
  std::error_code error;
  if (!fs::exists(path, error))
    return problem(ProblemKind::usage,
                   fmt::format("--profile: no import profile {}: {}", path.string(), known_profiles()));
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

ImportArguments with_found_profile(const std::string& file, ImportArguments given) {
  if (!given.profile.empty() || !given.columns.empty() || !given.matrix.empty()) return given;
  constexpr std::size_t kHeadBytes = 16 * 1024;  // what identifies a file is at its start
  const std::string head = head_of(file, kHeadBytes);
  const auto text = laser::decoded(head, file);
  const auto profiles = shipped_profiles();
  const auto found = std::find_if(profiles.begin(), profiles.end(),
                                  [&](const fs::path& path) { return text && is_for(path, text->text); });
  if (found != profiles.end()) given.profile = found->string();
  return given;
}

Result<fs::path> save_profile(const std::string& name, const ImportArguments& arguments, bool force) {
  if (name.empty() || name.find_first_of("\"\\\n\r\t") != std::string::npos || name == "." || name == "..")
    return problem(ProblemKind::usage, "--save-profile: expected a name or a path, found \"" + name + "\"");
  const ImportArguments open;
  toml::table table;
  for (const auto& [key, member] : kTexts)
    if (arguments.*member != open.*member) table.insert(key, arguments.*member);
  for (const auto& [key, member] : kCounts)
    if (arguments.*member != open.*member) table.insert(key, arguments.*member);
  for (const auto& [key, member] : kNumbers)
    if (arguments.*member) table.insert(key, *(arguments.*member));
  for (const auto& [key, member] : kFlags)
    if (arguments.*member) table.insert(key, true);
  if (table.empty())
    return problem(ProblemKind::usage,
                   "--save-profile: expected --columns or another import option to keep, found none");
  // A line break as \n: the library loses the first one behind three quotes.
  constexpr auto kOneLine = toml::toml_formatter::default_flags &
                            ~(toml::format_flags::allow_multi_line_strings | toml::format_flags::allow_literal_strings);
  std::ostringstream text;
  text << "# import profile of ecs laser import\n" << toml::toml_formatter(table, kOneLine) << '\n';
  const fs::path path = own_profile_file(name);
  ECS_DO(spared({path.string()}, force));
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  ECS_DO(write_file(path, text.str()));
  return path;
}

}  // namespace ecs::commissioning
