#include "modules/logbook/place.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/settings.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOff = "off";
constexpr const char* kUnnamed = "machine";

/// Letters and digits as they are, in lower case; what is between them one dash.
std::string file_word(const std::string& name) {
  std::string word;
  for (const char c : shown(name)) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || byte >= 0x80)
      word += static_cast<char>(std::tolower(byte));
    else if (!word.empty() && word.back() != '-')
      word += '-';
  }
  while (!word.empty() && word.back() == '-') word.pop_back();
  return word.substr(0, 100);
}

std::optional<LogOwner> owner_of(const fs::path& path) {
  const auto book = Logbook::open_to_read(path);
  if (!book) return std::nullopt;
  const auto owner = book->owner();
  return owner ? std::optional(*owner) : std::nullopt;
}

/// Names for a logbook that begins; the first that is free is taken.
fs::path free_name(const fs::path& folder, const LogOwner& owner) {
  const std::string machine = file_word(owner.machine), number = file_word(owner.serial_number);
  std::vector<std::string> names;
  if (!machine.empty()) names.push_back(machine);
  if (!number.empty()) names.push_back(machine.empty() ? number : fmt::format("{}-{}", machine, number));
  if (names.empty()) names.emplace_back(kUnnamed);
  const std::string last = names.back();
  for (int i = 2;; ++i) {
    for (const std::string& name : names) {
      fs::path path = folder / (name + std::string(kLogbookExtension));
      if (!disc::exists(path)) return path;
    }
    names = {fmt::format("{}-{}", last, i)};
  }
}

/// The newest entries may lie in the write-ahead log beside it.
fs::file_time_type written(const fs::path& path) {
  fs::file_time_type newest = fs::file_time_type::min();
  for (const char* ending : {"", "-wal"}) {
    std::error_code error;
    const auto time = fs::last_write_time(path.string() + ending, error);
    if (!error) newest = std::max(newest, time);
  }
  return newest;
}

std::string quoted_value(std::string_view value) {
  value = trimmed(value);
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  return std::string(value);
}

LogOwner owner_in_header(std::string_view content) {
  LogOwner owner;
  for (const HeaderLine& line : header_lines(content)) {
    if (line.key == "machine" && owner.machine.empty()) owner.machine = quoted_value(line.value);
    if ((line.key == "serial_number" || line.key == "serial no") && owner.serial_number.empty())
      owner.serial_number = quoted_value(line.value);
  }
  return owner;
}

}  // namespace

Result<LogbookSetting> logbook_setting() {
  LogbookSetting setting;
  const std::string wanted = setting_or_empty("ECS_LOGBOOK", "logbook");
  if (lower(wanted) == kOff) {
    setting.off = true;
  } else if (wanted.ends_with(kLogbookExtension)) {
    setting.file = wanted;
  } else if (!wanted.empty()) {
    setting.folder = wanted;
  } else {
    ECS_TRY(state, state_folder());
    setting.folder = state / "logbooks";
  }
  return setting;
}

std::vector<fs::path> logbooks(const LogbookSetting& setting) {
  std::vector<fs::path> found;
  std::error_code error;
  if (!setting.file.empty() && fs::exists(setting.file, error)) found.push_back(setting.file);
  if (setting.folder.empty()) return found;
  for (fs::directory_iterator at(setting.folder, error), end; !error && at != end; at.increment(error))
    if (at->path().extension() == kLogbookExtension) found.push_back(at->path());
  std::sort(found.begin(), found.end());
  std::stable_sort(found.begin(), found.end(),
                   [](const fs::path& a, const fs::path& b) { return written(a) > written(b); });
  return found;
}

Result<std::optional<fs::path>> logbook_of(const LogbookSetting& setting, const LogOwner& owner) {
  if (setting.off) return std::optional<fs::path>();
  if (!setting.file.empty()) return std::optional(setting.file);
  if (owner.machine.empty() && owner.serial_number.empty()) return std::optional<fs::path>();
  std::error_code error;
  fs::create_directories(setting.folder, error);
  if (error)
    return tl::unexpected(
        Problem{ProblemKind::output, "cannot be created: " + error.message(), setting.folder.string(), 0, 0, {}});
  std::optional<fs::path> by_name_alone;
  for (const fs::path& path : logbooks(setting)) {
    const auto of = owner_of(path);
    if (!of || (of->machine.empty() && of->serial_number.empty()) || !belongs(*of, owner)) continue;
    const bool both = !owner.serial_number.empty() && of->serial_number == owner.serial_number;
    if (both || owner.serial_number.empty()) return std::optional(path);
    if (!by_name_alone) by_name_alone = path;
  }
  return by_name_alone ? by_name_alone : std::optional(free_name(setting.folder, owner));
}

std::string operator_name() {
  if (std::string set = setting_or_empty("ECS_OPERATOR", "operator"); !set.empty()) return set;
  if (const passwd* user = ::getpwuid(::geteuid()); user != nullptr && user->pw_name != nullptr) return user->pw_name;
  return {};
}

LogOwner owner_in(std::string_view content) {
  const std::size_t first = content.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string_view::npos) return {};
  if (const LogOwner owner = owner_in_header(content.substr(first));
      !owner.machine.empty() || !owner.serial_number.empty())
    return owner;
  const bool machine_file = content.find("configuration") != std::string_view::npos;
  if (!machine_file && content.find("[identity]") == std::string_view::npos) return {};
  const auto table = parse_toml(content, {});
  if (!table) return {};
  LogOwner owner;
  if (const auto* identity = table->get_as<toml::table>("identity")) {
    owner.machine = (*identity)["machine"].value_or(std::string());
    owner.serial_number = (*identity)["serial_number"].value_or(std::string());
  } else if (table->contains("axis") && table->contains("configuration")) {
    owner.machine = (*table)["name"].value_or(std::string());
  }
  return owner;
}

}  // namespace ecs::commissioning
