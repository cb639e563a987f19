// The file that stands for the lithium battery: axis memory and commit records survive in it (thesis 5.2). One battery,
// one emulator: a lock lies beside the file, which is replaced whole at every change and cannot carry a lock itself.
// Does not live here: the memory itself (memory.hpp).
#pragma once

#include <filesystem>

#include "base/descriptor.hpp"
#include "base/result.hpp"
#include "ecs_emulator/unit/memory.hpp"

namespace ecs::emulator {

/// Brings the content of the file into the memory. A file that does not exist leaves it empty (a new battery). A file
/// that is none of ours, or of a rack with another number of modules, is a `bad_input` problem.
[[nodiscard]] Result<void> restore(UnitMemory& memory, const std::filesystem::path& path);

/// Writes the file, whole or not at all.
[[nodiscard]] Result<void> keep(UnitMemory& memory, const std::filesystem::path& path);

class BatteryLock {
 public:
  /// Locks `<battery>.in-use`, whatever links lead to the battery. Waits a second for a process that is just ending;
  /// then an `output` problem that names the process.
  [[nodiscard]] static Result<BatteryLock> take(const std::filesystem::path& battery);
  BatteryLock(BatteryLock&& other) noexcept : file_(std::move(other.file_)), path_(std::move(other.path_)) {}
  BatteryLock& operator=(BatteryLock&&) = delete;
  ~BatteryLock();  ///< removes the file

 private:
  BatteryLock(Descriptor file, std::filesystem::path path) : file_(std::move(file)), path_(std::move(path)) {}
  Descriptor file_;
  std::filesystem::path path_;
};

}  // namespace ecs::emulator
