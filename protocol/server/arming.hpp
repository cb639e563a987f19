// Which hosts may write: those that knew the unit's code, for as long as they asked for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "protocol/server/host_sessions.hpp"

namespace ecs::protocol {

/// Hosts armed at one time; one more, and the one whose time ends first gives way.
inline constexpr std::size_t kArmedHosts = 8;
/// After the n-th wrong code in a row no code is looked at for 2^(n-1) s, at most so long.
inline constexpr std::uint16_t kLongestWait_s = 60;

/// A host whose time has ended.
struct ArmingEnd {
  SessionOpen host;
  std::uint64_t at_ms = 0;  ///< of the unit's clock
};

class Arming {
 public:
  /// @param code  that the unit shows; empty: every host is armed
  explicit Arming(std::string code) : code_(std::move(code)) {}

  /// The answer to the command `arm`. Minutes 0 ends what the host had, and needs no code.
  [[nodiscard]] CommandResult arm(const Command& command, const HostSession& session, std::uint64_t now_ms);
  /// The host is armed for so long yet; 0: it is not.
  [[nodiscard]] std::uint32_t left_s(const HostSession& session, std::uint64_t now_ms) const;
  /// Before another code is looked at.
  [[nodiscard]] std::uint16_t wait_s(std::uint64_t now_ms) const;
  /// A host whose time has ended since this was last asked; each is reported once; a host that ended it itself is not.
  [[nodiscard]] std::optional<ArmingEnd> take_ended(std::uint64_t now_ms);
  /// At a start of the unit: nobody is armed, and wrong codes are forgotten.
  void begin_again();

 private:
  struct Armed {
    SessionOpen host;
    std::uint64_t until_ms = 0;  ///< 0: free
  };
  std::string code_;
  std::array<Armed, kArmedHosts> armed_{};
  unsigned wrong_in_a_row_ = 0;
  std::uint64_t closed_until_ms_ = 0;
};

}  // namespace ecs::protocol
