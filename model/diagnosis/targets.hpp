// Sentences about what the targets of a measurement cannot show, whatever the machine does: periods below two steps of
// equal targets (Nyquist), a pitch of which all targets are multiples, an axis read at one place.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "model/data/observations.hpp"

namespace ecs::model {

/// By axis, the different targets of all its readings [mm; of a rotary axis deg].
[[nodiscard]] std::map<Axis, std::set<double>> targets_of(const Observations& data);

/// Of an axis: whether its drift is the same elsewhere is not known.
[[nodiscard]] bool is_at_one_target(const Observations& data);

/// Periods below two steps of equally spaced targets, where no pitch of the axis is known or a known one is among them,
/// or the axis is rotary; and the other cases above. "" where there is nothing of the kind.
/// @param names_a_wave  by the answer: its period may be another one
[[nodiscard]] std::string reservation_for(const Observations& data, bool names_a_wave);

/// "targets are equally spaced at 50 mm along X (EX): periods shorter than 100 mm cannot be distinguished from longer
/// ones, …" for every axis and its senses; nothing where there are none.
[[nodiscard]] std::optional<std::string> even_targets_note(const Observations& data);

}  // namespace ecs::model
