#include "commissioning/link/unit_link.hpp"

#include <array>
#include <charconv>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

std::uint64_t key_in(const std::string& text) {
  std::uint64_t key = 0;
  const std::string_view digits = trimmed(text);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), key, 16);
  return error == std::errc() && end == digits.data() + digits.size() ? key : 0;
}

/// A file beside `path` with this content, that only its owner can read; empty: it could not be written whole.
std::filesystem::path private_draft(const std::filesystem::path& path, const std::string& content) {
  std::filesystem::path draft = fmt::format("{}.{:016x}", path.string(), protocol::chance_64());
  const int file = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return {};
  const ssize_t written = ::write(file, content.data(), content.size());
  ::close(file);
  if (written == static_cast<ssize_t>(content.size())) return draft;
  disc::remove(draft);
  return {};
}

/// The file's key; a new file where there is none. Of two programs that make it at once, both take the one kept: it
/// gets its name when it is whole.
std::uint64_t kept_key() {
  const auto folder = state_folder();
  if (!folder) return 0;
  const std::filesystem::path path = *folder / "host.key";
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    const std::filesystem::path draft = private_draft(path, fmt::format("{:016x}\n", protocol::chance_64()));
    if (draft.empty()) return 0;
    std::filesystem::create_hard_link(draft, path, ignored);
    std::filesystem::remove(draft, ignored);
  }
  const Unwatched secret;
  const auto text = read_file(path);
  return text ? key_in(*text) : 0;
}

/// One file for each unit in the state folder, with the serial number by its SHA-256 and the secret in hexadecimal
/// digits.
class KeptSecrets : public protocol::SecretStore {
 public:
  std::optional<protocol::Secret> secret_of(const std::string& serial_number) override {
    const auto path = path_of(serial_number);
    const Unwatched unwatched;
    const auto text = path ? read_file(*path) : Result<std::string>(std::string());
    if (!text) return std::nullopt;
    const std::string_view digits = trimmed(*text);
    protocol::Secret secret{};
    if (digits.size() != 2 * secret.size()) return std::nullopt;
    for (std::size_t i = 0; i < secret.size(); ++i) {
      const auto* const at = digits.data() + 2 * i;
      if (const auto [end, error] = std::from_chars(at, at + 2, secret[i], 16); error != std::errc() || end != at + 2)
        return std::nullopt;
    }
    return secret;
  }
  void keep(const std::string& serial_number, const protocol::Secret& secret) override {
    const auto path = path_of(serial_number);
    if (!path) return;
    std::string digits;
    for (const std::uint8_t byte : secret) digits += fmt::format("{:02x}", byte);
    std::error_code ignored;
    if (const std::filesystem::path draft = private_draft(*path, digits + "\n"); !draft.empty())
      std::filesystem::rename(draft, *path, ignored);
  }

 private:
  static std::optional<std::filesystem::path> path_of(const std::string& serial_number) {
    const auto folder = state_folder();
    if (!folder) return std::nullopt;
    constexpr std::size_t kDigits = 16;
    return *folder / fmt::format("unit-{}.key", sha256_hex(serial_number).substr(0, kDigits));
  }
};

/// "user@computer", cut by the unit to what it keeps.
std::string own_name() {
  std::array<char, 65> computer{};
  if (::gethostname(computer.data(), computer.size() - 1) != 0) computer = {};
  passwd entry{};
  passwd* user = nullptr;
  std::array<char, 4096> text{};
  static_cast<void>(::getpwuid_r(::geteuid(), &entry, text.data(), text.size(), &user));
  std::string name = fmt::format("{}@{}", user != nullptr ? user->pw_name : "user", computer.data());
  for (char& c : name)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E) c = '?';
  return name;
}

}  // namespace

protocol::Host this_host() { return {kept_key(), own_name(), {}, std::make_shared<KeptSecrets>()}; }

std::string arm_code_in_environment() {
  const char* code = std::getenv("ECS_ARM_CODE");
  return code == nullptr ? std::string() : std::string(code);
}

namespace {

/// An emulator of this program or of another one.
struct Reached {
  std::shared_ptr<EmulatorProcess> own;
  std::optional<SharedEmulator> others;
};

/// The emulator with this machine that runs already, here or in another program that shares it, else a new one.
Result<Reached> reached(const EmulatorLink& link, bool shares) {
  const auto program = emulator_program();
  if (!program)
    return problem(ProblemKind::link,
                   "the bundled emulator `ecs-emulator` is not found in the folder of `ecs` or on PATH: install it, or "
                   "give --link rtu:/dev/ttyUSB0:115200 or --link tcp:HOST:PORT");
  ECS_TRY(memory, memory_file_of(link.machine));
  static std::mutex mutex;
  static std::map<std::filesystem::path, std::weak_ptr<EmulatorProcess>> running;
  const std::lock_guard lock(mutex);
  if (auto process = running[memory].lock(); process && process->running()) return Reached{process, {}};
  if (auto others = shared_emulator(memory)) return Reached{{}, others};
  auto process = EmulatorProcess::start({*program, link.machine, memory, shares});
  if (!process) {
    if (auto others = shared_emulator(memory)) return Reached{{}, others};  // it came up meanwhile
    return tl::unexpected(process.error());
  }
  const std::shared_ptr<EmulatorProcess> own = std::move(*process);
  running[memory] = own;
  return Reached{own, {}};
}

}  // namespace

Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled) {
  UnitLink::Emulator emulator;
  protocol::LinkAddress address;
  protocol::Host host = this_host();
  if (const auto* link = std::get_if<EmulatorLink>(&choice.link)) {
    ECS_TRY(found, reached(*link, choice.shares));
    emulator.bundled = true;
    emulator.process = found.own;
    emulator.workshop = found.own ? found.own->workshop() : found.others->workshop;
    emulator.arm_code = found.own ? found.own->arm_code() : found.others->arm_code;
    ECS_TRY(way, found.own ? protocol::LinkAddress{protocol::SerialPort{found.own->pty()}}
                           : protocol::link_address_of(found.others->link));
    address = std::move(way);
    host.arm_code = emulator.arm_code;
  } else {
    address = std::get<protocol::LinkAddress>(choice.link);
    host.arm_code = arm_code_in_environment();
  }
  if (!choice.arm_code.empty()) host.arm_code = choice.arm_code;
  ECS_TRY(client, protocol::UnitClient::connect(address, {&cancelled, std::nullopt}, host));
  return UnitLink(std::move(emulator), std::move(client), to_text(choice));
}

}  // namespace ecs::commissioning
