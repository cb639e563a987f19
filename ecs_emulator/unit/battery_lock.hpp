// One battery, one emulator: a lock beside the battery's file for as long as a process works with it.
// Does not live here: the file itself (battery.hpp), which is replaced whole at every change and cannot carry a lock.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "ecs_emulator/unit/workshop_socket.hpp"

namespace ecs::emulator {

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
