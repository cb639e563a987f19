// The error that compensation would leave, effect by effect and direction by direction; measured again, predicted
// against achieved.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// Errors of one sense while one axis moved in one direction.
struct AfterDirection {
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  int approach = 0;
  double now_um = 0.0;                ///< rms of the readings
  double predicted_um = 0.0;          ///< rms with all that the unit can carry taken away, noise included
  std::optional<double> achieved_um;  ///< rms of the readings taken afterwards
  std::size_t readings = 0;           ///< before
  std::size_t readings_after = 0;     ///< measured again
  std::string path{};                 ///< "circle XY": of readings along a path, by its first axis above; else ""
  std::string axes{};                 ///< that move along the path
};

/// @param fit  of the model to `before`
/// @param after  readings taken with the unit compensating; empty: none were
[[nodiscard]] std::vector<AfterDirection> after_by_direction(const model::Fit& fit, const model::Observations& before,
                                                             const model::Observations& after);

/// A part of what was left when measured again that has a shape: a constant, a slope, a difference of the directions.
struct RestPart {
  std::string shape;  ///< "constant", "slope", "reversal"
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  double size = 0.0;    ///< um, um/m; of a slope by metre, of an axis that turns by degree
  double rms_um = 0.0;  ///< of it, over all readings
  std::string text;     ///< a sentence: the part, its readings, its share of the rms, and its cause
};

/// What was measured with the unit compensating.
struct Achieved {
  model::Observations data;
  double rms_um = 0.0;
  double peak_um = 0.0;
  std::size_t left_out = 0;      ///< readings marked as taken without compensation
  std::vector<RestPart> rest{};  ///< largest first
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

/// That other periods of a wave fit the readings as well, what a wrong one costs, and the measurement that decides; ""
/// where its model keeps none.
[[nodiscard]] std::string other_periods_text(const model::EffectInstance& effect);

/// "Compensating all that the unit can would bring … Of that the machine keeps …, … belong to the measurement": for
/// the verb, the screen and the report.
[[nodiscard]] std::string what_if_summary(const model::WhatIf& what, const model::Model& model,
                                          std::string_view unit = "um");

/// Its text has 80 columns.
[[nodiscard]] Cell what_if_cell(const WhatIfAnswer& answer);

}  // namespace ecs::commissioning
