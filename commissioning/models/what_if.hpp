// The error that compensation would leave, effect by effect and direction by direction; measured again, predicted
// against achieved.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/models/after.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/ladder.hpp"

namespace ecs::commissioning {

/// What was measured with the unit compensating.
struct Achieved {
  model::Observations data;
  double rms_um = 0.0;
  double peak_um = 0.0;
  std::size_t left_out = 0;  ///< readings marked as taken without compensation
};

struct WhatIfAnswer {
  model::WhatIf what;
  std::vector<AfterDirection> directions;
  std::optional<Achieved> achieved;
  std::vector<std::string> notes;
  model::Model model;            ///< that was asked about
  bool rotary = false;           ///< its axes are A, B, C
  std::string_view unit = "um";  ///< of its readings
};

/// @param model_file  as problems name it
/// @param after  files measured again with the unit compensating; empty: none were
[[nodiscard]] Result<WhatIfAnswer> what_if_answer(MessageSink& messages, const ModelWork& work,
                                                  const std::string& model_file, const std::vector<std::string>& after,
                                                  const ImportArguments& import);

/// "Compensating all that the unit can would bring … Of that the machine keeps …, … belong to the measurement": for
/// the verb, the screen and the report.
[[nodiscard]] std::string what_if_summary(const model::WhatIf& what, const model::Model& model,
                                          std::string_view unit = "um");

/// Its text has 80 columns.
[[nodiscard]] Cell what_if_cell(const WhatIfAnswer& answer);

}  // namespace ecs::commissioning
