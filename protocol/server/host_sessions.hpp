// The hosts that a unit knows, each with the result of its newest command.
// Does not live here: what a command does (register_server.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

struct HostSession {
  std::uint32_t id = 0;  ///< by chance; 0: free
  SessionOpen host;
  CommandResult result;  ///< of its newest command; sequence 0: none yet
  std::uint64_t used = 0;
};

/// Sessions that the unit remembers; one more, and the one used least lately is forgotten.
inline constexpr std::size_t kSessions = 16;

class HostSessions {
 public:
  /// The session of that key and number, else a new one.
  HostSession& open(const SessionOpen& host);
  /// Null: unknown. The session counts as used.
  [[nodiscard]] HostSession* find(std::uint32_t id);
  void forget_all() { sessions_ = {}; }

 private:
  std::array<HostSession, kSessions> sessions_{};
  std::uint64_t uses_ = 0;
};

/// A number by chance that is neither 0 nor `other`.
[[nodiscard]] std::uint32_t number_by_chance(std::uint32_t other = 0);

}  // namespace ecs::protocol
