#include "commissioning/link/host.hpp"

#include <array>
#include <charconv>
#include <cstdlib>
#include <random>

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/file_watch.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

std::uint64_t key_in(const std::string& text) {
  std::uint64_t key = 0;
  const std::string_view digits = trimmed(text);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), key, 16);
  return error == std::errc() && end == digits.data() + digits.size() ? key : 0;
}

/// The file's key; a new file where there is none. Of two programs that make it at once, both take the one kept: it
/// gets its name when it is whole.
std::uint64_t kept_key() {
  const auto folder = state_folder();
  if (!folder) return 0;
  const std::filesystem::path path = *folder / "host.key";
  std::random_device chance;
  const std::string made = fmt::format("{:08x}{:08x}\n", chance(), chance());
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    const std::filesystem::path draft = fmt::format("{}.{:08x}", path.string(), chance());
    const int file = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0) return 0;
    const ssize_t written = ::write(file, made.data(), made.size());
    ::close(file);
    if (written == static_cast<ssize_t>(made.size())) std::filesystem::create_hard_link(draft, path, ignored);
    std::filesystem::remove(draft, ignored);
  }
  const Unwatched secret;
  const auto text = read_file(path);
  return text ? key_in(*text) : 0;
}

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

protocol::Host this_host() { return {kept_key(), own_name(), {}}; }

std::string arm_code_in_environment() {
  const char* code = std::getenv("ECS_ARM_CODE");
  return code == nullptr ? std::string() : std::string(code);
}

}  // namespace ecs::commissioning
