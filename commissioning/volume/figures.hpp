// A volume as a picture: the wire cube of thesis figures 7.20 and 7.21 before and after, a slice with arrows, the body
// diagonals. Does not live here: how a picture is drawn (app/plot).
#pragma once

#include "commissioning/plot/figure.hpp"
#include "commissioning/volume/work.hpp"

namespace ecs::commissioning {

/// Left before, right after, errors drawn larger by the same factor in both.
[[nodiscard]] Result<PlotFigure> volume_figure(const VolumeWork& work);

}  // namespace ecs::commissioning
