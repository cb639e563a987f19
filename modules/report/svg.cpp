#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "modules/report/page.hpp"

namespace ecs::app {
namespace {

constexpr double kWidth = 680.0;
constexpr double kLeft = 52.0;
constexpr double kRight = 10.0;
constexpr double kPanelTitleHeight = 17.0;  ///< above each panel
constexpr double kPanel = 102.0;            ///< height of the plot itself
constexpr double kGap = 4.0;
constexpr double kFoot = 31.0;  ///< numbers and name of the abscissa
constexpr std::size_t kMarksAcross = 26;

/// From numbers to the places of one panel.
struct Frame {
  PlotRange x;
  PlotRange y;
  double top = 0.0;
  [[nodiscard]] double at_x(double value) const { return kLeft + (kWidth - kLeft - kRight) * x.part(value); }
  [[nodiscard]] double at_y(double value) const { return top + kPanel * (1.0 - y.part(value)); }
};

std::string line_path(const Frame& frame, const std::vector<PlotPoint>& points) {
  std::string d;
  for (const PlotPoint& p : points)
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", frame.at_x(p.x), frame.at_y(p.y));
  return d;
}

std::string one_mark(Mark mark, double x, double y) {
  if (mark == Mark::forward) return fmt::format("M{:.1f} {:.1f}l3.4 5.9h-6.8z", x, y - 3.9);
  if (mark == Mark::reverse) return fmt::format("M{:.1f} {:.1f}l3.4-5.9h-6.8z", x, y + 3.9);
  return fmt::format("M{:.1f} {:.1f}a2 2 0 1 0 4 0a2 2 0 1 0-4 0z", x - 2.0, y);
}

/// Marks so far apart that they do not hide the line; those of reverse lie between those of forward.
std::string mark_path(const Frame& frame, const PlotSeries& series) {
  const std::size_t step = 1 + series.points.size() / kMarksAcross;
  std::string d;
  for (std::size_t i = series.mark == Mark::reverse ? step / 2 : 0; i < series.points.size(); i += step)
    d += one_mark(series.mark, frame.at_x(series.points[i].x), frame.at_y(series.points[i].y));
  return d;
}

std::string spread_path(const Frame& frame, const std::vector<PlotPoint>& points) {
  std::string d;
  for (std::size_t i = 0; i + 1 < points.size(); i += 2)
    d += fmt::format("M{:.1f} {:.1f}V{:.1f}", frame.at_x(points[i].x), frame.at_y(points[i].y),
                     frame.at_y(points[i + 1].y));
  return d;
}

std::string_view style_of(Mark mark) {
  if (mark == Mark::forward) return "fwd";
  return mark == Mark::reverse ? "rev" : "bid";
}

std::string series_svg(const Frame& frame, const PlotSeries& series) {
  if (series.points.empty()) return {};
  if (series.mark == Mark::spread)
    return fmt::format("<path class=\"spread\" d=\"{}\"/>\n", spread_path(frame, series.points));
  const auto style = style_of(series.mark);
  return fmt::format("<path class=\"line {}\" d=\"{}\"/>\n<path class=\"mark {}\" d=\"{}\"/>\n", style,
                     line_path(frame, series.points), style, mark_path(frame, series));
}

std::string label_svg(double x, double y, std::string_view style, std::string_view words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>\n", x, y, style, text(words).html());
}

std::string grid_svg(const Frame& frame, bool numbers_below) {
  std::string d, zero, svg;
  for (const double tick : round_ticks(frame.y.from, frame.y.to, 4)) {
    const double y = frame.at_y(tick);
    (std::abs(tick) < 1e-9 ? zero : d) += fmt::format("M{:.1f} {:.1f}H{:.1f}", kLeft, y, kWidth - kRight);
    svg += label_svg(kLeft - 5.0, y + 3.5, "tick end", plain_number(tick));
  }
  for (const double tick : round_ticks(frame.x.from, frame.x.to, 9)) {
    const double x = frame.at_x(tick);
    d += fmt::format("M{:.1f} {:.1f}v{:.1f}", x, frame.top, kPanel);
    if (numbers_below) svg += label_svg(x, frame.top + kPanel + 13.0, "tick mid", plain_number(tick));
  }
  svg += fmt::format("<path class=\"grid\" d=\"{}\"/>\n", d);
  if (!zero.empty()) svg += fmt::format("<path class=\"zero\" d=\"{}\"/>\n", zero);
  return svg + fmt::format("<path class=\"frame\" d=\"M{:.1f} {:.1f}v{:.1f}H{:.1f}\"/>\n", kLeft, frame.top, kPanel,
                           kWidth - kRight);
}

std::string open_svg(double height, std::string_view label) {
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n", kWidth, height,
                     text(label).html());
}

bool has(const PlotFigure& figure, Mark mark) {
  for (const PlotPanel& panel : figure.panels)
    for (const PlotSeries& series : panel.series)
      if (series.mark == mark && !series.points.empty()) return true;
  return false;
}

/// At the right end of the first line.
std::string key_svg(const PlotFigure& figure) {
  struct Entry {
    Mark mark;
    std::string_view words;
    double width;
  };
  constexpr Entry kEntries[] = {{Mark::spread, "all readings", 86.0},
                                {Mark::both, "mean", 64.0},
                                {Mark::reverse, "reverse, mean", 106.0},
                                {Mark::forward, "forward, mean", 106.0}};
  std::string svg;
  double x = kWidth - kRight;
  for (const Entry& entry : kEntries) {
    if (!has(figure, entry.mark)) continue;
    x -= entry.width;
    if (entry.mark == Mark::spread) {
      svg += fmt::format("<path class=\"spread\" d=\"M{0:.1f} 2v10M{1:.1f} 4v8M{2:.1f} 3v7\"/>\n", x + 6.0, x + 11.0,
                         x + 16.0);
    } else {
      svg += fmt::format("<path class=\"line {}\" d=\"M{:.1f} 7h26\"/><path class=\"mark {}\" d=\"{}\"/>\n",
                         style_of(entry.mark), x, style_of(entry.mark), one_mark(entry.mark, x + 13.0, 7.0));
    }
    svg += label_svg(x + (entry.mark == Mark::spread ? 21.0 : 30.0), 10.5, "tick", entry.words);
  }
  return svg;
}

Frame common_frame(const PlotFigure& figure) {
  PlotRanges ranges;
  ranges.take(figure);
  Frame frame{ranges.x, ranges.y};
  frame.x.pad(0.012);
  frame.y.pad(0.06);
  return frame;
}

std::string curves_svg(const PlotFigure& figure) {
  Frame frame = common_frame(figure);
  const auto panels = static_cast<double>(figure.panels.size());
  const double height = panels * (kPanelTitleHeight + kPanel + kGap) - kGap + kFoot;
  std::string svg = open_svg(height, figure.title) + key_svg(figure);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const double top = static_cast<double>(i) * (kPanelTitleHeight + kPanel + kGap);
    frame.top = top + kPanelTitleHeight;
    svg += label_svg(kLeft, top + 11.0, "name", figure.panels[i].title);
    svg += grid_svg(frame, i + 1 == figure.panels.size());
    for (const PlotSeries& series : figure.panels[i].series) svg += series_svg(frame, series);
  }
  if (figure.panels.empty()) return svg;
  svg += label_svg(kLeft + (kWidth - kLeft - kRight) / 2.0, height - 3.0, "tick mid", figure.panels.back().x_label);
  const double middle = (height - kFoot) / 2.0 + kPanelTitleHeight / 2.0;
  return svg + fmt::format("<text transform=\"translate(11 {:.1f}) rotate(-90)\" class=\"tick mid\">{}</text>\n",
                           middle, text(figure.panels.back().y_label).html());
}

constexpr double kDrawing = 380.0;  ///< side of a figure whose units are as long in x as in y

std::string style_in_drawing(Mark mark) {
  if (mark == Mark::wire) return "grid";
  return mark == Mark::level ? "zero" : fmt::format("line {}", style_of(mark));
}

/// One panel, lines without marks: polar plots.
std::string drawing_svg(const PlotFigure& figure) {
  const PlotPanel& panel = figure.panels.front();
  PlotRanges ranges;
  ranges.take(panel);
  const double unit = (kDrawing - 40.0) / std::max(ranges.x.width(), ranges.y.width());
  const double middle_x = (ranges.x.from + ranges.x.to) / 2.0, middle_y = (ranges.y.from + ranges.y.to) / 2.0;
  std::string svg = open_svg(kDrawing, figure.title);
  double key_y = 30.0;
  for (const PlotSeries& series : panel.series) {
    std::string d;
    for (const PlotPoint& p : series.points)
      d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", kDrawing / 2.0 + unit * (p.x - middle_x),
                       kDrawing / 2.0 - unit * (p.y - middle_y) + 8.0);
    const std::string style = style_in_drawing(series.mark);
    svg += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", style, d);
    if (series.name.empty()) continue;
    svg += fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}h26\"/>\n", style, kDrawing + 6.0, key_y - 3.5);
    svg += label_svg(kDrawing + 38.0, key_y, "tick", series.name);
    key_y += 16.0;
  }
  return svg + label_svg(0.0, 11.0, "name", panel.title) +
         label_svg(kDrawing / 2.0 + unit * (ranges.x.to - middle_x) + 4.0, kDrawing / 2.0 + 11.0, "tick",
                   panel.x_label.substr(0, panel.x_label.find(' ')) + "+") +
         label_svg(kDrawing / 2.0 + 4.0, 24.0, "tick", panel.y_label.substr(0, panel.y_label.find(' ')) + "+");
}

constexpr double kBarRow = 19.0, kBarNames = 190.0, kBarValues = 86.0;

/// @param front  in front of another bar of the same row: half as high
std::string one_bar(std::size_t row, double width, bool front, bool behind) {
  const double height = front ? (kBarRow - 4.0) / 2.0 : kBarRow - 4.0;
  const double y = kBarRow * static_cast<double>(row) + (kBarRow - height) / 2.0;
  return fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
                     behind ? "bar before" : "bar", kBarNames, y, std::max(0.5, width), height);
}

std::string level_svg(double x, double height, const std::string& name) {
  return fmt::format("<path class=\"level\" d=\"M{:.1f} 0V{:.1f}\"/>\n", x, height - 14.0) +
         label_svg(x + 4.0, height - 4.0, "tick", name);
}

std::string bars_svg(const PlotFigure& figure) {
  const PlotPanel& panel = figure.panels.front();
  PlotRanges ranges;
  ranges.take(panel);
  const double scale = ranges.y.to > 0.0 ? (kWidth - kBarNames - kBarValues) / ranges.y.to : 0.0;
  const bool has_level = has(figure, Mark::level);
  const double height = kBarRow * static_cast<double>(panel.x_names.size()) + (has_level ? 20.0 : 4.0);
  std::string svg = open_svg(height, figure.title);
  std::vector<double> ends(panel.x_names.size(), 0.0);
  const auto text_at = [&](std::size_t row, double x, const char* style, const std::string& words) {
    svg += label_svg(x, kBarRow * static_cast<double>(row) + 13.5, style, words);
  };
  const auto bars = std::count_if(panel.series.begin(), panel.series.end(),
                                  [](const PlotSeries& series) { return series.mark == Mark::bar; });
  for (std::size_t row = 0; row < panel.x_names.size(); ++row)
    text_at(row, kBarNames - 6.0, "tick end", panel.x_names[row]);
  for (const PlotSeries& series : panel.series) {
    const bool first = &series == &panel.series.front();
    for (const PlotPoint& point : series.points) {
      if (series.mark != Mark::bar) break;
      const auto row = static_cast<std::size_t>(point.x);
      svg += one_bar(row, scale * point.y, !first, first && bars > 1);
      ends[row] = std::max(ends[row], scale * point.y);
    }
    if (series.mark == Mark::level && !series.points.empty())
      svg += level_svg(kBarNames + scale * series.points.front().y, height, series.name);
  }
  for (const PlotSeries& series : panel.series)
    for (std::size_t i = 0; i < series.labels.size(); ++i) {
      const auto row = static_cast<std::size_t>(series.points[i].x);
      text_at(row, kBarNames + ends[row] + 5.0, "tick", series.labels[i]);
    }
  return svg;
}

}  // namespace

std::vector<double> round_ticks(double least, double most, int wanted) {
  std::vector<double> ticks;
  if (!(most > least) || wanted < 1) return ticks;
  const double rough = (most - least) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double lead = rough / power;
  const double step = power * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
  const double first = std::ceil(least / step - 1e-9);
  for (int i = 0; i <= 3 * wanted; ++i) {
    const double tick = (first + i) * step;
    if (!(tick <= most + 1e-9 * step)) break;
    ticks.push_back(tick);
  }
  return ticks;
}

Markup inline_svg(const PlotFigure& figure) {
  const bool bars = !figure.panels.empty() && !figure.panels.front().x_names.empty();
  const bool drawing = !bars && figure.panels.size() == 1 && figure.panels.front().equal_units;
  return Markup::literal((bars ? bars_svg(figure) : drawing ? drawing_svg(figure) : curves_svg(figure)) + "</svg>\n");
}

}  // namespace ecs::app
