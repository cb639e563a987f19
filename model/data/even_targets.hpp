// The remark that targets at equal steps call for.
#pragma once

#include <optional>
#include <string>

#include "model/data/observations.hpp"

namespace ecs::model {

/// "targets are even at 50 mm along X (EX): periods below 100 mm cannot be told from longer ones, …" for every axis and
/// sense whose targets, all runs and lines together, lie at equal steps; nothing where none do. A period below two
/// steps has aliases (Nyquist).
[[nodiscard]] std::optional<std::string> even_targets_note(const Observations& data);

}  // namespace ecs::model
