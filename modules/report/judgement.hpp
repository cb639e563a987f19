// What follows from the content of a report: whether the limits hold, what is worst, what to do next.
// Does not live here: how it is shown (page.hpp).
#pragma once

#include <string>
#include <vector>

#include "modules/report/content.hpp"

namespace ecs::app {

enum class RowVerdict {
  within,       ///< not above its limit
  above,        ///< above it
  no_limit,     ///< measured after compensation, nothing to compare with
  before_only,  ///< not measured after compensation, nor planned
  missing,      ///< planned, and a file is missing or unfit
};
[[nodiscard]] RowVerdict verdict_of(const TableRow& row);
/// "within", "above", "no limit", "before only", "missing"
[[nodiscard]] std::string_view word_for(RowVerdict verdict);

struct Judgement {
  std::size_t after = 0;            ///< rows measured after compensation
  std::size_t judged = 0;           ///< of them, with a limit
  std::size_t within = 0;           ///< of these, within it
  std::size_t missing = 0;          ///< rows with a missing or unfit file
  const TableRow* worst = nullptr;  ///< closest to its limit, or above it most; without limits the largest band left
  std::string sentence;             ///< the verdict, plain
  std::string worst_sentence;       ///< empty without `worst`
  std::vector<std::string> next;    ///< what is open, most urgent first; empty: nothing
};

/// @param content  must outlive the answer
[[nodiscard]] Judgement judgement_of(const ReportContent& content);

/// Decimals in which all bands of a row are shown.
[[nodiscard]] int decimals_of(const TableRow& row);

}  // namespace ecs::app
