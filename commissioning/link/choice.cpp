#include "commissioning/link/choice.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

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
    if (!path.empty() && disc::is_file(path)) return path;
  }
  return std::nullopt;
}

Result<fs::path> machine_or_sample(std::string_view machine) {
  if (!machine.empty()) {
    if (!first_file({fs::path(machine)}))
      return problem(ProblemKind::bad_input,
                     "machine of the emulator: no file {}; give emulator:FILE with a machine file", machine);
    return fs::absolute(fs::path(machine)).lexically_normal();
  }
  const auto sample = sample_machine();
  if (!sample)
    return problem(
        ProblemKind::link,
        "no link is given or stored, and the sample machine of the bundled emulator, samples/mill/machine.toml, is not "
        "found: give --link rtu:/dev/ttyUSB0:115200, --link tcp:HOST:PORT or --link emulator:machine.toml");
  return *sample;
}

Result<toml::table> configuration() {
  const fs::path path = configuration_file();
  if (!disc::exists(path)) return toml::table{};
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
    if (!text.starts_with("rtu:") && !text.starts_with("tcp:")) wrong.message += ", or emulator[:machine.toml]";
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
  disc::make_folders(configuration_file().parent_path());
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

namespace {

const std::vector<std::string> kKinds{"serial line", "network (TCP)", "emulator"};
const std::vector<std::string> kBaudChoices{"1200",  "2400",   "4800",   "9600",   "19200", "38400",
                                            "57600", "115200", "230400", "460800", "921600"};
const std::vector<std::string> kFormats{"8N1", "8E1", "8O1", "8N2", "8E2"};
constexpr const char* kUnitHelp = "Modbus unit number, 1 to 247; a new unit has 1";

}  // namespace

LinkForm::LinkForm(const LinkChoice& choice) {
  if (const auto* emulator = std::get_if<EmulatorLink>(&choice.link)) {
    kind_ = LinkKind::emulator;
    machine_ = emulator->machine.string();
    return;
  }
  const auto& address = std::get<protocol::LinkAddress>(choice.link);
  unit_ = fmt::format("{}", address.unit);
  if (const auto* line = std::get_if<protocol::SerialPort>(&address.endpoint)) {
    device_ = line->device;
    baud_ = fmt::format("{}", line->baud);
    format_ = fmt::format("8{}{}", line->parity, line->stop_bits);
  } else {
    const auto& peer = std::get<protocol::TcpPeer>(address.endpoint);
    kind_ = LinkKind::network;
    host_ = peer.host;
    port_ = fmt::format("{}", peer.port);
    token_ = peer.token_file;
  }
}

std::vector<LinkField> LinkForm::fields(const std::vector<std::string>& ports) const {
  std::vector<LinkField> rows{{"link", kKinds[static_cast<std::size_t>(kind_)], kKinds, "connection to the unit"}};
  switch (kind_) {
    case LinkKind::serial:
      rows.push_back({"port", device_, ports, "the serial port; the ports of this computer are listed below"});
      rows.push_back({"baud", baud_, kBaudChoices, "as set in the unit; usually 115200 or 9600"});
      rows.push_back({"format", format_, kFormats, "data bits, parity (N none, E even, O odd), stop bits"});
      rows.push_back({"unit", unit_, {}, kUnitHelp});
      break;
    case LinkKind::network:
      rows.push_back({"host", host_, {}, "name or address of the converter or the unit"});
      rows.push_back({"TCP port", port_, {}, "502 for Modbus"});
      rows.push_back({"unit", unit_, {}, kUnitHelp});
      rows.push_back({"token", token_, {}, "file with the unit's token; needed beyond this computer"});
      break;
    case LinkKind::emulator:
      rows.push_back({"machine", machine_, {}, "machine file of the emulator; empty: the sample mill"});
      break;
  }
  return rows;
}

void LinkForm::set(int row, const std::string& typed) {
  const std::string value(trimmed(typed));
  if (row == 0) {
    const auto found = std::find(kKinds.begin(), kKinds.end(), value);
    if (found != kKinds.end()) kind_ = static_cast<LinkKind>(found - kKinds.begin());
    return;
  }
  std::vector<std::string*> values;
  if (kind_ == LinkKind::serial) values = {&device_, &baud_, &format_, &unit_};
  if (kind_ == LinkKind::network) values = {&host_, &port_, &unit_, &token_};
  if (kind_ == LinkKind::emulator) values = {&machine_};
  if (row <= static_cast<int>(values.size())) *values[static_cast<std::size_t>(row - 1)] = value;
}

void LinkForm::step(int row, int by, const std::vector<std::string>& ports) {
  const auto rows = fields(ports);
  if (row < 0 || row >= static_cast<int>(rows.size())) return;
  const LinkField& field = rows[static_cast<std::size_t>(row)];
  const auto count = static_cast<int>(field.choices.size());
  if (count == 0) return;
  const auto found = std::find(field.choices.begin(), field.choices.end(), field.value);
  const int now = found == field.choices.end() ? (by > 0 ? -1 : 0) : static_cast<int>(found - field.choices.begin());
  set(row, field.choices[static_cast<std::size_t>((now + by + count) % count)]);
}

std::string LinkForm::text() const {
  if (kind_ == LinkKind::emulator) return machine_.empty() ? "emulator" : "emulator:" + machine_;
  if (kind_ == LinkKind::serial) return fmt::format("rtu:{}:{}:{}:{}", device_, baud_, format_, unit_);
  const bool bare = host_.find(':') != std::string::npos && !host_.starts_with('[');  // IPv6
  const std::string token = token_.empty() ? "" : "?token=" + token_;
  return bare ? fmt::format("tcp:[{}]:{}:{}{}", host_, port_, unit_, token)
              : fmt::format("tcp:{}:{}:{}{}", host_, port_, unit_, token);
}

}  // namespace ecs::commissioning
