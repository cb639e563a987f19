// The hosts that a unit knows: each with the result of its newest command, which of them may write (those that knew the
// unit's code, for as long as they asked for), and what they did to the unit, or tried.
// Does not live here: what a command does (register_server.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// An exchange of keys that waits for the host's confirmation: what it will have to be, and what follows from it.
struct ArmExchange {
  Confirmation expected{};
  Secret secret{};
  ArmAnswer if_right;
};

struct HostSession {
  std::uint32_t id = 0;     ///< by chance; 0: free
  std::uint64_t nonce = 0;  ///< by chance
  SessionOpen host;
  std::string origin;        ///< that opened it first
  CommandResult result;      ///< of its newest command; sequence 0: none yet
  std::uint32_t window = 0;  ///< number of the last window that it opened
  std::optional<ArmExchange> exchange;
  ArmAnswer arming;     ///< the last answer
  bool proved = false;  ///< what came in it was sealed with its key
  bool keyed = false;   ///< that, and its host is armed yet
  std::uint64_t used = 0;
};

/// Sessions that the unit remembers; one more, and of the origin that has most of them the one used least lately is
/// forgotten, but none of those that armed hosts have used last.
inline constexpr std::size_t kSessions = 32;
inline constexpr std::size_t kKeptForArmed = kSessions / 2;

class HostSessions {
 public:
  /// The session of that key and number, else a new one.
  HostSession& open(const SessionOpen& host, const std::string& origin);
  /// Null: unknown. The session counts as used.
  [[nodiscard]] HostSession* find(std::uint32_t id);
  [[nodiscard]] std::array<HostSession, kSessions>& all() { return sessions_; }
  void forget_all() { sessions_ = {}; }

 private:
  [[nodiscard]] HostSession* next_to_go();
  std::array<HostSession, kSessions> sessions_{};
  std::uint64_t uses_ = 0;
};

/// A number by chance that is neither 0 nor `other`.
[[nodiscard]] std::uint32_t number_by_chance(std::uint32_t other = 0);

/// Hosts armed at one time; one more, and the one whose time ends first gives way.
inline constexpr std::size_t kArmedHosts = 8;
/// After the n-th wrong code in a row from one origin no code from there is looked at for 2^(n-1) s, at most so long.
inline constexpr std::uint16_t kLongestWait_s = 60;
/// Exchanges that the unit carries out for one origin at once, and in a second: each takes its loop a tenth of a
/// millisecond.
inline constexpr double kMostExchanges = 8.0;
inline constexpr double kExchangesASecond = 10.0;
/// Origins whose wrong codes are remembered; one more, and the one whose wait ends first is forgotten.
inline constexpr std::size_t kOrigins = 64;
/// After so many wrong codes in all the unit shows another code; with a fixed one it looks at one code a minute.
inline constexpr unsigned kMostWrongCodes = 100;

/// That the unit shows.
struct ArmCode {
  std::string code;    ///< empty: it shows none, the empty code arms
  bool fixed = false;  ///< chosen by its owner: the unit never changes it
};

/// A host whose time has ended.
struct ArmingEnd {
  SessionOpen host;
  std::uint64_t at_ms = 0;  ///< of the unit's clock
};

class Arming {
 public:
  explicit Arming(ArmCode code) : code_(std::move(code)) {}

  /// The unit's half of an exchange with that session's host. Nothing is known of the code by it.
  /// @param origin  where it came from: a TCP peer's address, or the serial line
  [[nodiscard]] ArmAnswer begin(const ArmShare& arm, HostSession& session, std::string_view serial_number,
                                const std::string& origin, std::uint64_t now_ms);
  /// A guess: ends the exchange. The same confirmation again gets the same answer.
  [[nodiscard]] ArmAnswer confirm(const ArmConfirm& arm, HostSession& session, const std::string& origin,
                                  std::uint64_t now_ms);
  void disarm(const HostSession& session);
  /// The host is armed for so long yet; 0: it is not.
  [[nodiscard]] std::uint32_t left_s(const HostSession& session, std::uint64_t now_ms) const;
  /// The key of that session; nothing: its host is not armed.
  [[nodiscard]] std::optional<Secret> key_of(const HostSession& session, std::uint64_t now_ms) const;
  [[nodiscard]] bool needs_code() const { return !code_.code.empty(); }
  /// Before another code from there is looked at.
  [[nodiscard]] std::uint16_t wait_s(const std::string& origin, std::uint64_t now_ms) const;
  /// A host whose time has ended since this was last asked; each is reported once; a host that ended it itself is not.
  [[nodiscard]] std::optional<ArmingEnd> take_ended(std::uint64_t now_ms);
  /// The code that the unit shows from now on, once after each change.
  [[nodiscard]] std::optional<std::string> take_new_code();
  /// At a start of the unit: nobody is armed, and wrong codes are forgotten.
  void begin_again();

 private:
  struct Armed {
    SessionOpen host;
    Secret secret{};
    std::uint64_t until_ms = 0;  ///< 0: free
  };
  struct Origin {
    unsigned wrong_in_a_row = 0;
    std::uint64_t until_ms = 0;
    double exchanges_left = kMostExchanges;
    std::uint64_t counted_ms = 0;
  };
  [[nodiscard]] Origin& origin_of(const std::string& origin);
  [[nodiscard]] bool may_exchange(const std::string& origin, std::uint64_t now_ms);
  void count_wrong(const std::string& origin, std::uint64_t now_ms);
  ArmCode code_;
  std::array<Armed, kArmedHosts> armed_{};
  std::map<std::string, Origin> origins_;
  unsigned wrong_in_all_ = 0;
  std::uint64_t all_closed_until_ms_ = 0;
  bool code_changed_ = false;
};

/// At most kKeptEvents, of these at most kKeptOfStrangers of hosts that were not armed: these wash nothing else away.
class EventList {
 public:
  /// Adds an event, or counts it to the newest one of its kind where that is the same but for its time.
  /// @param armed  its host was armed, or the unit itself did it
  /// @return its number
  std::uint32_t add(HostEvent event, bool armed);
  /// A command that was under way has ended so.
  void settle(std::uint32_t number, CommandState state, UnitError error);
  /// From this number on, or from the oldest that is kept.
  [[nodiscard]] EventPage page(std::uint32_t first) const;

 private:
  struct Kept {
    HostEvent event;
    bool armed = false;
  };
  std::deque<Kept> events_;
  std::uint32_t newest_ = 0;
};

/// The arguments of a command in a few words, at most kEventTextBytes.
[[nodiscard]] std::string arguments_in_words(const Command& command);
[[nodiscard]] std::string minutes_in_words(std::uint32_t seconds);
[[nodiscard]] std::string stretch_in_words(Address address, std::uint32_t bytes);

}  // namespace ecs::protocol
