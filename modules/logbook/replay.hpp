// The active map derived again from what the logbook holds: the verbs that made it, run again on the readings as they
// were.
// What has changed at a machine between two days: its curves, the causes that were found, the error in its volume.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/file.hpp"
#include "base/json_fwd.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {

/// Files in place of the disc, for a verb that is run again: what is not among them is not there, what is written is
/// kept here.
class KeptFiles final : public FileWatch {
 public:
  /// @param folder  in which names that are not absolute stand
  explicit KeptFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void put(const std::string& name, std::string content);
  /// Null: none of that name.
  [[nodiscard]] const std::string* find(const std::string& name) const;

  [[nodiscard]] bool replaces_disc() const override { return true; }
  [[nodiscard]] Result<std::string> content(const std::filesystem::path& path) override;
  void was_read(const std::filesystem::path&, std::string_view) override {}
  void was_written(const std::filesystem::path& path, std::string_view content) override;

 private:
  [[nodiscard]] std::string place_of(const std::filesystem::path& path) const;

  std::filesystem::path folder_;
  std::map<std::string, std::string> files_;
};

/// Runs a verb on the files of the thread's watch. @return what it says on stdout with --json
using RunVerb = std::function<Result<std::string>(const std::vector<std::string>& words)>;

/// A file that was made again.
struct DerivedFile {
  std::int64_t entry = 0;  ///< that made it the first time
  std::string verb;        ///< "map build recipe.toml …"
  std::string name;
  std::string sha256;  ///< as it was
  bool same = false;   ///< byte for byte
};

/// A file that nothing in the logbook made: a raw reading, a recipe, a machine file.
struct RawFile {
  std::string name;
  std::string sha256;
};

struct Replay {
  std::int64_t activation = 0;  ///< number of the entry
  std::string map_sha256;       ///< of the image derived again
  std::string active_sha256;    ///< of the image that became active
  bool same = false;
  std::vector<DerivedFile> derived;  ///< in the order in which they were made
  std::vector<RawFile> raw;
  std::vector<std::string> notes;  ///< what could not be derived and was taken as it was
};

/// Derives files of a logbook again, each once.
class Derivation {
 public:
  Derivation(const Logbook& book, RunVerb run) : book_(book), run_(std::move(run)) {}

  /// The file with that hash: by the verb that made it before entry `before`, on its inputs derived again; else as it
  /// was kept. @param name  for a raw file
  [[nodiscard]] Result<std::string> file(const std::string& sha256, const std::string& name, std::int64_t before);

  std::vector<DerivedFile> derived;
  std::vector<RawFile> raw;

 private:
  [[nodiscard]] Result<void> know_entries();
  [[nodiscard]] Result<std::string> made_again(const LogbookEntry& entry, const std::string& sha256);

  const Logbook& book_;
  RunVerb run_;
  std::optional<std::vector<LogbookEntry>> entries_;
  std::map<std::string, std::string> done_;
};

/// @param active  the image of the connected unit, to be compared with in place of the logged one; empty: the logged
/// one `refused` where the logbook holds no activation of a map.
[[nodiscard]] Result<Replay> replayed(const Logbook& book, const RunVerb& run, const std::string& active = {});

/// One curve or squareness on both days; the error, not the compensation.
struct ComparedCurve {
  std::string component;
  std::string unit;
  std::array<std::optional<double>, 2> largest;  ///< size of the largest error; nothing: not measured then
  std::optional<double> largest_change;          ///< anywhere along the travel of both
  std::optional<double> change_rms;
};

struct ComparedCause {
  std::string name;  ///< "cyclic:X:EX"
  /// As the diagnosis of each day says it, "period_mm 8 amplitude_um 3.2"; nothing: not named then.
  std::array<std::optional<std::string>, 2> parameters;
};

/// Error vector over the working volume.
struct ComparedVolume {
  std::optional<double> before_largest_um, before_rms_um, after_largest_um, after_rms_um;
};

/// What is known of the machine on one day.
struct LoggedState {
  std::string date;
  std::optional<LogbookEntry> map;        ///< the last that was built by then
  std::optional<LogbookEntry> diagnosis;  ///< the last diagnosis or investigation
  std::optional<ComparedVolume> volume;
};

struct LogComparison {
  std::array<LoggedState, 2> states;
  std::vector<ComparedCurve> curves;  ///< largest change first
  std::vector<ComparedCause> causes;
  std::vector<std::string> notes;  ///< what could not be compared, and why
};

/// @param from, to  ISO dates: what was known at the end of that day, or at that time
[[nodiscard]] Result<LogComparison> compared(const Logbook& book, const std::string& from, const std::string& to,
                                             const RunVerb& run);

// Answers as text and JSON: what the verbs print and the screen shows (view.cpp).

[[nodiscard]] std::string log_list_head();
/// A line of the list; in JSON {"number", "time", "kind", "hash", "previous", "operator", "summary", …}.
[[nodiscard]] Cell log_entry_cell(const LogbookEntry& entry);
/// Says of measurements which later entry read them first: "exx.csv, input of entry 18 (model new: model.toml)".
/// @param entries  all of a logbook, in their order
void name_users_of_inputs(std::vector<LogbookEntry>& entries);
/// Everything of one entry. @param what  its summary as shown; JSON has the one that belongs to its hash
[[nodiscard]] Cell whole_entry_cell(const LogbookEntry& entry, const std::string& what);
/// @param expected  hash that an entry had to have; empty: none, and an end that is missing cannot be found
[[nodiscard]] Cell verdict_cell(const LogVerdict& verdict, const std::string& path, const std::string& expected);
[[nodiscard]] Cell replay_cell(const Replay& replay);
[[nodiscard]] Cell comparison_of_log_cell(const LogComparison& comparison);

}  // namespace ecs::commissioning
