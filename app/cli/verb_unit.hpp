// A verb's way to its unit: opens the link that the command line names, shows its progress, asks for --yes; an axis as
// an argument. Does not live here: which link (commissioning/link/choice.hpp), opening it
// (commissioning/link/unit_link.hpp).
#pragma once

#include <string>
#include <string_view>

#include "app/cli/verb.hpp"
#include "base/result.hpp"
#include "commissioning/link/unit_link.hpp"
#include "core/axis.hpp"

namespace ecs::app {

/// Sets the context's message prefix if the link that it names, or the default, is an emulator.
void announce_writing(VerbContext& context);

/// Opens the link that the context names, tells the context its name; its message prefix where the action writes.
[[nodiscard]] Result<UnitLink> open_unit(VerbContext& context);

/// Says that the machine must be referenced now; with a bundled emulator, how.
void ask_to_reference(VerbContext& context, const UnitLink& unit, std::string_view axes);

/// Feeds the progress bar.
[[nodiscard]] protocol::ProgressCallback progress_bar(VerbContext& context, std::string label);

/// A usage problem unless `yes`: what moves, runs or overwrites needs --yes.
[[nodiscard]] Result<void> confirmed(bool yes, std::string_view what_happens);

/// "x" or "X"; a usage problem otherwise.
[[nodiscard]] Result<Axis> axis_named(std::string_view text);

}  // namespace ecs::app
