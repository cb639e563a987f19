// The logbooks of this computer on a screen: which there are, their entries, one of them whole, what a check says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "commissioning/logbook/replay.hpp"
#include "commissioning/logbook/store.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

class LogbookController {
 public:
  /// @param run  a verb done again, for replay
  explicit LogbookController(RunVerb run);

  /// Logbooks there are, the one written last first.
  [[nodiscard]] const std::vector<std::filesystem::path>& books() const { return books_; }
  /// Of the one that is open; empty: none.
  [[nodiscard]] std::string book() const { return books_.empty() ? "" : books_[at_].string(); }
  /// Whose it is, in words.
  [[nodiscard]] const std::string& owner() const { return owner_; }
  /// Without their content, the newest last.
  [[nodiscard]] const std::vector<LogbookEntry>& entries() const { return entries_; }
  /// Why there is nothing to show; empty: there is.
  [[nodiscard]] const std::string& absent() const { return absent_; }

  void open_next();
  /// Lines of one entry whole.
  [[nodiscard]] std::vector<std::string> lines_of(std::int64_t number) const;
  /// Every entry against its hash and the one before, beside the screen.
  void verify();
  /// The active map derived again, beside the screen.
  void replay();
  [[nodiscard]] const std::vector<std::string>& answer() const { return answer_; }
  void forget_answer() { answer_.clear(); }
  [[nodiscard]] bool running() const { return task_.running(); }
  [[nodiscard]] const std::string& doing() const { return task_.label(); }
  [[nodiscard]] const Message& message() const { return message_; }
  /// Takes results, and entries that were added. @return whether the picture changed
  bool advance();

 private:
  struct Found {
    std::vector<std::string> lines;
    std::string sentence;
    bool good = false;
  };
  void look();
  void read();
  void take(Found found);

  RunVerb run_;
  std::vector<std::filesystem::path> books_;
  std::size_t at_ = 0;
  std::string owner_, absent_;
  std::vector<LogbookEntry> entries_;
  std::filesystem::file_time_type seen_{};
  std::vector<std::string> answer_;
  Message message_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
