#include "app/ui/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::app {
namespace {

PlotRange x_range(const PlotPanel& panel) {
  PlotRanges ranges;
  ranges.take(panel);
  return ranges.x;
}

PlotRange seen_x(const PlotPanel& panel, const ChartView& view) {
  PlotRange range = x_range(panel);
  if (view.x_from) range.from = *view.x_from;
  if (view.x_to) range.to = *view.x_to;
  return range;
}

PlotRange seen_y(const PlotPanel& panel, const ChartView& view, const PlotRange& x) {
  PlotRange range;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& p : series.points)
      if (p.x >= x.from && p.x <= x.to) range.take(p.y);
  if (view.y_from) range.from = *view.y_from;
  if (view.y_to) range.to = *view.y_to;
  return range;
}

void widen(PlotRange& range, double share) {
  if (range.empty()) range = {0.0, 1.0};
  const double pad = range.width() > 0.0 ? share * range.width() : std::max(1.0, std::abs(range.from) * 0.1);
  range.from -= pad;
  range.to += pad;
}

bool forward(Mark mark) {
  return mark == Mark::forward || mark == Mark::forward_reading || mark == Mark::forward_value;
}
bool reverse(Mark mark) {
  return mark == Mark::reverse || mark == Mark::reverse_reading || mark == Mark::reverse_value;
}
bool line(Mark mark) { return mark == Mark::forward || mark == Mark::reverse || mark == Mark::both; }

Tone tone_of(Mark mark) { return forward(mark) ? Tone::forward : (reverse(mark) ? Tone::reverse : Tone::plain); }
char32_t glyph_of(Mark mark, Glyphs glyphs) {
  if (mark == Mark::forward_value) return glyphs == Glyphs::ascii ? U'*' : U'◆';
  if (mark == Mark::reverse_value) return glyphs == Glyphs::ascii ? U'+' : U'◇';
  if (mark == Mark::level) return glyphs == Glyphs::ascii ? U'=' : U'■';
  if (mark == Mark::value) return glyphs == Glyphs::ascii ? U'*' : U'●';
  if (glyphs == Glyphs::ascii) return forward(mark) ? U'^' : (reverse(mark) ? U'v' : U'o');
  return forward(mark) ? U'▲' : (reverse(mark) ? U'▼' : U'○');
}

/// Dots of a plot area: 2 × 4 in a cell, or one where there is no braille.
class Dots {
 public:
  Dots(const Area& area, Glyphs glyphs)
      : area_(area), across_(glyphs == Glyphs::ascii ? 1 : 2), down_(glyphs == Glyphs::ascii ? 1 : 4) {
    cells_.resize(static_cast<std::size_t>(std::max(0, area.rows * area.columns)));
  }
  [[nodiscard]] int width() const { return area_.columns * across_; }
  [[nodiscard]] int height() const { return area_.rows * down_; }

  [[nodiscard]] std::size_t number_of(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(area_.columns) + static_cast<std::size_t>(column);
  }
  void set(int x, int y, Tone tone) {
    if (x < 0 || y < 0 || x >= width() || y >= height()) return;
    static constexpr std::array<std::array<std::uint8_t, 2>, 4> kBits{{{1, 8}, {2, 16}, {4, 32}, {64, 128}}};
    Dot& dot = cells_[number_of(y / down_, x / across_)];
    dot.bits = static_cast<std::uint8_t>(
        dot.bits | (down_ == 1 ? 1 : kBits[static_cast<std::size_t>(y % 4)][static_cast<std::size_t>(x % 2)]));
    dot.tone = tone;
  }
  void line(double x0, double y0, double x1, double y1, Tone tone, bool broken) {
    const double length = std::max({1.0, std::abs(x1 - x0), std::abs(y1 - y0)});
    const int steps = static_cast<int>(std::min(length, 4000.0));
    for (int k = 0; k <= steps; ++k) {
      ++drawn_;
      if (broken && drawn_ % 8 >= 4) continue;
      const double part = static_cast<double>(k) / steps;
      set(static_cast<int>(std::lround(x0 + part * (x1 - x0))), static_cast<int>(std::lround(y0 + part * (y1 - y0))),
          tone);
    }
  }
  void draw(Canvas& canvas) const {
    for (int r = 0; r < area_.rows; ++r)
      for (int c = 0; c < area_.columns; ++c) {
        const Dot& dot = cells_[number_of(r, c)];
        if (dot.bits == 0) continue;
        canvas.put(area_.row + r, area_.column + c, down_ == 1 ? U'.' : U'\u2800' + dot.bits, dot.tone);
      }
  }

 private:
  struct Dot {
    std::uint8_t bits = 0;
    Tone tone = Tone::plain;
  };
  Area area_;
  int across_;
  int down_;
  int drawn_ = 0;
  std::vector<Dot> cells_;
};

/// From numbers to dots of the plot area.
struct Scale {
  PlotRange x, y;
  double width = 1.0, height = 1.0;
  [[nodiscard]] double across(double value) const { return (value - x.from) / x.width() * (width - 1.0); }
  [[nodiscard]] double down(double value) const { return (y.to - value) / y.width() * (height - 1.0); }
};

/// Single readings too many for marks become dots.
bool as_dots(const PlotSeries& series, int columns) {
  return !line(series.mark) && static_cast<int>(series.points.size()) > columns / 2;
}

void draw_dots(const PlotSeries& series, const Scale& scale, Dots& dots) {
  for (const PlotPoint& p : series.points)
    dots.set(static_cast<int>(std::lround(scale.across(p.x))), static_cast<int>(std::lround(scale.down(p.y))),
             Tone::faint);
}

void draw_line(const PlotSeries& series, const Scale& scale, Dots& dots) {
  const Tone tone = tone_of(series.mark);
  for (std::size_t k = 1; k < series.points.size(); ++k) {
    const PlotPoint &a = series.points[k - 1], &b = series.points[k];
    if (std::max(a.x, b.x) < scale.x.from || std::min(a.x, b.x) > scale.x.to) continue;
    if (std::abs(b.x - a.x) > series.longest_gap) {
      dots.set(static_cast<int>(std::lround(scale.across(b.x))), static_cast<int>(std::lround(scale.down(b.y))), tone);
      continue;
    }
    dots.line(scale.across(a.x), scale.down(a.y), scale.across(b.x), scale.down(b.y), tone, reverse(series.mark));
  }
}

void draw_spread(const PlotSeries& series, const Scale& scale, Dots& dots) {
  for (std::size_t k = 1; k < series.points.size(); k += 2) {
    const PlotPoint &a = series.points[k - 1], &b = series.points[k];
    dots.line(scale.across(a.x), scale.down(a.y), scale.across(b.x), scale.down(b.y), Tone::faint, false);
  }
}

/// Marks on the points; on a dense line only every so often, so that the line stays seen.
void draw_marks(Canvas& canvas, const Area& plot, const PlotSeries& series, const Scale& scale) {
  const double cells_per_dot_x = plot.columns / scale.width;
  const double cells_per_dot_y = plot.rows / scale.height;
  const int least_apart = line(series.mark) ? 6 : 0;
  int last = -1000;
  for (const PlotPoint& p : series.points) {
    if (p.x < scale.x.from || p.x > scale.x.to || p.y < scale.y.from || p.y > scale.y.to) continue;
    const int c = static_cast<int>(scale.across(p.x) * cells_per_dot_x);
    const int r = static_cast<int>(scale.down(p.y) * cells_per_dot_y);
    if (least_apart > 0 && std::abs(c - last) < least_apart) continue;
    last = c;
    canvas.put(plot.row + std::min(r, plot.rows - 1), plot.column + std::min(c, plot.columns - 1),
               glyph_of(series.mark, canvas.glyphs()), tone_of(series.mark));
  }
}

/// One tick alone is no scale: finer steps until there are two, as far as there is room.
std::vector<double> two_at_least(double from, double to, int most, int room) {
  auto ticks = ticks_between(from, to, most);
  for (int more = most + 1; ticks.size() < 2 && more <= room; ++more) ticks = ticks_between(from, to, more);
  return ticks;
}

void draw_y_axis(Canvas& canvas, const Area& axis, const Scale& scale, int rows) {
  const auto ticks = two_at_least(scale.y.from, scale.y.to, std::max(2, rows / 3), rows);
  const double apart = ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  for (int r = 0; r < rows; ++r) canvas.put(axis.row + r, axis.column + axis.columns - 1, U'│', Tone::faint);
  for (const double tick : ticks) {
    const int r = static_cast<int>(scale.down(tick) / scale.height * rows);
    if (r < 0 || r >= rows) continue;
    canvas.text_right({axis.row, axis.column, axis.rows, axis.columns - 1}, r, tick_label(tick, apart), Tone::faint);
    canvas.put(axis.row + r, axis.column + axis.columns - 1, U'┤', Tone::faint);
  }
}

void draw_x_axis(Canvas& canvas, const Area& axis, const Scale& scale) {
  for (int c = 0; c < axis.columns; ++c) canvas.put(axis.row, axis.column + c, U'─', Tone::faint);
  const auto ticks = two_at_least(scale.x.from, scale.x.to, std::max(2, axis.columns / 12), axis.columns / 8);
  const double apart = ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  for (const double tick : ticks) {
    const int c = static_cast<int>(scale.across(tick) / scale.width * axis.columns);
    if (c < 0 || c >= axis.columns) continue;
    canvas.put(axis.row, axis.column + c, U'┬', Tone::faint);
    const std::string label = tick_label(tick, apart);
    const int first = std::clamp(c - width_of(label) / 2, 0, std::max(0, axis.columns - width_of(label)));
    canvas.text(axis, 1, first, label, Tone::faint);
  }
}

void draw_legend(Canvas& canvas, const Area& area, const PlotPanel& panel) {
  int column = 0;
  for (const PlotSeries& series : panel.series) {
    if (column >= area.columns || series.name.empty()) continue;
    const std::string mark = utf8_of(glyph_of(series.mark, canvas.glyphs()));
    const std::string stroke = !line(series.mark) ? " " : (reverse(series.mark) ? "- -" : "───");
    column += canvas.text(area, 0, column, mark + stroke + " ", tone_of(series.mark));
    column += canvas.text(area, 0, column, series.name) + 2;
  }
}

/// Series whose points are places of their own: where there are single readings these, for a curve drawn between them
/// has points everywhere.
std::vector<const PlotSeries*> with_places(const PlotPanel& panel) {
  std::vector<const PlotSeries*> readings, all;
  for (const PlotSeries& series : panel.series) {
    all.push_back(&series);
    if (series.mark == Mark::reading || series.mark == Mark::forward_reading || series.mark == Mark::reverse_reading)
      readings.push_back(&series);
  }
  return readings.empty() ? all : readings;
}

/// All texts of the screens say um.
std::string with_um(std::string text) {
  for (std::size_t at = text.find("µm"); at != std::string::npos; at = text.find("µm", at)) text.replace(at, 3, "um");
  return text;
}

/// The unit of a label, with a blank before it: " um" of "error [µm]", " mm" of "X mm"; empty: it names none.
std::string unit_in(const std::string& label) {
  static constexpr std::array<std::string_view, 7> kUnits{"mm", "um", "um/m", "mm/min", "s", "min", "h"};
  std::string text = with_um(label);
  std::erase_if(text, [](char c) { return c == '[' || c == ']'; });
  const std::string_view words = trimmed(text);
  const std::string_view last = words.substr(words.rfind(' ') == std::string_view::npos ? 0 : words.rfind(' ') + 1);
  return std::find(kUnits.begin(), kUnits.end(), last) == kUnits.end() ? "" : " " + std::string(last);
}

const PlotPoint* nearest(const PlotSeries& series, double x) {
  const PlotPoint* best = nullptr;
  for (const PlotPoint& p : series.points)
    if (best == nullptr || std::abs(p.x - x) < std::abs(best->x - x)) best = &p;
  return best;
}

}  // namespace

std::vector<double> ticks_between(double from, double to, int most) {
  if (!(to > from) || most < 1 || !std::isfinite(to - from)) return {};
  const double rough = (to - from) / most;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  for (const double part : {1.0, 2.0, 5.0})
    if (part * decade >= rough * (1.0 - 1e-9)) {
      step = part * decade;
      break;
    }
  std::vector<double> ticks;
  const double first = std::ceil(from / step - 1e-9);
  for (double k = first; k * step <= to + 1e-9 * step; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

std::string tick_label(double value, double apart) {
  const int digits = std::clamp(static_cast<int>(-std::floor(std::log10(std::max(1e-12, apart)) + 1e-9)), 0, 9);
  const double shown = std::abs(value) < 1e-9 * apart ? 0.0 : value;
  return fmt::format("{:.{}f}", shown, digits);
}

void draw_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const ChartView& view) {
  const Area plot = plot_area(area);
  if (plot.rows < 2 || plot.columns < 8) {
    canvas.text(area, 0, 0, "no room for a curve", Tone::faint);
    return;
  }
  canvas.text(area, 0, 0, with_um(panel.title), Tone::strong);
  canvas.text_right(area, 0, with_um(panel.y_label), Tone::faint);
  Scale scale;
  scale.x = seen_x(panel, view);
  if (scale.x.empty()) {
    canvas.text(area, 2, 2, "no measurement yet", Tone::faint);
    return;
  }
  scale.y = seen_y(panel, view, scale.x);
  if (scale.x.width() <= 0.0) widen(scale.x, 0.0);
  if (!view.y_from && !view.y_to) widen(scale.y, 0.05);
  Dots dots(plot, canvas.glyphs());
  scale.width = dots.width();
  scale.height = dots.height();
  if (scale.y.from < 0.0 && scale.y.to > 0.0) {  // where the error is zero
    const int r = static_cast<int>(scale.down(0.0) / scale.height * plot.rows);
    for (int c = 0; c < plot.columns; ++c) canvas.put(plot.row + r, plot.column + c, U'·', Tone::faint);
  }
  if (view.cursor_x && *view.cursor_x >= scale.x.from && *view.cursor_x <= scale.x.to) {
    const int c = static_cast<int>(scale.across(*view.cursor_x) / scale.width * plot.columns);
    for (int r = 0; r < plot.rows; ++r) canvas.put(plot.row + r, plot.column + c, U'│', Tone::strong);
  }
  for (const PlotSeries& series : panel.series) {
    if (series.mark != Mark::spread && as_dots(series, plot.columns)) draw_dots(series, scale, dots);
    if (line(series.mark)) draw_line(series, scale, dots);
    if (series.mark == Mark::spread) draw_spread(series, scale, dots);
  }
  dots.draw(canvas);
  for (const PlotSeries& series : panel.series)
    if (series.mark != Mark::spread && !as_dots(series, plot.columns)) draw_marks(canvas, plot, series, scale);
  draw_y_axis(canvas, {area.row + 1, area.column, plot.rows, kYAxisColumns}, scale, plot.rows);
  const Area below = area.below(1 + plot.rows);
  draw_x_axis(canvas, {below.row, plot.column, 2, plot.columns}, scale);
  canvas.text({below.row, below.column, 2, kYAxisColumns}, 1, 0, with_um(panel.x_label), Tone::faint);
  if (view.cursor_x)
    canvas.text(below, 2, 0, read_out(panel, *view.cursor_x), Tone::strong);
  else
    draw_legend(canvas, below.below(2), panel);
}

std::string read_out(const PlotPanel& panel, double x) {
  std::string text;
  double at = x;
  double least = std::numeric_limits<double>::infinity();
  for (const PlotSeries* series : with_places(panel))
    if (const PlotPoint* p = nearest(*series, x); p != nullptr && std::abs(p->x - x) < least) {
      least = std::abs(p->x - x);
      at = p->x;
    }
  for (const PlotSeries& series : panel.series) {
    const PlotPoint* p = nearest(series, at);
    if (p == nullptr || std::abs(p->x - at) > least + 1e-9) continue;
    text += fmt::format("{}{} {:.3f}{}", text.empty() ? "" : ", ", series.name.empty() ? "value" : with_um(series.name),
                        p->y, unit_in(panel.y_label));
  }
  return text.empty() ? "" : fmt::format("{} at {:.3f}{}", text, at, unit_in(panel.x_label));
}

ChartView zoomed(const PlotPanel& panel, const ChartView& view, double factor) {
  const PlotRange all = x_range(panel);
  PlotRange seen = seen_x(panel, view);
  if (all.empty() || all.width() <= 0.0) return view;
  const double centre = view.cursor_x.value_or(0.5 * (seen.from + seen.to));
  const double width = std::min(all.width(), seen.width() * factor);
  const double from = std::clamp(centre - 0.5 * width, all.from, all.to - width);
  ChartView next = view;
  if (width >= all.width() * (1.0 - 1e-9)) {
    next.x_from.reset();
    next.x_to.reset();
  } else {
    next.x_from = from;
    next.x_to = from + width;
  }
  return next;
}

ChartView stepped(const PlotPanel& panel, const ChartView& view, int direction) {
  std::set<double> places;
  for (const PlotSeries* series : with_places(panel))
    for (const PlotPoint& p : series->points) places.insert(p.x);
  ChartView next = view;
  if (places.empty()) return next;
  if (!view.cursor_x) {
    next.cursor_x = direction > 0 ? *places.begin() : *places.rbegin();
  } else if (direction > 0) {
    const auto after = places.upper_bound(*view.cursor_x);
    next.cursor_x = after == places.end() ? *places.rbegin() : *after;
  } else {
    const auto at = places.lower_bound(*view.cursor_x);
    next.cursor_x = at == places.begin() ? *places.begin() : *std::prev(at);
  }
  const PlotRange seen = seen_x(panel, view);
  if (view.x_from && (*next.cursor_x < seen.from || *next.cursor_x > seen.to)) return zoomed(panel, next, 1.0);
  return next;
}

bool on_chart_key(const Key& key, const PlotPanel& panel, ChartView& view) {
  if (key.name == Key::Name::left || key.name == Key::Name::right) {
    view = stepped(panel, view, key.name == Key::Name::right ? 1 : -1);
  } else if (is_letter(key, U'+') || is_letter(key, U'-')) {
    view = zoomed(panel, view, is_letter(key, U'+') ? 0.5 : 2.0);
  } else if (is_letter(key, U'0')) {
    view = {};
  } else {
    return false;
  }
  return true;
}

}  // namespace ecs::app
