// A chart of measured readings with those that were left out of it: x, far ones at the edge with their value.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/chart.hpp"
#include "commissioning/plot/figure.hpp"

namespace ecs::app {

/// What of the readings left out is seen: those no farther from the others than the others spread, the rest is beyond.
struct LeftOutSeen {
  std::vector<PlotPoint> inside;
  std::vector<PlotPoint> above;
  std::vector<PlotPoint> below;
  ChartView view;  ///< both ranges stated: room for `inside`, and for marks at the edge
};
/// @pre `left_out` is not empty. @param panel  the readings that count; may be empty: then nothing is far
[[nodiscard]] LeftOutSeen left_out_seen(const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                        const ChartView& view);

/// "beyond the edge: 47.5 um at -200", of many the least and the most; empty: none is.
[[nodiscard]] std::string beyond_text(const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                      std::string_view unit);
/// The legend of the marks: "x left out: 18; beyond the edge: 47.5 um at -200". @pre something is left out
[[nodiscard]] std::string left_out_legend(const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                          std::string_view unit);

/// As draw_chart(), the readings left out as x over it, and under a cursor the means: single runs would not fit. The
/// legend of the marks is left to whoever draws it.
void draw_laser_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                      const ChartView& view);

/// As on_chart_key(); the cursor stops at what is left out as well.
[[nodiscard]] bool on_laser_chart_key(const Key& key, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                                      ChartView& view);

/// For pictures: those inside as a series of its own, those beyond named in the title.
[[nodiscard]] PlotPanel with_left_out(PlotPanel panel, const std::vector<PlotPoint>& left_out, std::string_view unit);

}  // namespace ecs::app
