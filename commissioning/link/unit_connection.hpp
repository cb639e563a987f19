// The link to the unit that all screens share: opened at the start, opened again when it was lost, looked at beside
// the screens; work on it is done one piece after the other. A bundled emulator runs as long as the connection.
// Its threads are its own and no TaskRunner's: they watch as long as the connection lives and have no result.
// Actions on the unit are noted as the commands that do the same (commissioning/session/commands.hpp).
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/task_runner.hpp"
#include "core/parameters.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// What is known at one moment.
struct WatchedUnit {
  std::string link;   ///< as --link takes it; empty: none was opened yet
  std::string where;  ///< port or host that the link uses; empty: none
  bool open = false;
  bool emulator = false;
  std::string workshop;                               ///< socket of the emulator's workshop; empty: none
  bool lent = false;                                  ///< a verb has the link
  bool wants_code = false;                            ///< the unit has refused something: this host is not armed
  std::optional<protocol::Identity> identity;         ///< of the unit that answered last
  std::chrono::steady_clock::time_point newest_at{};  ///< when the newest sample came
  std::chrono::steady_clock::time_point opened_at{};  ///< when the link was opened
  std::uint64_t received = 0;                         ///< samples
  std::uint64_t failed = 0;                           ///< looks that brought none
  std::uint64_t times_lost = 0;                       ///< links that had to be opened again
  double per_second = 0.0;                            ///< samples, over the last two seconds
  MeasurementSystem measurement_system = MeasurementSystem::metric;  ///< of its parameters; without any: metric
  protocol::LinkStatistics statistics;                               ///< of the open link
  std::string problem;                                               ///< why there is no link now; empty: there is one
};

/// With what was sampled.
struct SampledUnit : WatchedUnit {
  std::deque<protocol::MonitorSample> samples;        ///< oldest first, at most kKept
  std::optional<protocol::LiveInputs> inputs;         ///< read every few seconds while somebody watches
  std::optional<protocol::ControlLines> lines;        ///< the same; nothing: the unit has none (firmware before 1.1)
  protocol::RotarySample rotary;                      ///< no axis: the unit has none; else as new as the samples
  std::chrono::steady_clock::time_point inputs_at{};  ///< when both were read
};

class UnitConnection {
 public:
  static constexpr std::size_t kKept = 1200;
  /// @param link  --link as given; empty: the stored one, else the emulator
  explicit UnitConnection(std::string link);
  ~UnitConnection();
  UnitConnection(const UnitConnection&) = delete;
  UnitConnection& operator=(const UnitConnection&) = delete;

  [[nodiscard]] SampledUnit now() const;
  /// Without the samples: cheap, for every picture.
  [[nodiscard]] WatchedUnit snapshot() const;
  /// The newest sample, if one came from the link that is open.
  [[nodiscard]] std::optional<protocol::MonitorSample> newest() const;
  /// Counts up with every change: a screen draws only then.
  [[nodiscard]] std::uint64_t changes() const { return changes_.load(); }

  /// As --link takes it; empty: the stored one, else the emulator.
  [[nodiscard]] std::string link() const;
  /// From now on another link; the link that is open is closed.
  void choose(const std::string& link);

  /// From now on this code is shown to the unit where something needs it; empty: none is known.
  void know_code(const std::string& code);

  /// Does `work(UnitLink&)`, which returns a Result, with the link to itself; for the thread of a task, whose cancel
  /// ends what is under way. Opens the link first where there is none. Refused if another unit answers than the one
  /// that is shown: it is shown from then on.
  template <class Work>
  [[nodiscard]] auto with_link(JobControl& control, Work work) -> decltype(work(std::declval<UnitLink&>())) {
    const Turn turn(*this, control);
    if (!turn.has_link()) return tl::unexpected(link_was_busy());
    const auto shown = snapshot().identity;
    ECS_DO(opened());
    ECS_DO(same_unit(shown));
    auto result = work(*unit_link_);
    next_inputs_ = {};
    settle();
    return result;
  }
  /// The same, whichever unit answers: to switch everything off.
  template <class Work>
  [[nodiscard]] auto with_link_to_any_unit(JobControl& control, Work work)
      -> decltype(work(std::declval<UnitLink&>())) {
    const Turn turn(*this, control);
    if (!turn.has_link()) return tl::unexpected(link_was_busy());
    ECS_DO(opened());
    auto result = work(*unit_link_);
    next_inputs_ = {};
    settle();
    return result;
  }

  /// Closes the link and keeps hands off it as long as the token lives, so that a verb can open it on its own.
  class Lent {
   public:
    explicit Lent(UnitConnection& connection);
    ~Lent();
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;

   private:
    UnitConnection* connection_;
    std::unique_lock<std::mutex> link_lock_;
  };
  [[nodiscard]] Lent lend() { return Lent(*this); }

  /// While a token lives, samples come as fast as the link carries them (at most forty a second), else one a second.
  /// With every new token the measurement system of the unit's parameters is read.
  class Watching {
   public:
    explicit Watching(std::shared_ptr<UnitConnection> connection) : connection_(std::move(connection)) {
      connection_->wants_system_ = true;
      ++connection_->watchers_;
    }
    ~Watching() { --connection_->watchers_; }
    Watching(const Watching&) = delete;
    Watching& operator=(const Watching&) = delete;

   private:
    std::shared_ptr<UnitConnection> connection_;
  };

 private:
  /// The link to oneself, before the next look at the unit; `control` can cancel, also while other work has the link.
  class Turn {
   public:
    Turn(UnitConnection& connection, JobControl& control);
    ~Turn();
    /// False: cancelled before the link was free.
    [[nodiscard]] bool has_link() const { return link_lock_.owns_lock(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    UnitConnection* connection_;
    std::unique_lock<std::mutex> link_lock_;
  };

  [[nodiscard]] static Problem link_was_busy();
  void run(const std::stop_token& stop);
  void look();
  void look_at_inputs();
  void look_at_rotary();
  void look_at_measurement_system();
  [[nodiscard]] Result<void> opened();
  [[nodiscard]] Result<void> same_unit(const std::optional<protocol::Identity>& shown);
  void close();
  void settle();
  void take(const protocol::MonitorSample& sample);
  void lost(const Problem& why);

  mutable std::mutex mutex_;  ///< of what is known
  SampledUnit state_;
  std::string link_;
  std::string arm_code_;  ///< as typed; empty: none
  std::deque<std::chrono::steady_clock::time_point> arrivals_;
  std::atomic<std::uint64_t> changes_{0};

  std::mutex link_mutex_;  ///< of the link; taken before mutex_
  std::optional<UnitLink> unit_link_;
  std::shared_ptr<EmulatorProcess> emulator_;  ///< kept while the link is closed
  int failures_ = 0;                           ///< looks in a row that brought nothing
  std::chrono::steady_clock::time_point next_try_{};
  std::chrono::steady_clock::time_point next_inputs_{};  ///< at once after every piece of work, which may change them

  std::atomic<int> waiting_{0};  ///< pieces of work that want the link
  std::atomic<int> watchers_{0};
  std::atomic<bool> wants_system_{false};  ///< the measurement system is to be read
  std::mutex control_mutex_;
  JobControl* control_ = nullptr;  ///< of the work on the link
  std::atomic<bool> cancelled_{false};
  std::atomic<bool> leaving_{false};
  std::jthread guard_;  ///< carries a cancel over to the link
  std::jthread thread_;
};

/// Shows a transfer in the progress of the task that it is part of.
[[nodiscard]] protocol::ProgressCallback progress_into(JobControl& control);

/// The words with the --link that reaches this unit, "ecs" in front of them.
[[nodiscard]] std::vector<std::string> words_on_unit(const UnitConnection& unit, std::vector<std::string> words);
/// Notes them.
void note_on_unit(const UnitConnection& unit, std::vector<std::string> words, int exit_code = 0);

/// A verb that was run from a form, with the words of the form: over the link of the screens where it names that one or
/// none.
void note_form(const UnitConnection& unit, std::vector<std::string> words, int exit_code);

}  // namespace ecs::commissioning
