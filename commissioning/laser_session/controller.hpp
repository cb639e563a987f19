// What the PROCESS LASER DATA screen works on: the choices with their undo and draft, what follows from them, and the
// work under way. Pure state and actions, no terminal.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/laser_session/work.hpp"
#include "commissioning/maps/unit_work.hpp"
#include "commissioning/session/editor.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::commissioning {

enum class LaserStep { files, lines, leave_out, curves, iso, map, header, send, verify };
inline constexpr int kLaserSteps = 9;

/// How a step stands.
enum class LaserMark {
  open,  ///< nothing there yet
  done,
  doubtful,  ///< something there deserves a look
};

class LaserController {
 public:
  explicit LaserController(std::shared_ptr<UnitConnection> unit);
  ~LaserController();
  LaserController(const LaserController&) = delete;
  LaserController& operator=(const LaserController&) = delete;

  [[nodiscard]] const LaserChoices& choices() const { return edited_.now(); }
  /// Never null; belongs to older choices while working() is true.
  [[nodiscard]] const LaserWork& work() const { return *work_; }
  [[nodiscard]] LaserMark mark(LaserStep step) const;
  [[nodiscard]] const UnitConnection& unit() const { return *unit_; }
  /// Why the parameters belong to another machine than the files; empty: as far as is known they do not.
  [[nodiscard]] const std::string& mismatch() const { return mismatch_; }
  /// The same of the unit: its map would be refused.
  [[nodiscard]] const std::string& other_unit() const { return other_unit_; }

  // --- choices
  /// Keeps the draft, works out what follows. @param what  for undo: "run 3 left out"
  void change(const std::string& what, const std::function<void(LaserChoices&)>& how);
  /// An error map in place of measured files, with the parameters saved beside it.
  /// @param parameters  file of the parameters of the unit; "": those saved with the map, if any
  void open_map(const std::string& file, const std::string& parameters = "");
  void undo();
  void redo();
  /// Of an earlier sitting; nothing: there is none, or it was answered.
  [[nodiscard]] const std::optional<Draft>& offered() const { return offered_; }
  /// Of which machine it is, "moving column mill"; where nothing names one, "files of FOLDER"; empty: not known.
  [[nodiscard]] const std::string& offered_of() const { return offered_of_; }
  /// What became of its map: "saved in map.csv, sent to unit INV-1"; empty: it was not saved.
  [[nodiscard]] const std::string& offered_saved() const { return offered_saved_; }
  void take_up_offered();
  void drop_offered();
  /// New work is started; what was offered is kept and offered again when there is no other.
  void set_offered_aside();
  [[nodiscard]] std::size_t drafts_aside() const { return commissioning::drafts_aside(edited_.draft()); }
  /// The next of several.
  void offer_another();
  /// Everything that the files on disc say now.
  void read_again();

  // --- disc and unit; each tells message()
  void save() { save_and(false); }
  /// Saves, checks here and at the unit; then ready() holds what send() would send.
  void prepare() { save_and(true); }
  [[nodiscard]] const std::optional<ReadyMap>& ready() const { return ready_; }
  void send();
  void not_now() { ready_.reset(); }
  void verify();
  /// Whether it is known that the unit holds the map of the file; says why not.
  [[nodiscard]] bool may_compensate();
  /// Refused, saying why, unless the unit holds the very map that was found the same, or sent from here if nothing was
  /// compared since.
  void compensate();
  /// Every few seconds, while somebody looks at the verdict: whether it still holds of the unit.
  void watch_verdict();
  void receive_parameters(const std::string& file);
  /// Asks what runs on line or disc to stop.
  void cancel() { task_.cancel(); }

  /// Takes what has been finished meanwhile. @return whether anything changed
  [[nodiscard]] bool advance();
  [[nodiscard]] bool working() const { return working_out_.running(); }
  [[nodiscard]] bool busy() const { return task_.running(); }
  [[nodiscard]] const TaskRunner& task() const { return task_; }  ///< on disc or over the link
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

  /// A file of that name stands there that this screen did not write.
  [[nodiscard]] bool would_overwrite() const;
  [[nodiscard]] bool saved() const { return !saved_csv_.empty() && saved_csv_ == work_->map.csv; }
  /// A map was saved, in its present state or another.
  [[nodiscard]] bool has_saved() const { return !saved_file_.empty(); }
  [[nodiscard]] const std::optional<SentMap>& sent() const { return sent_; }
  /// The unit to which the saved map was sent before this work was continued; empty: to none, as far as is known.
  [[nodiscard]] const std::string& sent_earlier() const { return sent_earlier_; }
  [[nodiscard]] bool sent_is_current() const { return sent_ && sent_csv_ == work_->map.csv; }
  /// Null: nothing was compared.
  [[nodiscard]] const MapVerdict* verdict() const { return found_ ? &found_->verdict : nullptr; }
  /// What was compared, with the unit that held it. @pre verdict()
  [[nodiscard]] const UnitHolding& compared() const { return found_->holding; }
  /// Why the verdict holds no longer: the unit was restarted, given another map, ...; empty: it holds.
  [[nodiscard]] const std::string& stale() const { return stale_; }
  /// The unit holds the map of the choices as they are now.
  [[nodiscard]] bool verified() const {
    return found_ && found_->verdict.same() && stale_.empty() && compared_csv_ == work_->map.csv;
  }
  /// What stands in the unit after sending failed, in words; empty: nothing failed, or not known yet.
  [[nodiscard]] const std::string& after_failure() const { return after_failure_; }
  [[nodiscard]] std::string unsaved() const;

 private:
  void stepped(const char* how, const std::optional<std::string>& what, const char* nothing);
  void work_out();
  void keep();
  /// With what became of the map. @param saved  empty: it was not saved with these choices
  void keep_as(const std::string& saved);
  [[nodiscard]] bool idle();
  [[nodiscard]] bool can_save();
  void save_and(bool check);
  /// @param choices, lines  as they were then
  void take_saved(const SavedMap& saved, const LaserChoices& choices, const LaserWork& work);
  void take_saved_earlier();
  void take_sent(const SendAttempt& attempt, const ReadyMap& ready);
  void look_after_failure();
  void take_active_after_failure(const std::optional<std::uint32_t>& active);
  void say_failed(const std::string& what, const Problem& why);
  void forget_verdict();
  void take_verdict(const VerifiedMap& verified);
  /// Whether the verdict became stale by what is known without asking the unit.
  [[nodiscard]] bool note_changes();
  void say_stale(const std::string& why);
  void warn_of_newer_files(const std::string& than);

  std::shared_ptr<UnitConnection> unit_;
  std::string mismatch_, other_unit_;
  Editor<LaserChoices> edited_;
  void offer(std::optional<Draft> draft);
  std::optional<Draft> offered_;
  std::string offered_of_, offered_saved_;
  std::string saved_earlier_csv_;  ///< of the map file, until the map of the continued work is known
  std::string sent_earlier_;       ///< the work that was continued was sent with these choices: to which unit
  bool changed_ = false;           ///< since the map was saved last
  LaserWorkPtr work_;
  bool pending_ = false;  ///< the choices went on while work was done
  std::string saved_csv_, saved_file_, sent_csv_;
  double part_shown_ = -1.0;
  std::optional<ReadyMap> ready_, failed_;
  std::optional<SentMap> sent_;
  std::optional<VerifiedMap> found_;  ///< when it was compared
  std::string compared_csv_;          ///< the map that was compared
  std::string stale_;
  std::uint64_t unit_time_us_ = 0;  ///< of the newest sample since the comparison
  int comparison_ = 0;              ///< counts them
  std::chrono::steady_clock::time_point next_verdict_look_{};
  std::string after_failure_;
  std::chrono::steady_clock::time_point next_look_{};
  Message message_;
  TaskRunner working_out_;
  TaskRunner task_;
  TaskRunner looking_;  ///< whether the verdict still holds
};

}  // namespace ecs::commissioning
