// The memory that one looks at: a unit's, read page by page as it is needed, or a dump's. Where the cursor is, what
// is sought, compared, written and taken back.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/memory/bytes.hpp"
#include "commissioning/memory/compare.hpp"
#include "commissioning/memory/names.hpp"
#include "commissioning/memory/write.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

class MemoryController {
 public:
  explicit MemoryController(std::shared_ptr<UnitConnection> unit);
  MemoryController(const MemoryController&) = delete;
  MemoryController& operator=(const MemoryController&) = delete;

  /// Takes what has come and begins what is needed next. @return whether anything changed
  [[nodiscard]] bool advance(const Stretch& shown);
  /// Of what this is: "unit MCM-0107 (EMULATOR)", "file unit.ecsdump".
  [[nodiscard]] std::string source() const;
  [[nodiscard]] bool is_file() const { return !file_.empty(); }
  /// Nothing can be shown yet: no unit has answered.
  [[nodiscard]] bool is_empty() const { return memory_.regions().empty(); }
  [[nodiscard]] const MemoryBytes& memory() const { return memory_; }
  [[nodiscard]] const MemoryNames& names() const { return names_; }
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

  // --- where
  [[nodiscard]] Address cursor() const { return cursor_; }
  /// To the nearest address that exists.
  void go(Address address);
  /// So many bytes on; from the end of a region into the next.
  void move(long long bytes);

  // --- reading
  void read_again(const Stretch& shown);
  void read_region();

  // --- finding
  void seek(const std::string& typed);
  void seek_on();

  // --- comparing
  void compare_with(const std::string& path);
  void end_comparison();
  [[nodiscard]] bool compares() const { return other_.has_value(); }
  /// Without its folder.
  [[nodiscard]] std::string compared_file() const;
  [[nodiscard]] bool differs(Address address) const { return other_ && differ_at(memory_, *other_, address); }
  [[nodiscard]] const std::vector<DifferenceRow>& differences() const { return differences_; }
  void to_next_difference();

  // --- writing: proposed, asked, then done or left
  /// Whether the byte under the cursor may be written; says why not.
  [[nodiscard]] bool lets_write();
  void propose(const std::string& typed);
  void propose_undo();
  [[nodiscard]] Asking& asking() { return asking_; }
  [[nodiscard]] const Asking& asking() const { return asking_; }
  [[nodiscard]] const std::vector<ByteWrite>& written() const { return written_; }

  // --- files
  void open(const std::string& path);  ///< empty or "unit": the unit
  /// Asks first where the file exists.
  void save(const std::string& path, DumpScope scope);

  // --- long work
  /// Empty: nothing that is worth telling.
  [[nodiscard]] std::string working_on() const;
  [[nodiscard]] double part() const;
  [[nodiscard]] double seconds_left() const;  ///< negative: unknown
  void cancel();

 private:
  struct Search {
    std::vector<std::uint8_t> pattern;
    std::string typed;
    Address from = 0;
    Address at = 0;  ///< how far it is read
  };

  [[nodiscard]] bool follow_unit();
  void start_needed(const Stretch& shown);
  [[nodiscard]] Stretch needed(const Stretch& shown) const;
  void read(const Stretch& stretch);
  void landed(const Stretch& stretch, const Result<std::vector<std::uint8_t>>& bytes);
  /// Ends what runs for a task in front, unless there is one already; says so.
  [[nodiscard]] bool gives_way();
  void step_search();
  void decode_again();
  void compare_again();
  void ask(Question question, std::function<void()> on_yes);
  void ask_to_write(ByteWrite write, bool undo);
  void write(const ByteWrite& write, bool undo);
  void landed_write(const ByteWrite& write, bool undo, const Result<void>& done);
  void save_now(const std::string& path, DumpScope scope);
  void show_dump(const std::string& path, const MemoryDump& dump);

  std::shared_ptr<UnitConnection> unit_;
  MemoryBytes memory_;
  MemoryNames names_;
  std::string file_;           ///< empty: the unit
  std::string file_detail_;    ///< whose dump it is and when it was taken
  std::string serial_number_;  ///< of the unit shown; empty: none yet
  std::string written_in_;     ///< serial number of the unit that was written into
  std::chrono::steady_clock::time_point opened_at_{};
  Address cursor_ = kBankA.first;

  std::optional<Address> filling_;  ///< a region that is read whole
  std::optional<Search> search_;    ///< under way
  std::string sought_;
  std::optional<MemoryBytes> other_;
  MemoryNames other_names_;
  std::string other_file_;
  std::vector<DifferenceRow> differences_;
  std::vector<ByteWrite> written_;

  Asking asking_;
  Message message_;
  double part_begun_ = 0.0;
  std::chrono::steady_clock::time_point begun_{};
  std::chrono::steady_clock::time_point not_before_{};  ///< the next try after a failed read
  bool read_failed_ = false;
  TaskRunner pages_;
  TaskRunner task_;  ///< the work in front
};

}  // namespace ecs::commissioning
