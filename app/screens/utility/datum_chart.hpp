// The velocity-time graph of thesis figure 5.5 on a screen: speed above, the switch and the marker as lanes below, one
// or two records over each other, a cursor, a part of the time.
#pragma once

#include <optional>

#include "app/ui/cells.hpp"
#include "app/ui/chart.hpp"
#include "commissioning/utility/shown_record.hpp"

namespace ecs::app {

/// `panel` from speed_panel(); its range is the time that is seen.
void draw_datum_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const ShownRecord& first,
                      const ShownRecord* second, double from_s, double to_s, std::optional<double> cursor_s);

}  // namespace ecs::app
