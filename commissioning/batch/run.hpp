// Carrying out a plan, unit by unit: one that fails does not stop the others.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/batch/plan.hpp"
#include "commissioning/link/unit_link.hpp"

namespace ecs::commissioning {

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

/// Called before a unit's turn, and gives the progress callback for it.
using BatchTurn = std::function<protocol::ProgressCallback(const PlannedUnit&)>;

[[nodiscard]] std::vector<BatchReport> run_batch(const std::vector<PlannedUnit>& plan, BatchMode mode,
                                                 const BatchTurn& turn);

/// The one that makes the exit code: a lost link before the rest; null: there is none.
[[nodiscard]] const Problem* first_problem(const std::vector<BatchReport>& reports);

/// 0 all well, 4 if a link failed, else 1.
[[nodiscard]] int exit_code_of(const std::vector<BatchReport>& reports);

}  // namespace ecs::commissioning
