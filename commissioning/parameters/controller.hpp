// What the parameters screen works on: the set being edited beside the file and the unit it is compared with, what
// stands against it, undo, the draft on disc.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/parameters/set.hpp"
#include "commissioning/parameters/transfer.hpp"
#include "commissioning/session/editor.hpp"
#include "params/check.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// Work that is neither saved nor sent, by this name among the drafts (commissioning/session/remembered.hpp).
inline constexpr const char* kParametersDraft = "parameters";

/// One key that is not the same everywhere; empty values: that side is not known.
struct ComparedKey {
  std::string key;
  std::string screen, file, unit;
};

class ParametersController {
 public:
  // --- where the set comes from; each begins a new history, edits that are neither saved nor sent stay as a draft
  [[nodiscard]] Result<void> open_file(const std::string& path);
  /// Parameters to start from for a machine, checked against it from then on.
  [[nodiscard]] Result<void> start_from_machine(const std::string& path);
  /// What the unit holds in place of the set; can be taken back. Refused if it holds none.
  [[nodiscard]] Result<void> take_from_unit(const UnitContent& unit);
  /// Work of an earlier time that was neither saved nor sent, if nothing is loaded yet.
  [[nodiscard]] std::optional<Draft> draft() const;
  /// Of which machine it is, else of which file; empty: neither is known.
  [[nodiscard]] static std::string owner_of(const Draft& draft);
  [[nodiscard]] Result<void> take_up_draft();

  [[nodiscard]] bool loaded() const { return loaded_; }
  [[nodiscard]] const ParameterSet& set() const { return edited_.now(); }
  [[nodiscard]] const std::string& file() const { return file_; }             ///< empty: in no file yet
  [[nodiscard]] const std::string& machine() const { return machine_name_; }  ///< checked against; empty: none
  [[nodiscard]] const std::optional<UnitContent>& unit() const { return unit_; }

  // --- edits
  /// Refused with the reason; nothing is then changed.
  [[nodiscard]] Result<void> change(const std::string& key, const std::string& text);
  /// The next or previous of choices_of(key). @return whether the key has any
  bool cycle(const std::string& key, int by);
  void set_default(const std::string& key);
  /// The value of file or unit into the set. @return whether that side has one
  bool take_from_file(const std::string& key);
  bool take_from_unit(const std::string& key);
  /// What was taken back or done again; empty: there is nothing.
  [[nodiscard]] std::string undo();
  [[nodiscard]] std::string redo();

  // --- what is known of the set
  [[nodiscard]] const std::vector<params::Finding>& findings() const { return findings_; }
  [[nodiscard]] std::vector<const params::Finding*> findings_of(const std::string& key) const;
  [[nodiscard]] std::size_t errors() const;
  /// Since it was loaded, saved or sent: the value then; nothing: the same.
  [[nodiscard]] std::optional<std::string> was(const std::string& key) const;
  /// Keys that changed since then.
  [[nodiscard]] std::size_t changes() const { return changes_; }
  [[nodiscard]] bool unsaved() const { return edited_.unsaved(); }
  [[nodiscard]] const std::vector<ComparedKey>& compared() const { return compared_; }
  [[nodiscard]] bool has_file_values() const { return in_file_.has_value(); }
  [[nodiscard]] bool has_unit_values() const { return unit_ && unit_->parameters; }
  /// Values that the file holds otherwise; 0 where there is none.
  [[nodiscard]] std::size_t differs_from_file() const;
  /// Fields that the unit holds otherwise, those of absent axes too.
  [[nodiscard]] std::vector<ComparedKey> differs_from_unit() const;
  [[nodiscard]] bool differs_from_unit(const std::string& key) const;

  // --- where it goes
  /// Empty: check without a machine.
  [[nodiscard]] Result<void> check_with(const std::string& machine_path);
  /// Why saving there is to be asked first: another file stands there, or ours was changed meanwhile; empty: nothing.
  [[nodiscard]] std::string overwrites(const std::string& path) const;
  [[nodiscard]] Result<void> save(const std::string& path);
  /// The unit was looked at.
  void know_unit(UnitContent unit);
  /// A parameter file with this set for commands that read it, noted if no file holds it yet. @return its name
  [[nodiscard]] std::string file_for_commands(const ParameterSet& what);
  /// The file that holds, for those commands, what was taken from the unit last.
  [[nodiscard]] const std::string& file_between_commands() const { return held_.path; }
  /// The set as it was sent is what the unit holds now.
  void sent(const ParameterSet& what, UnitContent after);

 private:
  /// A file that the commands noted so far have, and what it holds.
  struct HeldFile {
    std::string path;     ///< empty: none
    std::string machine;  ///< that `ecs params new` makes it from; empty: it is there
    ParameterSet set;
    bool whole = true;  ///< it ends with its closing line
  };
  void load(ParameterSet set, std::string file);
  void note_written(const std::string& path, const ParameterSet& what);
  void edit(ParameterSet after, std::string what);
  std::string stepped(std::optional<std::string> what);
  void refresh();
  void keep_draft() const;

  bool loaded_ = false;
  Editor<ParameterSet> edited_{kParametersDraft};
  std::string file_;
  std::optional<ParameterSet> in_file_;  ///< as last read or written
  std::string file_text_;                ///< the same, to see whether somebody else wrote there
  std::string machine_path_, machine_name_;
  std::optional<params::Machine> machine_;
  std::optional<UnitContent> unit_;
  std::vector<params::Finding> findings_;
  std::vector<params::Finding> file_findings_;  ///< of the file as it was read; saving it mends them
  std::vector<ComparedKey> compared_;
  std::size_t changes_ = 0;
  HeldFile held_;  ///< where the set came from, or was saved last
};

}  // namespace ecs::commissioning
