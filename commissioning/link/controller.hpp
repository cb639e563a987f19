// Which link is used: the ports there are, the doctor that tries a setting, taking it, storing it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/link/choice.hpp"
#include "commissioning/link/doctor.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

/// A serial port of this computer.
struct FoundPort {
  std::string device;
  std::string trouble;  ///< why it cannot be opened; empty: it can
  std::string action;   ///< what to do about it
};

/// What the doctor found so far.
struct DoctorAnswer {
  std::string link;    ///< that was tried; empty: none yet
  std::string trying;  ///< what is being tried now; empty: it has ended
  std::vector<DoctorFinding> findings;
  std::optional<Diagnosis> diagnosis;  ///< at the end
};

class LinkController {
 public:
  explicit LinkController(std::shared_ptr<UnitConnection> unit);
  LinkController(const LinkController&) = delete;
  LinkController& operator=(const LinkController&) = delete;

  /// @return whether anything changed
  [[nodiscard]] bool advance();
  [[nodiscard]] LinkForm& form() { return form_; }
  [[nodiscard]] const LinkForm& form() const { return form_; }
  [[nodiscard]] const std::vector<FoundPort>& ports() const { return ports_; }
  [[nodiscard]] std::vector<std::string> port_names() const;
  [[nodiscard]] bool ports_known() const { return ports_known_; }
  [[nodiscard]] WatchedUnit unit() const { return unit_->snapshot(); }
  [[nodiscard]] DoctorAnswer doctor() const;
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }
  /// The stored link, as read at the beginning; empty: none.
  [[nodiscard]] const std::string& stored() const { return stored_; }

  void look_for_ports();
  /// The doctor tries what the form says; the unit's link is lent to it meanwhile. False: the form is wrong.
  [[nodiscard]] bool try_it();
  /// From now on this link, in all screens.
  void use();
  /// Stores it for the next start; asks first if it has not answered.
  void store();
  [[nodiscard]] Asking& asking() { return asking_; }
  [[nodiscard]] const Asking& asking() const { return asking_; }
  [[nodiscard]] const std::string& working_on() const { return task_.label(); }
  [[nodiscard]] double seconds_working() const { return task_.seconds(); }
  void cancel() { task_.cancel(); }

 private:
  /// What the doctor's thread reports.
  struct DoctorProgress {
    std::mutex mutex;
    DoctorAnswer answer;
    std::uint64_t changes = 0;
  };
  [[nodiscard]] bool idle();
  [[nodiscard]] std::optional<LinkChoice> chosen();
  void take(const std::string& link);
  void store_now(const std::string& link);
  void ended(const Diagnosis& diagnosis, bool cancelled);

  std::shared_ptr<UnitConnection> unit_;
  LinkForm form_;
  std::vector<FoundPort> ports_;
  bool ports_known_ = false;
  std::string stored_;
  std::string works_;  ///< a link that the doctor found to work
  std::shared_ptr<DoctorProgress> progress_ = std::make_shared<DoctorProgress>();
  std::uint64_t progress_seen_ = 0;
  std::uint64_t unit_seen_ = 0;
  Asking asking_;
  Message message_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
