// The hosts that a unit knows: each with the result of its newest command, which of them may write (those that knew the
// unit's code, for as long as they asked for), and what they did to the unit, or tried.
// Does not live here: what a command does (register_server.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
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

/// At most kKeptEvents.
class EventList {
 public:
  /// Adds an event, or counts it to the newest one where that is the same but for its time. @return its number
  std::uint32_t add(HostEvent event);
  /// A command that was under way has ended so.
  void settle(std::uint32_t number, CommandState state, UnitError error);
  /// From this number on, or from the oldest that is kept.
  [[nodiscard]] EventPage page(std::uint32_t first) const;

 private:
  std::deque<HostEvent> events_;
  std::uint32_t newest_ = 0;
};

/// The arguments of a command in a few words, at most kEventTextBytes.
[[nodiscard]] std::string arguments_in_words(const Command& command);
[[nodiscard]] std::string stretch_in_words(Address address, std::uint32_t bytes);

}  // namespace ecs::protocol
