#include "ecs_emulator/unit/battery.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/file.hpp"

namespace ecs::emulator {
namespace {

constexpr std::string_view kMagic = "ECS battery 1\n";

struct Part {
  Address first = 0;
  std::uint32_t size = 0;
};

std::array<Part, 3> parts_of(const UnitMemory& memory) {
  const std::uint32_t bank = bank_bytes(memory.modules());
  return {{{kCommitRecords.first, kCommitRecords.size}, {kBankA.first, bank}, {kBankB.first, bank}}};
}

/// The name of a file lasts over a loss of power once its folder is on the disk.
Result<void> keep_name(const std::filesystem::path& path) {
  const std::filesystem::path folder = led_to(path).parent_path();
  const int handle = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool kept = handle >= 0 && (::fsync(handle) == 0 || errno == EINVAL);  // EINVAL: it has nothing to write
  const int error = errno;
  if (handle >= 0) ::close(handle);
  if (kept) return {};
  return problem(ProblemKind::output, fmt::format("{}: cannot write: {}", folder.string(), std::strerror(error)));
}

}  // namespace

Result<void> restore(UnitMemory& memory, const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  ECS_TRY(content, read_file(path));
  std::size_t wanted = kMagic.size();
  for (const Part& part : parts_of(memory)) wanted += part.size;
  if (!content.starts_with(kMagic) || content.size() != wanted)
    return problem_at(path.string(), 0, 0,
                      fmt::format("expected the battery memory of a unit with {} memory module(s), {} bytes, got {} "
                                  "bytes; name another file, or delete it to begin with an empty memory",
                                  memory.modules(), wanted, content.size()));
  std::size_t at = kMagic.size();
  for (const Part& part : parts_of(memory)) {
    const ByteView bytes(reinterpret_cast<const std::uint8_t*>(content.data()) + at, part.size);
    memory.write(part.first, bytes);
    at += part.size;
  }
  memory.kept();
  return {};
}

Result<void> keep(UnitMemory& memory, const std::filesystem::path& path) {
  std::string content(kMagic);
  for (const Part& part : parts_of(memory)) {
    const ByteView bytes = memory.view(part.first, part.size);
    content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  if (auto written = write_file(path, content); !written) return written;
  if (auto lasting = keep_name(path); !lasting) return lasting;
  memory.kept();
  return {};
}

}  // namespace ecs::emulator
