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

// As wide as a telephone, so that its words can be read there; a wide window enlarges it and has smaller letters.
constexpr double kWidth = 340.0, kLeft = 48.0, kRight = 8.0, kPanel = 150.0, kFoot = 36.0;
constexpr double kTitle = 16.0, kKeyRow = 17.0;
constexpr double kLetter = 6.0, kTitleLetter = 7.3;  ///< width of a letter of key and title, on average
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
  constexpr std::string_view kUp = "m0-3l2.6 4.6h-5.2z", kDown = "m0 3l2.6-4.6h-5.2z",
                             kDot = "m-1.7 0a1.7 1.7 0 1 0 3.4 0a1.7 1.7 0 1 0-3.4 0z",
                             kDiamond = "m0-2.8l2.8 2.8l-2.8 2.8l-2.8-2.8z";
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

/// The title in as many lines as it needs. @return the height that they take
double add_title(std::string& svg, std::string_view title) {
  constexpr auto kLetters = static_cast<std::size_t>(kWidth / kTitleLetter);
  double height = 0.0;
  std::string row;
  for (const std::string_view word : split(title, ' ')) {
    if (!row.empty() && row.size() + word.size() >= kLetters) {
      svg += label(0.0, height + 13.0, "name", row);
      height += kTitle;
      row.clear();
    }
    row += (row.empty() ? "" : " ") + std::string(word);
  }
  svg += label(0.0, height + 13.0, "name", row);
  return height + kTitle;
}

/// The series by their names, as many in a row as there is room for. @param y  the height above them
/// @return the height with them
double add_key(std::string& svg, const PlotPanel& panel, double y) {
  double x = kLeft;
  y += 14.0;
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
  std::string inside;
  frame.top = add_key(inside, panel, add_title(inside, panel.title));
  inside += grid_svg(frame);
  for (const PlotSeries& series : panel.series) inside += series_svg(frame, series);
  const double height = frame.top + kPanel + kFoot;
  inside += label(kLeft + (kWidth - kLeft - kRight) / 2.0, height - 5.0, "tick mid", panel.x_label);
  inside += fmt::format("<text transform=\"translate(11 {:.1f}) rotate(-90)\" class=\"tick mid\">{}</text>",
                        frame.top + kPanel / 2.0, text(panel.y_label).html());
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">{}</svg>\n", kWidth, height,
                     text(words_for(panel)).html(), inside);
}

/// Bars one below the other, each under its name and with its number; a dashed line for the level.
std::string bars_svg(const PlotFigure& figure) {
  constexpr double kRow = 32.0, kBar = 12.0, kNumbers = 48.0;
  const PlotPanel& panel = figure.panels.front();
  PlotRanges ranges;
  ranges.take(panel);
  const double scale = ranges.y.to > 0.0 ? (kWidth - kNumbers) / ranges.y.to : 0.0;
  const double foot = kRow * static_cast<double>(panel.x_names.size());
  std::string inside, words = figure.title + ".";
  double level = 0.0, least = ranges.y.to;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& point : series.points) {
      if (series.mark == Mark::level) level = scale * point.y;
      if (point.y > 0.0) least = std::min(least, point.y);
    }
  const auto number_of = [&](double value) { return number_text(value, decimals_for(least)); };
  for (std::size_t row = 0; row < panel.x_names.size(); ++row)
    inside += label(0.0, kRow * static_cast<double>(row) + 12.0, "tick", panel.x_names[row]);
  for (const PlotSeries& series : panel.series) {
    if (series.points.empty()) continue;
    for (const PlotPoint& point : series.points) {
      if (series.mark != Mark::bar) break;
      const std::string number = number_of(point.y);
      const double top = kRow * point.x + 16.0, end = scale * point.y;
      inside += fmt::format("<rect class=\"bar\" x=\"0\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", top,
                            std::max(0.5, end), kBar);
      inside += label((level > end && level < end + kNumbers ? level : end) + 5.0, top + kBar - 2.0, "tick", number);
      words += fmt::format(" {}: {}.", panel.x_names[static_cast<std::size_t>(point.x)], number);
    }
    if (series.mark != Mark::level) continue;
    const bool is_right = level > kWidth / 2.0;
    for (std::size_t row = 0; row < panel.x_names.size(); ++row)  // across the bars, not across their names
      inside += fmt::format("<path class=\"level\" d=\"M{:.1f} {:.1f}v{:.1f}\"/>", level,
                            kRow * static_cast<double>(row) + 14.0, kBar + 4.0);
    const std::string number = number_of(series.points.front().y);
    inside += label(level + (is_right ? -4.0 : 4.0), foot + 12.0, is_right ? "tick end" : "tick",
                    fmt::format("{} {}", series.name, number));
    words += fmt::format(" {}: {}.", series.name, number);
  }
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">{}</svg>\n", kWidth,
                     foot + 16.0, text(words).html(), inside);
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
    svg = bars_svg(figure);
  else
    for (const PlotPanel& panel : figure.panels) svg += panel_svg(panel);
  return write_file(path, svg);
}

}  // namespace ecs::app
