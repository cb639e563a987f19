// What the PROCESS LASER DATA screen works on: the choices with their undo and draft, what follows from them, and the
// work under way. Pure state and actions, no terminal. Does not live here: drawing (screen.hpp).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/laser_session/unit_work.hpp"
#include "commissioning/laser_session/work.hpp"
#include "commissioning/session/drafts.hpp"
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

  [[nodiscard]] const LaserChoices& choices() const { return choices_; }
  /// Never null; belongs to older choices while working() is true.
  [[nodiscard]] const LaserWork& work() const { return *work_; }
  [[nodiscard]] LaserMark mark(LaserStep step) const;
  [[nodiscard]] const UnitConnection& unit() const { return *unit_; }

  // --- choices
  /// Keeps the draft, works out what follows. @param what  for undo: "run 3 left out"
  void change(const std::string& what, const std::function<void(LaserChoices&)>& how);
  void undo();
  void redo();
  /// Of an earlier sitting; nothing: there is none, or it was answered.
  [[nodiscard]] const std::optional<Draft>& offered() const { return offered_; }
  void take_up_offered();
  void drop_offered();
  /// Everything that the files on disc say now.
  void read_again();

  // --- disc and unit; each tells message()
  void save();
  /// Saves, checks here and at the unit; then ready() holds what send() would send.
  void prepare();
  [[nodiscard]] const std::optional<ReadyMap>& ready() const { return ready_; }
  void send();
  void not_now() { ready_.reset(); }
  void verify();
  /// Refused, saying why, unless the unit holds the very map that was found the same, or sent from here if nothing was
  /// compared since.
  void compensate();
  /// Every few seconds, while somebody looks at the verdict: whether it still holds of the unit.
  void watch_verdict();
  void receive_parameters(const std::string& file);
  /// Asks what runs on line or disc to stop.
  void cancel() { job_.cancel(); }

  /// Takes what has been finished meanwhile. @return whether anything changed
  [[nodiscard]] bool advance();
  [[nodiscard]] bool working() const { return working_out_.running() || pending_; }
  [[nodiscard]] bool busy() const { return job_.running(); }
  [[nodiscard]] const std::string& busy_with() const { return busy_with_; }
  [[nodiscard]] double part() const { return job_.part(); }
  [[nodiscard]] double seconds_left() const { return seen_ ? seen_->seconds_left.load() : -1.0; }
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

  /// A file of that name stands there that this screen did not write.
  [[nodiscard]] bool would_overwrite() const;
  [[nodiscard]] bool saved() const { return !saved_csv_.empty() && saved_csv_ == work_->map.csv; }
  [[nodiscard]] const std::optional<SentMap>& sent() const { return sent_; }
  [[nodiscard]] bool sent_is_current() const { return sent_ && sent_csv_ == work_->map.csv; }
  [[nodiscard]] const std::optional<MapVerdict>& verdict() const { return verdict_; }
  /// What was compared, with the unit that held it. @pre verdict()
  [[nodiscard]] const UnitHolding& compared() const { return *compared_; }
  /// Why the verdict holds no longer: the unit was restarted, given another map, ...; empty: it holds.
  [[nodiscard]] const std::string& stale() const { return stale_; }
  /// The unit holds the map of the choices as they are now.
  [[nodiscard]] bool verified() const {
    return verdict_ && verdict_->same() && stale_.empty() && compared_csv_ == work_->map.csv;
  }
  /// What stands in the unit after sending failed, in words; empty: nothing failed, or not known yet.
  [[nodiscard]] const std::string& after_failure() const { return after_failure_; }
  [[nodiscard]] std::string unsaved() const;

 private:
  enum class Doing { saving, preparing, sending, verifying, looking, receiving, switching };
  struct Done {
    Doing doing = Doing::saving;
    std::optional<Problem> problem;
    MapFiles files;
    std::string csv;  ///< of the map that was saved
    std::optional<ReadyMap> ready;
    std::optional<SentMap> sent;
    std::optional<VerifiedMap> verified;
    std::optional<std::uint32_t> active;
    std::string params_file;
  };
  using Piece = std::function<void(JobControl&, SendProgress&, Done&)>;

  using History = std::vector<std::pair<std::string, LaserChoices>>;
  void step_over(History& from, History& to);
  void work_out(bool with_map);
  void keep();
  [[nodiscard]] bool idle();
  void start(Doing doing, const std::string& label, Piece piece);
  [[nodiscard]] bool can_save();
  void take(const Done& done);
  void take_failure(const Done& done);
  void look_after_failure();
  void forget_verdict();
  void take_verdict(const VerifiedMap& verified);
  /// Whether the verdict became stale by what is known without asking the unit, or by what a look brought.
  [[nodiscard]] bool note_changes();
  [[nodiscard]] bool take_look();
  void say_stale(const std::string& why);
  void say_saved(const MapFiles& files);
  void warn_of_newer_files(const std::string& than);

  std::shared_ptr<UnitConnection> unit_;
  struct WorkFolder;
  std::unique_ptr<WorkFolder> folder_;  ///< for prepared files; outlives the jobs
  LaserChoices choices_;
  History past_, future_;  ///< what each step was, and the choices beyond it
  std::optional<Draft> offered_;
  bool changed_ = false;  ///< since the map was saved last
  LaserWorkPtr work_;
  bool pending_ = false;  ///< the choices went on while work was done
  bool map_pending_ = false;
  Job<LaserWorkPtr> working_out_;
  Job<Done> job_;
  std::string busy_with_;
  std::shared_ptr<SendProgress> seen_;
  std::string saved_csv_, saved_file_, sent_csv_;
  double part_shown_ = -1.0;
  std::optional<ReadyMap> ready_, failed_;
  std::optional<SentMap> sent_;
  std::optional<MapVerdict> verdict_;
  std::optional<UnitHolding> compared_;  ///< of `verdict_`
  std::string compared_csv_;             ///< the map that was compared
  std::string stale_;
  std::uint64_t unit_time_us_ = 0;  ///< of the newest sample since the comparison
  struct Look {
    int comparison = 0;  ///< the one that stood when it began
    Result<UnitHolding> now;
  };
  Job<Look> look_;
  int comparison_ = 0;  ///< counts them
  std::chrono::steady_clock::time_point next_verdict_look_{};
  std::string after_failure_;
  std::chrono::steady_clock::time_point next_look_{};
  Message message_;
};

}  // namespace ecs::commissioning
