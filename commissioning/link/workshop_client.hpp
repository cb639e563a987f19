// Requests to a running workshop (docs/emulator.md): one JSON object on one line of a Unix socket, its answer on
// another. For .cpp files only (heavy header). Does not live here: what is asked for (socket_workshop.hpp).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "base/json.hpp"
#include "base/result.hpp"

namespace ecs::commissioning {

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
