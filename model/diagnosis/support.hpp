// How far the readings to which a model was fitted support its predictions at other places. Does not live here: the
// predictions (model/fit/fit.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "model/data/observations.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::model {

/// How far the readings to which a model was fitted support its prediction at another place.
struct Support {
  double sigma = 0.0;  ///< um, um/m: standard uncertainty of the prediction
  /// Less certain there, by a tenth, than at any of the readings of its sense and axis (hidden extrapolation: Brooks,
  /// Carroll and Verdini 1988; Montgomery, Peck and Vining 2012, 3.8), or beyond the positions of these along the axis,
  /// or there are none. Or a coordinate has a value that no reading has, and readings at such values are predicted
  /// badly from the others. Or it is in another run, and every pass has a zero of its own.
  bool extrapolated = false;
};
struct Supports {
  std::vector<Support> places;       ///< one per reading of `at`, canonical order
  bool is_other_fit = false;         ///< a fit to these readings has clearly other values than the model
  std::vector<std::string> notes{};  ///< why places at new values of a coordinate, or in other runs, are extrapolated
};

/// The noise of a reading and what has no gradient (the place of a step, a value at its limit) are not in it; of
/// effects that are not in the model only what the last two of these conditions show.
/// @param model  with values  @param data  to which it was fitted
[[nodiscard]] Result<Supports> support_of(const Model& model, const Observations& data, const Observations& at);

}  // namespace ecs::model
