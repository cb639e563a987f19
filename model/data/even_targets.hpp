// The remark that targets at equal steps call for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/data/observations.hpp"

namespace ecs::model {

/// An axis whose targets, all runs and lines of some senses together, lie at equal steps: a period below two steps has
/// aliases (Nyquist).
struct EvenTargets {
  Axis axis = Axis::X;
  double step_mm = 0.0;
  std::string senses;          ///< "EX, EY"
  std::string hidden_pitches;  ///< ", the screw pitch of 10 mm among them"; "" where no known pitch is below two steps
  bool pitch_known = false;    ///< the machine file says one of the axis
};
[[nodiscard]] std::vector<EvenTargets> even_targets(const Observations& data);

/// "targets are even at 50 mm along X (EX): periods below 100 mm cannot be told from longer ones, …" for every axis and
/// sense of `even_targets`; nothing where there are none.
[[nodiscard]] std::optional<std::string> even_targets_note(const Observations& data);

}  // namespace ecs::model
