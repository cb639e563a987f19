// DISPLAY ECS STATUS: the unit's state, read again and again, or one out of a file; memory test, fault, mode.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "commissioning/unit/status.hpp"

namespace ecs::commissioning {

/// What a mode is, in one sentence.
[[nodiscard]] std::string_view meaning_of(UnitMode mode);

/// A status file, or a memory dump with what it says.
struct StatusFile {
  std::string name;
  std::optional<StatusSnapshot> snapshot;  ///< a dump may have none
  std::vector<std::string> memory;         ///< lines of a dump; empty: a status file
};
/// By its first bytes: a status file (JSON), else a memory dump.
[[nodiscard]] Result<StatusFile> read_status_file(const std::string& path);

class StatusController {
 public:
  explicit StatusController(std::shared_ptr<UnitConnection> connection);

  // --- what is shown
  [[nodiscard]] const StatusSnapshot* snapshot() const;  ///< of the file while one is open, else of the unit
  [[nodiscard]] const StatusFile* file() const { return file_ ? &*file_ : nullptr; }
  void open(const std::string& path);
  void close_file() { file_.reset(); }
  [[nodiscard]] std::optional<double> age_s() const;  ///< of the unit's snapshot
  [[nodiscard]] std::string lack() const;             ///< why none comes; empty: they come
  [[nodiscard]] bool emulator() const { return watched_.emulator; }

  // --- what is done; nothing while a file is shown or something is under way
  [[nodiscard]] bool may_act();     ///< says why not
  [[nodiscard]] bool may_change();  ///< the unit is in integration mode; says why not. @pre may_act()
  void test_memory();
  [[nodiscard]] Question clear_question() const;
  void clear_fault();
  [[nodiscard]] Question mode_question() const;  ///< to the other mode
  void change_mode();
  /// The bundled emulator's machine references all its axes.
  void reference();
  void save(const std::string& path);
  [[nodiscard]] static std::string proposed_name();
  void cancel();
  [[nodiscard]] bool busy() const { return work_.running(); }
  [[nodiscard]] const std::string& working_on() const { return work_.label(); }
  [[nodiscard]] double part() const { return work_.part(); }

  [[nodiscard]] bool advance();
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Read {
    StatusSnapshot snapshot;
    std::string workshop;
  };
  /// @param words  of the command that does the same
  void start(std::string working_on, std::vector<std::string> words,
             std::function<Result<std::string>(UnitLink&, JobControl&)> work);
  void start_reading();
  void take(Result<Read> read);
  void say_done(const Result<std::string>& done, bool given_up);
  [[nodiscard]] bool integrating() const;

  std::shared_ptr<UnitConnection> connection_;
  WatchedUnit watched_;
  std::uint64_t changes_ = 0;
  std::optional<Read> read_;
  Clock::time_point read_at_{};
  Clock::time_point asked_at_{};
  Clock::duration took_{};
  int shown_age_ = 0;
  bool at_once_ = true;  ///< the next reading comes without waiting
  std::string problem_;
  std::optional<StatusFile> file_;
  std::string opened_;  ///< path of `file_`
  Message message_;
  TaskRunner reference_;
  TaskRunner work_;
  TaskRunner reading_;
  TaskRunner opening_;
  TaskRunner writing_;
};

}  // namespace ecs::commissioning
