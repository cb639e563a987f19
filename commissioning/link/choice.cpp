#include "commissioning/link/choice.hpp"

#include <cstdlib>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/settings.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"

namespace ecs::commissioning {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kEmulator = "emulator";

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

fs::path own_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path();
}

std::optional<fs::path> first_file(const std::vector<fs::path>& candidates) {
  for (const fs::path& path : candidates) {
    std::error_code error;
    if (!path.empty() && fs::is_regular_file(path, error)) return path;
  }
  return std::nullopt;
}

Result<fs::path> machine_or_sample(std::string_view machine) {
  if (!machine.empty()) {
    if (!first_file({fs::path(machine)}))
      return problem(
          ProblemKind::bad_input,
          fmt::format("machine of the emulator: no file {}; give emulator:FILE with a machine file", machine));
    return fs::absolute(fs::path(machine)).lexically_normal();
  }
  const auto sample = sample_machine();
  if (!sample)
    return problem(
        ProblemKind::link,
        "no link is given or stored, and the sample machine samples/mill/machine.toml of the bundled emulator is not "
        "found: give --link rtu:/dev/ttyUSB0:115200, --link tcp:HOST:PORT or --link emulator:machine.toml");
  return *sample;
}

Result<toml::table> configuration() {
  const fs::path path = configuration_file();
  std::error_code error;
  if (!fs::exists(path, error)) return toml::table{};
  ECS_TRY(text, read_file(path));
  return parse_toml(text, path.string());
}

}  // namespace

Result<LinkChoice> parsed_link(std::string_view text, std::string origin) {
  if (text == kEmulator || text.starts_with("emulator:")) {
    text.remove_prefix(std::min(text.size(), kEmulator.size() + 1));
    ECS_TRY(machine, machine_or_sample(text));
    return LinkChoice{EmulatorLink{std::move(machine)}, std::move(origin)};
  }
  auto address = protocol::link_address_of(text);
  if (!address) {
    Problem wrong = address.error();
    if (origin != "--link") wrong.message += fmt::format(" (from the {})", origin);
    return tl::unexpected(wrong);
  }
  return LinkChoice{std::move(*address), std::move(origin)};
}

Result<LinkChoice> chosen_link(const std::string& option) {
  if (!option.empty()) return parsed_link(option, "--link");
  ECS_TRY(stored, stored_link());
  if (stored) return parsed_link(*stored, "configuration");
  return parsed_link(kEmulator, "default");
}

std::string to_text(const LinkChoice& choice) {
  if (const auto* emulator = std::get_if<EmulatorLink>(&choice.link)) return "emulator:" + emulator->machine.string();
  return protocol::to_text(std::get<protocol::LinkAddress>(choice.link));
}

fs::path configuration_file() { return settings_file(); }

Result<std::optional<std::string>> stored_link() {
  ECS_TRY(table, configuration());
  const auto* link = table.get("link");
  if (link == nullptr) return std::optional<std::string>();
  const auto text = link->value<std::string>();
  if (!link->is_string() || !text)
    return problem_at(configuration_file().string(), static_cast<int>(link->source().begin.line),
                      static_cast<int>(link->source().begin.column),
                      "link: expected a text such as \"rtu:/dev/ttyUSB0:115200\"");
  return text;
}

Result<void> store_link(const std::string& link) {
  ECS_TRY(table, configuration());
  table.insert_or_assign("link", link);
  std::ostringstream text;
  text << table << '\n';
  std::error_code error;
  fs::create_directories(configuration_file().parent_path(), error);
  return write_file(configuration_file(), text.str());
}

std::optional<fs::path> sample_machine() { return sample_file(fs::path("mill") / "machine.toml"); }

std::optional<fs::path> sample_file(const fs::path& inside) {
  std::vector<fs::path> candidates;
  if (const std::string samples = environment("ECS_SAMPLES"); !samples.empty()) return first_file({samples / inside});
  candidates.push_back(own_folder() / ".." / "share" / "ecs" / "samples" / inside);
  candidates.push_back(own_folder() / ".." / ".." / ".." / "samples" / inside);  // of a clone that was moved
  candidates.push_back(fs::path(ECS_SOURCE_FOLDER) / "samples" / inside);
  auto found = first_file(candidates);
  if (found) found = found->lexically_normal();
  return found;
}

std::optional<fs::path> emulator_program() {
  constexpr const char* name = "ecs-emulator";
  if (const std::string given = environment("ECS_EMULATOR"); !given.empty()) return first_file({given});
  const fs::path own = own_folder();
  std::vector<fs::path> candidates{own / name, own / ".." / "ecs_emulator" / name};
  const std::string search_path = environment("PATH");
  for (const std::string_view folder : split(search_path, ':')) candidates.push_back(fs::path(folder) / name);
  auto found = first_file(candidates);
  if (found) found = found->lexically_normal();
  return found;
}

}  // namespace ecs::commissioning
