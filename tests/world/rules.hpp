// What must hold in a world, whatever happens in it: only hosts with the code write, commit and move outputs, once and
// in time; the active map is one that was sent; what a host tells of its upload is so, and lasts. Does not live here:
// what happens (world.cpp).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "commissioning/maps/map_in_unit.hpp"
#include "tests/world/world.hpp"

namespace ecs::world {

/// @param hash  of what comes before
[[nodiscard]] std::uint64_t hash_of(std::uint64_t hash, const void* data, std::size_t size);
/// A request without what a repeat of it changes: first register written, registers behind the echo; empty: it writes
/// no block.
[[nodiscard]] Bytes meaning_of(std::span<const std::uint8_t> pdu);
[[nodiscard]] bool holds(const std::string& text, std::string_view part);

/// The report of a world while it goes on, and the lines for whoever listens.
class Record {
 public:
  Record(const Schedule& schedule, std::function<void(const std::string&)> say);
  template <class... Words>
  void say(fmt::format_string<Words...> format, Words&&... words) {
    if (say_) say_(fmt::format("{:10.4f} {}", seconds(), fmt::format(format, std::forward<Words>(words)...)));
  }
  template <class... Words>
  void violated(fmt::format_string<Words...> format, Words&&... words) {
    report.violations.push_back(fmt::format(format, std::forward<Words>(words)...));
    say("VIOLATION {}", report.violations.back());
  }
  void reached(Sometimes state) { ++report.reached[static_cast<std::size_t>(state)]; }
  void trace(const void* data, std::size_t size) { report.trace = hash_of(report.trace, data, size); }
  [[nodiscard]] bool is_heard() const { return static_cast<bool>(say_); }
  /// Of the virtual clock, since the world began.
  [[nodiscard]] double seconds() const;

  Report report;

 private:
  const Schedule& schedule_;
  std::function<void(const std::string&)> say_;
};

/// One `ecs map send`, as it goes on.
struct Attempt {
  std::string host;       ///< its name
  Time begun{};           ///< of the program
  Time answered_since{};  ///< nothing is known from before
  std::size_t image = 0;
  bool sends = false;  ///< it is under way
  bool staging = false, commit_sent = false, armed_in_it = false, settles = false;
};

class Rules {
 public:
  /// @param images  that hosts send, by their numbers  @param lying_disk  what was told need not last
  Rules(Record& record, const Schedule& schedule, Place& place, std::span<const Bytes> images, bool lying_disk);

  /// A host with the code has sent this request.
  void meant(const Bytes& pdu);
  /// This request is with the unit; what is carried out now is carried out for it.
  void arrives(const Bytes& pdu);
  void before_command(const protocol::Command& command);
  void after_command(const protocol::Command& command, const protocol::CommandResult& result);
  void before_write(Address address, std::span<const std::uint8_t> bytes);
  void unit_started();
  void look_at_map();
  void look_at_outputs();
  void begins(const Attempt& attempt);
  /// @param others  attempts of other hosts that are under way
  void ends(const Attempt& attempt, const Result<commissioning::SentMap>& sent, bool cancelled,
            std::span<const Attempt* const> others);

 private:
  /// The map that was active from then on.
  struct Held {
    Time since{};
    std::optional<std::size_t> image;  ///< nothing: none, or a torn one that the unit refuses
    std::uint32_t commit = 0;
  };
  /// Told to the user at the end of an attempt: that map is not active, and will not become so by this attempt.
  struct NotTaken {
    Time since{};
    std::size_t image = 0;
    bool over = false;  ///< somebody has begun to send the same map
  };
  [[nodiscard]] bool was_held(Time from, Time to, const std::function<bool(const Held&)>& held) const;

  Record& record_;
  const Schedule& schedule_;
  Place& place_;
  std::span<const Bytes> images_;
  bool lying_disk_;
  std::map<std::uint64_t, Time> meant_at_;  ///< requests of hosts that know the code, first time
  std::uint64_t meaning_ = 0;               ///< of the request that is with the unit
  std::set<std::pair<std::uint32_t, std::uint32_t>> carried_out_;
  std::set<std::uint64_t> carried_out_meanings_;
  Time stopped_{};  ///< when something was switched off last
  Time opened_{};   ///< when every relay was opened last
  Time output_asked_{};
  emulator::Drives drives_{};
  std::vector<Held> held_;
  std::vector<NotTaken> not_taken_;
  std::uint32_t promised_ = 0;  ///< commit that some host was told to be active
  std::optional<std::uint64_t> seen_version_;
};

}  // namespace ecs::world
