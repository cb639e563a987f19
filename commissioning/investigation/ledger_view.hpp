// The ledger of an investigation as rows of a screen: a falling staircase of the causes that are still possible.
// Does not live here: the same as text of a verb (ledger.hpp).
#pragma once

#include <string>
#include <vector>

#include "commissioning/investigation/followed.hpp"

namespace ecs::commissioning {

struct LedgerRow {
  std::string numbers;      ///< number, minutes, minutes in all, rms, members left; below ledger_numbers_head()
  std::size_t members = 0;  ///< left in the set; 0: nothing is named
  bool settled = false;     ///< one cause is left, or nothing is missing
  std::string measured;
};

struct LedgerView {
  std::vector<LedgerRow> rows;
  std::string set;    ///< "sag:X:EX 0.97, progressive:X:EX 0.03"; what the last verdict is where it is empty
  std::string doing;  ///< empty: nothing
  std::vector<std::string> said;  ///< newest last
};

/// " #    min in all   rms um left"
[[nodiscard]] std::string ledger_numbers_head();
[[nodiscard]] LedgerView view_of(const InvestigationProgress& progress);

/// The view as lines that fit `columns`, bars as '#'; for a terminal that is redrawn.
[[nodiscard]] std::vector<std::string> lines_of(const LedgerView& view, std::size_t columns);

}  // namespace ecs::commissioning
