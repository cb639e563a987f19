#include "app/screens/laser/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/ui/chart_plot.hpp"

namespace ecs::app {
namespace {

/// How far the axis reaches beyond the readings that count, in parts of what they spread: they keep a third of it.
constexpr double kReach = 1.0;
constexpr std::size_t kMostToldOneByOne = 3;
constexpr double kSamePlace_mm = 1e-6;

PlotRange x_range(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, const ChartView& view) {
  PlotRange x;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& p : series.points) x.take(p.x);
  for (const PlotPoint& p : left_out) x.take(p.x);
  if (view.x_from) x.from = *view.x_from;
  if (view.x_to) x.to = *view.x_to;
  return x;
}

/// Of the readings that count, inside `x`.
PlotRange y_range(const PlotPanel& panel, const PlotRange& x) {
  PlotRange y;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& p : series.points)
      if (x.has(p.x)) y.take(p.y);
  return y;
}

PlotRange reach_of(const PlotRange& counting) {
  if (counting.empty()) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const double width = counting.width() > 0.0 ? counting.width() : std::max(1.0, 0.1 * std::abs(counting.from));
  return {counting.from - kReach * width, counting.to + kReach * width};
}

CellPosition cell_of(const Canvas& canvas, const Area& plot, const PlotRange& x, const PlotRange& y,
                     const PlotPoint& p) {
  const bool ascii = canvas.glyphs() == Glyphs::ascii;  // else 2 × 4 dots in a cell
  const double across = plot.columns - (ascii ? 1.0 : 0.5);
  const double down = plot.rows - (ascii ? 1.0 : 0.25);
  const int row = static_cast<int>((1.0 - std::clamp(y.part(p.y), 0.0, 1.0)) * down);
  const int column = static_cast<int>(x.part(p.x) * across);
  return {plot.row + std::min(row, plot.rows - 1), plot.column + std::min(column, plot.columns - 1)};
}

/// Marks at the upper or lower edge; the value beside each as long as they are few.
void draw_beyond(Canvas& canvas, const Area& plot, int row, const std::vector<PlotPoint>& points, const PlotRange& x,
                 bool with_values) {
  for (const PlotPoint& p : points) {
    const int column = std::min(static_cast<int>(x.part(p.x) * (plot.columns - 0.5)), plot.columns - 1);
    canvas.put(plot.row + row, plot.column + column, U'x', Tone::warning);
    if (!with_values) continue;
    const std::string value = fmt::format("{:.4g}", p.y);
    const int right = column + 2;
    const int at = right + width_of(value) <= plot.columns ? right : column - 1 - width_of(value);
    if (at >= 0) canvas.text(plot, row, at, value, Tone::warning);
  }
}

bool is_mean(Mark mark) { return mark == Mark::forward || mark == Mark::reverse || mark == Mark::both; }

/// Where a cursor at `x` reads: the nearest point of all.
double nearest_place(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, double x) {
  double place = x, least = std::numeric_limits<double>::infinity();
  const auto take = [&](const PlotPoint& p) {
    if (std::abs(p.x - x) >= least) return;
    least = std::abs(p.x - x);
    place = p.x;
  };
  for (const PlotSeries& series : panel.series) std::for_each(series.points.begin(), series.points.end(), take);
  std::for_each(left_out.begin(), left_out.end(), take);
  return place;
}

/// "at -200: forward 1.20, reverse 3.41, x 47.50": means and what is left out, which fits where single runs would not.
std::string means_at(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, double x) {
  const double place = nearest_place(panel, left_out, x);
  const auto here = [place](const PlotPoint& p) { return std::abs(p.x - place) < kSamePlace_mm; };
  std::string text = fmt::format("at {:.6g}:", place);
  const char* before = " ";
  const auto add = [&](const std::string& what, double value) {
    text += fmt::format("{}{} {:.2f}", before, what, value);
    before = ", ";
  };
  for (const PlotSeries& series : panel.series)
    if (const auto p = std::find_if(series.points.begin(), series.points.end(), here);
        is_mean(series.mark) && p != series.points.end())
      add(series.name, p->y);
  for (const PlotPoint& p : left_out)
    if (here(p)) add("x", p.y);
  return text;
}

/// In the row of the legend.
void draw_means_at(Canvas& canvas, const Area& area, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                   const ChartView& view) {
  const Area plot = plot_area(area);
  if (!view.cursor_x || plot.rows < 2 || plot.columns < 8) return;
  const Area last{area.row + area.rows - 1, area.column, 1, area.columns};
  canvas.fill(last);
  canvas.text(last, 0, 0, means_at(panel, left_out, *view.cursor_x), Tone::strong);
}

/// Over a curve a crowd of marks stands only every so many columns, so that the curve stays seen; beside it all do.
void draw_inside(Canvas& canvas, const Area& plot, const std::vector<PlotPoint>& points, const PlotRange& x,
                 const PlotRange& y) {
  constexpr int kApart = 6;
  const bool crowd = static_cast<int>(points.size()) > plot.columns / 4;
  std::vector<CellPosition> places;
  for (const PlotPoint& p : points) places.push_back(cell_of(canvas, plot, x, y, p));
  std::sort(places.begin(), places.end(), [](const CellPosition& a, const CellPosition& b) {
    return std::pair(a.column, a.row) < std::pair(b.column, b.row);
  });
  int last = -kApart;
  for (const CellPosition& at : places) {
    if (crowd && canvas.at(at.row, at.column).glyph != U' ') {
      if (at.column - last < kApart) continue;
      last = at.column;
    }
    canvas.put(at.row, at.column, U'x', Tone::warning);
  }
}

}  // namespace

LeftOutSeen left_out_seen(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, const ChartView& view) {
  constexpr double kMargin = 0.05;
  constexpr double kMarginForMarks = 0.25;
  LeftOutSeen seen;
  const PlotRange x = x_range(panel, left_out, view);
  const PlotRange counting = y_range(panel, x);
  const PlotRange reach = reach_of(counting);
  PlotRange y = counting;
  for (const PlotPoint& p : left_out) {
    if (!x.has(p.x)) continue;
    if (p.y > reach.to) {
      seen.above.push_back(p);
    } else if (p.y < reach.from) {
      seen.below.push_back(p);
    } else {
      seen.inside.push_back(p);
      y.take(p.y);
    }
  }
  if (y.empty()) y = {0.0, 1.0};
  const double width = y.width() > 0.0 ? y.width() : std::max(1.0, 0.1 * std::abs(y.from));
  seen.view = view;
  seen.view.x_from = x.from;
  seen.view.x_to = x.to;
  if (!view.y_from) seen.view.y_from = y.from - width * (seen.below.empty() ? kMargin : kMarginForMarks);
  if (!view.y_to) seen.view.y_to = y.to + width * (seen.above.empty() ? kMargin : kMarginForMarks);
  return seen;
}

std::string beyond_text(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, std::string_view unit) {
  const LeftOutSeen seen = left_out_seen(panel, left_out, {});
  std::vector<PlotPoint> beyond = seen.above;
  beyond.insert(beyond.end(), seen.below.begin(), seen.below.end());
  if (beyond.empty()) return {};
  if (beyond.size() > kMostToldOneByOne) {
    const auto [least, most] = std::minmax_element(beyond.begin(), beyond.end(),
                                                   [](const PlotPoint& a, const PlotPoint& b) { return a.y < b.y; });
    return fmt::format("{} beyond the edge: {:.4g} to {:.4g} {}", beyond.size(), least->y, most->y, unit);
  }
  std::string text = "beyond the edge:";
  for (std::size_t k = 0; k < beyond.size(); ++k)
    text += fmt::format("{} {:.4g} {} at {:.6g}", k == 0 ? "" : ",", beyond[k].y, unit, beyond[k].x);
  return text;
}

std::string left_out_legend(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, std::string_view unit) {
  const std::string beyond = beyond_text(panel, left_out, unit);
  return fmt::format("x left out: {}{}{}", left_out.size(), beyond.empty() ? "" : "; ", beyond);
}

void draw_laser_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                      const ChartView& view) {
  if (left_out.empty()) {
    draw_chart(canvas, area, panel, view);
    return draw_means_at(canvas, area, panel, left_out, view);
  }
  const LeftOutSeen seen = left_out_seen(panel, left_out, view);
  draw_chart(canvas, area, panel, seen.view);
  draw_means_at(canvas, area, panel, left_out, view);
  const Area plot = plot_area(area);
  const PlotRange x{*seen.view.x_from, *seen.view.x_to}, y{*seen.view.y_from, *seen.view.y_to};
  if (plot.rows < 2 || plot.columns < 8 || !(x.width() > 0.0)) return;
  draw_inside(canvas, plot, seen.inside, x, y);
  const bool few = seen.above.size() + seen.below.size() <= kMostToldOneByOne;
  draw_beyond(canvas, plot, 0, seen.above, x, few);
  draw_beyond(canvas, plot, plot.rows - 1, seen.below, x, few);
}

bool on_laser_chart_key(const Key& key, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                        ChartView& view) {
  PlotPanel all = panel;
  all.series.push_back({"", Mark::reading, left_out});
  return on_chart_key(key, all, view);
}

PlotPanel with_left_out(PlotPanel panel, const std::vector<PlotPoint>& left_out, std::string_view unit) {
  if (left_out.empty()) return panel;
  const std::string beyond = beyond_text(panel, left_out, unit);
  const bool circles = std::any_of(panel.series.begin(), panel.series.end(),
                                   [](const PlotSeries& one) { return one.mark == Mark::reading; });
  PlotSeries series{"left out", circles ? Mark::forward_reading : Mark::reading,
                    left_out_seen(panel, left_out, {}).inside};
  panel.title += fmt::format(" ({} left out{}{})", left_out.size(), beyond.empty() ? "" : ", ", beyond);
  panel.series.insert(panel.series.begin(), std::move(series));
  return panel;
}

}  // namespace ecs::app
