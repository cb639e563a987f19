// Figures of the verbs where no gnuplot is: SVG in the style of the report, a picture for each panel, so that a page
// can lay them out for its width. Colours are those of the page's style sheet.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/plot/gnuplot.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "modules/report/page.hpp"

namespace ecs::app {
namespace {

constexpr double kWidth = 460.0, kLeft = 50.0, kRight = 8.0, kPanel = 190.0, kFoot = 36.0;
constexpr double kTitle = 20.0, kKeyRow = 17.0;
constexpr double kLetter = 6.0;  ///< width of a letter of the key, on average
constexpr std::size_t kMarksAcross = 40;

struct Frame {
  PlotRange x, y;
  double top = 0.0;
  [[nodiscard]] double at_x(double value) const { return kLeft + (kWidth - kLeft - kRight) * x.part(value); }
  [[nodiscard]] double at_y(double value) const { return top + kPanel * (1.0 - y.part(value)); }
};

/// How a mark is drawn: its line, its shape and the class of both.
struct Look {
  std::string_view style = "bid";
  bool line = false;
  std::string_view shape{};  ///< from its middle; empty: none
  bool dense = false;        ///< one at each point
};

Look look_of(Mark mark) {
  constexpr std::string_view kUp = "m0-3.6l3.2 5.6h-6.4z", kDown = "m0 3.6l3.2-5.6h-6.4z",
                             kDot = "m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0z",
                             kDiamond = "m0-3.4l3.4 3.4l-3.4 3.4l-3.4-3.4z";
  switch (mark) {
    case Mark::forward:
      return {"fwd", true, kUp};
    case Mark::reverse:
      return {"rev", true, kDown};
    case Mark::both:
      return {"bid", true, {}};
    case Mark::forward_reading:
      return {"fwd reading", false, kUp, true};
    case Mark::reverse_reading:
      return {"rev reading", false, kDown, true};
    case Mark::reading:
      return {"bid reading", false, kDot, true};
    case Mark::forward_value:
      return {"fwd value", false, kDiamond, true};
    case Mark::reverse_value:
      return {"rev value", false, kDiamond, true};
    case Mark::value:
      return {"bid value", false, kDot, true};
    case Mark::level:
      return {"level", true, {}};
    default:
      return {"spread", false, {}, true};
  }
}

std::string label(double x, double y, std::string_view style, std::string_view words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>", x, y, style, text(words).html());
}

std::string line_path(const Frame& frame, const PlotSeries& series) {
  std::string d;
  const PlotPoint* before = nullptr;
  for (const PlotPoint& p : series.points) {
    const bool joined = before != nullptr && p.x - before->x <= series.longest_gap;
    d += fmt::format("{}{:.1f} {:.1f}", joined ? "L" : "M", frame.at_x(p.x), frame.at_y(p.y));
    before = &p;
  }
  return d;
}

std::string series_svg(const Frame& frame, const PlotSeries& series) {
  if (series.points.empty()) return {};
  const Look look = look_of(series.mark);
  std::string svg, d;
  if (look.style == "spread") {
    for (std::size_t i = 0; i + 1 < series.points.size(); i += 2)
      d += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", frame.at_x(series.points[i].x), frame.at_y(series.points[i].y),
                       frame.at_x(series.points[i + 1].x), frame.at_y(series.points[i + 1].y));
    return fmt::format("<path class=\"spread\" d=\"{}\"/>", d);
  }
  if (look.line) svg = fmt::format("<path class=\"line {}\" d=\"{}\"/>", look.style, line_path(frame, series));
  const std::size_t step = look.dense ? 1 : 1 + series.points.size() / kMarksAcross;
  if (look.shape.empty()) return svg;
  for (std::size_t i = 0; i < series.points.size(); i += step)
    d += fmt::format("M{:.1f} {:.1f}{}", frame.at_x(series.points[i].x), frame.at_y(series.points[i].y), look.shape);
  return svg + fmt::format("<path class=\"mark {}\" d=\"{}\"/>", look.style, d);
}

/// The series by their names, as many in a row as there is room for. @return the height that they take
double add_key(std::string& svg, const PlotPanel& panel) {
  double x = kLeft, y = kTitle + 10.0;
  for (const PlotSeries& series : panel.series) {
    if (series.name.empty() || series.points.empty()) continue;
    const double width = 42.0 + kLetter * static_cast<double>(series.name.size());
    if (x > kLeft && x + width > kWidth) x = kLeft, y += kKeyRow;
    const Look look = look_of(series.mark);
    if (look.line || look.style == "spread")
      svg += fmt::format("<path class=\"{} {}\" d=\"M{:.1f} {:.1f}h20\"/>", look.line ? "line" : "", look.style, x,
                         y - 4.0);
    if (!look.shape.empty())
      svg += fmt::format("<path class=\"mark {}\" d=\"M{:.1f} {:.1f}{}\"/>", look.style, x + 10.0, y - 4.0, look.shape);
    svg += label(x + 25.0, y, "tick", series.name);
    x += width;
  }
  return y + 8.0;
}

std::string grid_svg(const Frame& frame) {
  std::string d, zero, svg;
  for (const double tick : round_ticks(frame.y.from, frame.y.to, 5)) {
    (std::abs(tick) < 1e-9 ? zero : d) +=
        fmt::format("M{:.1f} {:.1f}H{:.1f}", kLeft, frame.at_y(tick), kWidth - kRight);
    svg += label(kLeft - 5.0, frame.at_y(tick) + 4.0, "tick end", plain_number(tick));
  }
  for (const double tick : round_ticks(frame.x.from, frame.x.to, 5)) {
    d += fmt::format("M{:.1f} {:.1f}v{:.1f}", frame.at_x(tick), frame.top, kPanel);
    svg += label(frame.at_x(tick), frame.top + kPanel + 14.0, "tick mid", plain_number(tick));
  }
  return svg + fmt::format(
                   "<path class=\"grid\" d=\"{}\"/><path class=\"zero\" d=\"{}\"/>"
                   "<path class=\"frame\" d=\"M{:.1f} {:.1f}v{:.1f}H{:.1f}\"/>",
                   d, zero, kLeft, frame.top, kPanel, kWidth - kRight);
}

/// What a panel shows, in words: for those who do not see it.
std::string words_for(const PlotPanel& panel) {
  std::string words = fmt::format("{}. {} over {}.", panel.title, panel.y_label, panel.x_label);
  for (const PlotSeries& series : panel.series) {
    if (series.points.empty()) continue;
    PlotRange range;
    for (const PlotPoint& point : series.points) range.take(point.y);
    words +=
        fmt::format(" {}: {}, {} to {}.", series.name.empty() ? "readings" : series.name,
                    counted(series.points.size(), "point", "points"), plain_number(range.from), plain_number(range.to));
  }
  return words;
}

std::string panel_svg(const PlotPanel& panel) {
  PlotRanges ranges;
  ranges.take(panel);
  Frame frame{ranges.x, ranges.y};
  frame.x.pad(0.02);
  frame.y.pad(0.06);
  std::string inside = label(0.0, 13.0, "name", panel.title);
  frame.top = add_key(inside, panel);
  inside += grid_svg(frame);
  for (const PlotSeries& series : panel.series) inside += series_svg(frame, series);
  const double height = frame.top + kPanel + kFoot;
  inside += label(kLeft + (kWidth - kLeft - kRight) / 2.0, height - 5.0, "tick mid", panel.x_label);
  inside += fmt::format("<text transform=\"translate(11 {:.1f}) rotate(-90)\" class=\"tick mid\">{}</text>",
                        frame.top + kPanel / 2.0, text(panel.y_label).html());
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">{}</svg>\n", kWidth, height,
                     text(words_for(panel)).html(), inside);
}

/// Bars by name say how long they are.
PlotFigure with_numbers(PlotFigure figure) {
  for (PlotPanel& panel : figure.panels)
    for (PlotSeries& series : panel.series)
      if (series.mark == Mark::bar && series.labels.empty())
        for (const PlotPoint& point : series.points)
          series.labels.push_back(number_text(point.y, decimals_for(point.y)));
  return figure;
}

}  // namespace

Result<PlotFormat> plot_format_of(const std::filesystem::path& path) {
  if (lower(path.extension().string()) == ".svg") return PlotFormat::svg;
  return problem(ProblemKind::usage, path.string() + ": the page draws .svg");
}

Result<void> write_plot(const std::filesystem::path& path, const PlotFigure& figure) {
  ECS_DO(plot_format_of(path));
  const bool bars = !figure.panels.empty() && !figure.panels.front().x_names.empty();
  std::string svg;
  if (bars)
    svg = inline_svg(with_numbers(figure)).html();
  else
    for (const PlotPanel& panel : figure.panels) svg += panel_svg(panel);
  return write_file(path, svg);
}

}  // namespace ecs::app
