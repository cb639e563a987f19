// The answer of `ecs volume` as text and JSON; a volume as a picture: the wire cube of thesis figures 7.20 and 7.21
// before and after, a slice with arrows, the body diagonals. Only for .cpp files (heavy header). Does not live here:
// how a picture is drawn (app/plot).
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/volume/work.hpp"

namespace ecs::commissioning {

/// The contract's keys `points`, `before`, `after`, `uncertainty_95_um`, with more beside (docs/volume.md); at most 24
/// lines of 80 columns in the text. @param picture, values  files that were written; empty: none
[[nodiscard]] Cell volume_cell(const VolumeWork& work, const std::string& picture, const std::string& values);

/// Every value of the map with its standard uncertainty: axis,sense,approach,p_mm,value_um,u_um.
[[nodiscard]] std::string values_csv(const VolumeWork& work);

/// Left before, right after, errors drawn larger by the same factor in both.
[[nodiscard]] Result<PlotFigure> volume_figure(const VolumeWork& work);

}  // namespace ecs::commissioning
