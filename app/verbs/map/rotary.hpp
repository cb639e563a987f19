// `ecs map build` with readings of rotary axes: their error motions over the angle, for `ecs volume --rotary`.
// Does not live here: the map of a unit (build.cpp), which knows linear axes only.
#pragma once

#include <string>
#include <vector>

#include "app/cli/verb.hpp"
#include "commissioning/measurements/files.hpp"

namespace ecs::app {

/// True where the first of these files holds readings of a rotary axis.
[[nodiscard]] bool measures_rotary_axes(const std::vector<std::string>& files, ImportArguments import);

/// Every file read, the table written to `output` if one is given.
[[nodiscard]] Result<Outcome> rotary_errors_built(VerbContext& context, const std::vector<std::string>& files,
                                                  ImportArguments import, const std::string& output);

}  // namespace ecs::app
