// The bundled emulator as a child process: started, asked where its link is, stopped. Requests to a running workshop
// (docs/emulator.md): one JSON object on one line of a Unix socket, its answer on another. For .cpp files only (heavy
// header).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <sys/types.h>

#include "base/json.hpp"
#include "base/result.hpp"

namespace ecs::commissioning {

struct EmulatorOptions {
  std::filesystem::path program;
  std::filesystem::path machine;
  std::filesystem::path memory;  ///< file of its battery-backed memory; locked while it runs
  bool shared = false;           ///< other programs of this user may use it meanwhile, see shared_emulator()
};

/// An emulator that another `ecs` runs and shares.
struct SharedEmulator {
  std::string link;  ///< as --link takes it: TCP on this computer, with the token that only this user can read
  std::string arm_code;
  std::string workshop;  ///< socket; may be empty
};
/// The one with this memory file; nothing: none is shared now.
[[nodiscard]] std::optional<SharedEmulator> shared_emulator(const std::filesystem::path& memory);

class EmulatorProcess {
 public:
  /// Starts it and waits until it names its link. `link` problem if it does not, with what it said, or where another
  /// program uses the memory file: for five seconds, or until it turns out to share its emulator.
  [[nodiscard]] static Result<std::unique_ptr<EmulatorProcess>> start(const EmulatorOptions& options);
  EmulatorProcess(const EmulatorProcess&) = delete;
  EmulatorProcess& operator=(const EmulatorProcess&) = delete;
  ~EmulatorProcess();  ///< SIGTERM, then SIGKILL after two seconds

  /// Looks whether it still runs; the memory file of one that ended is free for the next.
  [[nodiscard]] bool running();
  [[nodiscard]] const std::string& pty() const { return pty_; }
  [[nodiscard]] const std::string& arm_code() const { return arm_code_; }
  [[nodiscard]] const std::string& workshop() const { return workshop_; }  ///< socket of the workshop; may be empty

 private:
  EmulatorProcess() = default;
  [[nodiscard]] Result<void> launch(const EmulatorOptions& options);
  [[nodiscard]] Result<void> read_greeting();
  [[nodiscard]] Result<void> share(const std::string& second_link) const;

  pid_t child_ = -1;
  int output_ = -1;  ///< its stdout
  int errors_ = -1;  ///< its stderr, an unlinked file
  int lock_ = -1;
  std::filesystem::path shared_in_;  ///< file that tells others where it is; empty: not shared
  std::string pty_;
  std::string workshop_;
  std::string arm_code_;
};

/// The machine file of the emulator that this program started last; nothing: it has started none.
[[nodiscard]] std::optional<std::filesystem::path> emulated_machine();

/// The file of the battery-backed memory of the emulator with this machine, in state_folder().
[[nodiscard]] Result<std::filesystem::path> memory_file_of(const std::filesystem::path& machine);

class WorkshopClient {
 public:
  /// @param cancelled  set by another thread: a request under way ends with a `refused` problem
  WorkshopClient(std::filesystem::path socket, const std::atomic<bool>& cancelled)
      : socket_(std::move(socket)), cancelled_(&cancelled) {}

  /// `link` problem if nobody answers; what the workshop refuses comes back as it says.
  /// @param progress  told how much is done, 0 … 1
  [[nodiscard]] Result<Json> ask(const Json& request, const std::function<void(double)>& progress = {}) const;

 private:
  std::filesystem::path socket_;
  const std::atomic<bool>* cancelled_;
};

}  // namespace ecs::commissioning
