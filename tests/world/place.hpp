// The unit's end of a world: the unit with its register server, the disk that its battery lies on, and who has a look
// at every command and every write before they are carried out. Does not live here: the line (line.hpp), what is judged
// (rules.hpp).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "base/file.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "protocol/server/register_server.hpp"
#include "tests/world/schedule.hpp"

namespace ecs::world {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

/// Function code and data of a request, carried out; empty: no answer.
[[nodiscard]] Bytes answered(std::span<const std::uint8_t> pdu, protocol::RegisterHandler& handler);

/// One file on a disk. Its content lasts as soon as it is written, its name only once the folder is written as well. A
/// loss of power takes the file back to the one before if its name does not last, or leaves it as it was; a disk that
/// lies about what it has written can leave it mixed of both.
class Disk final : public FileWatch {
 public:
  bool lies = false;
  int writes_fail = 0;  ///< this many writes from now on
  int names_fail = 0;
  /// The process has ended after this many writes of content or name: what follows is not done. Nothing: it lives.
  std::optional<int> ends_after;
  [[nodiscard]] bool process_ended() const { return ends_after && *ends_after < 0; }

  /// True: the file is the one before.
  bool lose_power(Random& random);
  void remove() { now_.reset(), lasting_.reset(); }
  [[nodiscard]] bool torn() const { return torn_; }

  [[nodiscard]] bool replaces_disc() const override { return true; }
  [[nodiscard]] Result<std::string> content(const std::filesystem::path& path) override;
  [[nodiscard]] Result<void> may_write(const std::filesystem::path& path) override;
  [[nodiscard]] Result<void> keeps_name(const std::filesystem::path& path) override;
  void was_read(const std::filesystem::path&, std::string_view) override {}
  void was_written(const std::filesystem::path& path, std::string_view content) override;

 private:
  [[nodiscard]] bool process_goes_on();
  std::optional<std::string> now_;
  std::optional<std::string> lasting_;  ///< what a loss of power leaves at least
  bool torn_ = false;
};

/// What the world wants to see, and may change, of what the unit is asked for.
struct Looks {
  std::function<void(const protocol::Command&)> before_command;
  std::function<void(const protocol::Command&, const protocol::CommandResult&)> after_command;
  std::function<void(Address, std::span<const std::uint8_t>)> before_write;
  std::function<void()> before_keep;  ///< of a commit
};

/// A break of the unit that a world must find.
enum class UnitBreak : std::uint8_t {
  none,
  commits_unchecked,  ///< whatever is staged becomes active
  answers_unkept,     ///< a commit is answered before the battery is written
};

class Place {
 public:
  /// @param automatic  the unit waits for a host at its start, and compensates without one
  Place(Schedule& schedule, Random& random, Looks looks, UnitBreak broken, std::string code, bool automatic);
  ~Place();

  Disk disk;
  [[nodiscard]] emulator::Unit& unit() { return *unit_; }
  [[nodiscard]] bool running() const { return unit_ != nullptr && unit_->powered(); }
  [[nodiscard]] bool process_runs() const { return unit_ != nullptr; }
  /// The active image, whole; empty: the unit names none.
  [[nodiscard]] Bytes active() const;
  [[nodiscard]] std::uint32_t commit() const;
  /// Of all that the unit keeps; another number: it may have changed.
  [[nodiscard]] std::uint64_t version() const;
  /// Open without a supply, also between two periods.
  [[nodiscard]] emulator::Drives drives() const { return running() ? drives_ : emulator::Drives{}; }
  /// Every period up to now has passed.
  void catch_up();

  /// Carries out what has arrived whole. Empty: no answer.
  [[nodiscard]] Bytes take(std::span<const std::uint8_t> pdu, std::uint64_t connection, const std::string& origin);

  void supply(bool on);
  void keep_battery();
  /// kill -9 of the emulator, or the power of its computer. True: that took back the battery file.
  bool end_process(bool power);
  /// False: it refuses the battery file, and begins with a new one.
  bool start_process();

 private:
  class Port;
  Schedule& schedule_;
  Random& random_;
  Looks looks_;
  UnitBreak broken_;
  std::string code_;
  bool automatic_;
  std::unique_ptr<emulator::Unit> unit_;
  std::unique_ptr<Port> port_;
  std::unique_ptr<protocol::RegisterServer> server_;
  emulator::Drives drives_{};
  Time on_since_{};
  std::uint64_t periods_ = 0;
  double passed_s_ = 0.0;
  Time kept_{};
};

}  // namespace ecs::world
