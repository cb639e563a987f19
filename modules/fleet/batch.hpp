// `ecs batch`: a plan says which units get which parameters and map over which link; carrying it out, units on one line
// after the other, lines side by side. One that fails does not stop the others.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/unit_link.hpp"

namespace ecs::commissioning {

/// One `[[unit]]`. Paths are complete.
struct PlannedUnit {
  std::string name;
  LinkChoice link;
  std::string serial_number;  ///< that the unit must report; empty: not checked
  std::string params;
  std::string map;  ///< empty: parameters alone, the unit's map stays
};

/// Every wrong unit at once. `link` and `params` are needed: a batch has no default link. Files and the machine of an
/// `emulator:` link count from the folder of the plan.
[[nodiscard]] Result<std::vector<PlannedUnit>> parse_batch_plan(std::string_view text, const std::string& name,
                                                                const std::filesystem::path& folder);
/// Of a table (.csv) with the columns id, link, params, and serial_number, map, arm_code if any: a unit a line, as the
/// machines of a fleet (run.hpp); else of TOML.
[[nodiscard]] Result<std::vector<PlannedUnit>> read_batch_plan(const std::filesystem::path& path);

enum class BatchMode {
  dry_run,  ///< files, checks, image, link and serial number; nothing is written
  send,
};

enum class BatchState {
  ready,       ///< dry run: everything that can be checked without writing holds
  sent,        ///< sent and checked in the unit's memory
  held,        ///< the unit held this very map: nothing was sent
  failed,      ///< `problem` says why; what the unit held is as it was, unless its commit is in doubt (problem says so)
  wrong_unit,  ///< another serial number: skipped, untouched
  not_attempted,  ///< stopped by a signal before its turn
};
[[nodiscard]] std::string_view name_of(BatchState state);

struct BatchReport {
  std::string name;
  std::string link;
  bool is_emulator = false;
  std::string serial_number;  ///< as reported; empty: never reached
  BatchState state = BatchState::not_attempted;
  std::size_t bytes = 0;  ///< of the image sent, or ready
  std::vector<std::string> notes;
  std::optional<Problem> problem;
};

/// How far the whole plan is.
struct BatchProgress {
  std::size_t units_done = 0;
  std::size_t units = 0;
  double share = 0.0;         ///< 0 … 1, units under way counted by their bytes
  double seconds_left = 0.0;  ///< from the mean speed so far
};

/// Called by one line at a time.
struct BatchWatch {
  std::function<void(const PlannedUnit&)> started;
  std::function<void(const BatchProgress&)> progress;
};

/// Lines that are served at the same time.
inline constexpr int kUsualLines = 16;
inline constexpr int kMostLines = 256;

/// Units on one serial port, at one TCP address or of the bundled emulator take turns in the order of the plan.
/// @param lines  1 … kMostLines
/// @return in the order of the plan
[[nodiscard]] std::vector<BatchReport> run_batch(const std::vector<PlannedUnit>& plan, BatchMode mode, int lines,
                                                 const BatchWatch& watch = {});

/// The one that makes the exit code: a lost link before the rest; null: there is none.
[[nodiscard]] const Problem* first_problem(const std::vector<BatchReport>& reports);

/// 0 all well, 4 if a link failed, else 1.
[[nodiscard]] int exit_code_of(const std::vector<BatchReport>& reports);

}  // namespace ecs::commissioning
