#include "commissioning/measurements/import_profile.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "base/file.hpp"
#include "base/plain_text.hpp"
#include "base/text.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::app {
namespace fs = std::filesystem;
namespace {

using Text = std::pair<const char*, std::string ImportArguments::*>;
constexpr std::array<Text, 11> kTexts{{{"columns", &ImportArguments::columns},
                                       {"delimiter", &ImportArguments::delimiter},
                                       {"decimal", &ImportArguments::decimal},
                                       {"values", &ImportArguments::values},
                                       {"axis", &ImportArguments::axis},
                                       {"sense", &ImportArguments::sense},
                                       {"parked", &ImportArguments::parked},
                                       {"encoding", &ImportArguments::encoding},
                                       {"target_unit", &ImportArguments::target_unit},
                                       {"reading_unit", &ImportArguments::reading_unit},
                                       {"channel", &ImportArguments::channel}}};
using Count = std::pair<const char*, int ImportArguments::*>;
constexpr std::array<Count, 2> kCounts{{{"skip", &ImportArguments::skip}, {"rows", &ImportArguments::rows}}};
using Flag = std::pair<const char*, bool ImportArguments::*>;
constexpr std::array<Flag, 2> kFlags{{{"accept_truncated", &ImportArguments::accept_truncated},
                                      {"table_holds_errors", &ImportArguments::table_holds_errors}}};

std::string known_profiles() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(profile_file("x").parent_path(), error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
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
  return "a key of import profiles (columns, skip, rows, delimiter, decimal, values, axis, sense, parked, encoding, "
         "target_unit, reading_unit, channel, accept_truncated, table_holds_errors)";
}

}  // namespace

fs::path profile_file(const std::string& name) {
  if (name.find('/') != std::string::npos || name.ends_with(".toml")) return name;
  return configuration_file().parent_path() / "import" / (name + ".toml");
}

Result<ImportArguments> with_profile(ImportArguments arguments) {
  if (arguments.profile.empty()) return arguments;
  const fs::path path = profile_file(arguments.profile);
  std::error_code error;
  if (!fs::exists(path, error))
    return problem(ProblemKind::usage,
                   fmt::format("--profile: no import profile {}: {}", path.string(), known_profiles()));
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  if (auto why = why_no_text(*text, path.string())) return tl::unexpected(std::move(*why));
  const ImportArguments given = arguments;
  try {
    const toml::table table = toml::parse(*text, path.string());
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
  } catch (const toml::parse_error& wrong) {
    const auto& at = wrong.source().begin;
    return problem_at(path.string(), static_cast<int>(at.line), static_cast<int>(at.column),
                      std::string(wrong.description()));
  }
  return arguments;
}

Result<fs::path> save_profile(const std::string& name, const ImportArguments& arguments) {
  if (name.empty() || name.find_first_of("\"\\\n\r\t") != std::string::npos || name == "." || name == "..")
    return problem(ProblemKind::usage, "--save-profile: expected a name or a path, found \"" + name + "\"");
  const ImportArguments open;
  toml::table table;
  for (const auto& [key, member] : kTexts)
    if (arguments.*member != open.*member) table.insert(key, arguments.*member);
  for (const auto& [key, member] : kCounts)
    if (arguments.*member != open.*member) table.insert(key, arguments.*member);
  for (const auto& [key, member] : kFlags)
    if (arguments.*member) table.insert(key, true);
  if (table.empty())
    return problem(ProblemKind::usage,
                   "--save-profile: expected --columns or another import option to keep, found none");
  std::ostringstream text;
  text << "# import profile of ecs laser import\n" << table << '\n';
  const fs::path path = profile_file(name);
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  const auto written = write_file(path, text.str());
  if (!written) return tl::unexpected(written.error());
  return path;
}

}  // namespace ecs::app
