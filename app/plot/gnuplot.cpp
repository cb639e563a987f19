// A figure as commands for gnuplot, and gnuplot run with them.
#include "app/plot/gnuplot.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

std::string range_text(PlotRange range, double padding) {
  range.pad(padding);
  return fmt::format("[{:.9g}:{:.9g}]", range.from, range.to);
}

/// As gnuplot takes a text that means only itself: in single quotes, on one line.
std::string literal(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "'";
}

/// A text in a row of data.
std::string in_double_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return out + "\"";
}

bool is_line(Mark mark) { return mark == Mark::forward || mark == Mark::reverse || mark == Mark::both; }

/// Points from one mark on a line to the next: dense marks would hide it.
std::size_t mark_spacing(std::size_t points) { return 1 + points / 60; }

std::string_view style_of(Mark mark) {
  switch (mark) {
    case Mark::forward:
      return "linespoints lw 1.5 dt 1 pt 9 ps 0.9 lc rgb '#0050a0'";
    case Mark::reverse:
      return "linespoints lw 1.5 dt (12,6) pt 11 ps 0.9 lc rgb '#c04000'";
    case Mark::both:
      return "linespoints lw 1.5 dt 1 pt 7 ps 0.6 lc rgb '#202020'";
    case Mark::forward_reading:
      return "points pt 8 ps 0.7 lw 0.7 lc rgb '#6090c0'";
    case Mark::reverse_reading:
      return "points pt 10 ps 0.7 lw 0.7 lc rgb '#d08060'";
    case Mark::forward_value:
      return "points pt 13 ps 0.8 lc rgb '#0050a0'";
    case Mark::reverse_value:
      return "points pt 12 ps 0.8 lc rgb '#c04000'";
    case Mark::value:
      return "points pt 7 ps 0.6 lc rgb '#202020'";
    case Mark::bar:
      return "boxes fc rgb '#b8cfe6' fs solid 1.0 border rgb '#0050a0'";
    case Mark::level:
      return "lines lw 2.5 dt (12,6) lc rgb '#c04000'";
    case Mark::spread:
      return "lines lw 3 dt 1 lc rgb '#c8c8c8'";
    case Mark::wire:
      return "lines lw 0.8 dt 1 lc rgb '#a0a0a0'";
    case Mark::bent_wire:
      return "lines lw 1.6 dt 1 lc rgb '#0050a0'";
    case Mark::arrow:
      return "vectors head filled size graph 0.012,20 lw 1.2 lc rgb '#c04000'";
    case Mark::label:
      return "labels tc rgb '#202020' offset 0,0.6";
    case Mark::reading:
      break;
  }
  return "points pt 6 ps 0.6 lw 0.7 lc rgb '#808080'";
}

bool is_stroke(Mark mark) { return mark == Mark::spread || mark == Mark::wire || mark == Mark::bent_wire; }

std::string point_rows(const PlotSeries& series) {
  std::string out;
  for (std::size_t k = 0; k < series.points.size(); ++k) {
    if (is_stroke(series.mark) && k > 0 && k % 2 == 0) out += '\n';  // ends a stroke
    out += fmt::format("{:.9g} {:.9g}", series.points[k].x, series.points[k].y);
    if (series.mark == Mark::label && k < series.labels.size())
      out += fmt::format(" {}", in_double_quotes(series.labels[k]));
    out += '\n';
  }
  return out;
}

/// Where each begins, and how far it goes.
std::string arrow_rows(const PlotSeries& series) {
  std::string out;
  for (std::size_t k = 0; k + 1 < series.points.size(); k += 2) {
    const PlotPoint &from = series.points[k], &to = series.points[k + 1];
    out += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", from.x, from.y, to.x - from.x, to.y - from.y);
  }
  return out;
}

std::string data_blocks(const PlotFigure& figure) {
  std::string out;
  for (std::size_t p = 0; p < figure.panels.size(); ++p)
    for (std::size_t s = 0; s < figure.panels[p].series.size(); ++s) {
      out += fmt::format("$data_{}_{} << END_OF_DATA\n", p, s);
      const PlotSeries& series = figure.panels[p].series[s];
      out += series.mark == Mark::arrow ? arrow_rows(series) : point_rows(series);
      out += "END_OF_DATA\n";
    }
  return out;
}

std::string_view columns_for(Mark mark) {
  if (mark == Mark::arrow) return "1:2:3:4";
  return mark == Mark::label ? "1:2:3" : "1:2";
}

std::string plot_command(const PlotPanel& panel, std::size_t place) {
  std::vector<std::string> parts;
  for (std::size_t s = 0; s < panel.series.size(); ++s)
    if (!panel.series[s].points.empty())
      parts.push_back(fmt::format("$data_{}_{} using {} with {}{} title {}", place, s,
                                  columns_for(panel.series[s].mark), style_of(panel.series[s].mark),
                                  is_line(panel.series[s].mark)
                                      ? fmt::format(" pointinterval {}", mark_spacing(panel.series[s].points.size()))
                                      : "",
                                  literal(panel.series[s].name)));
  return parts.empty() ? "plot 0 notitle lc rgb '#808080'\n" : fmt::format("plot {}\n", fmt::join(parts, ", "));
}

/// Words in place of the numbers of the abscissa, bars that start at zero; undone for the next panel.
std::string x_names_commands(const PlotPanel& panel, const PlotRanges& ranges) {
  if (panel.x_names.empty()) return "set xtics auto\nset mxtics\n";
  constexpr std::size_t kLettersAcross = 110;
  std::vector<std::string> names;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < panel.x_names.size(); ++i) {
    names.push_back(fmt::format("{} {}", literal(panel.x_names[i]), i));
    longest = std::max(longest, panel.x_names[i].size());
  }
  const bool crowded = longest * names.size() > kLettersAcross;
  return fmt::format("set xtics {}({})\nunset mxtics\nset boxwidth 0.6\nset xrange [-0.7:{}]\nset yrange [0:{:.9g}]\n",
                     crowded ? "rotate by 20 right " : "", fmt::join(names, ", "),
                     static_cast<double>(names.size()) - 0.3, ranges.y.to > 0.0 ? 1.1 * ranges.y.to : 1.0);
}

/// A picture without axes; undone for the next panel.
std::string frame_commands(const PlotPanel& panel) {
  if (panel.drawing) return "unset border\nunset tics\nunset grid\nunset xzeroaxis\nset size ratio -1\n";
  return fmt::format(
      "set border 3 lc rgb '#404040'\nset tics\nset tics nomirror out\nset grid lt 1 lc rgb '#d8d8d8' lw 0.6\nset "
      "xzeroaxis lt 1 lc rgb '#808080' lw 0.8\nset size {}\n",
      panel.equal_units ? "ratio -1" : "noratio");
}

std::string panel_commands(const PlotPanel& panel, std::size_t place, const PlotRanges& ranges) {
  return fmt::format("set title {}\nset xlabel {}\nset ylabel {}\nset xrange {}\nset yrange {}\n{}{}{}",
                     literal(panel.title), literal(panel.x_label), literal(panel.y_label),
                     range_text(ranges.x, panel.drawing ? 0.1 : 0.02), range_text(ranges.y, panel.drawing ? 0.1 : 0.06),
                     x_names_commands(panel, ranges), frame_commands(panel), plot_command(panel, place));
}

std::string terminal_commands(PlotFormat format, int columns, int rows, bool square) {
  const int width = columns == 1 ? 1000 : 620 * columns;
  const int height = 60 + (square ? width / columns - 100 : columns == 1 ? 420 : 360) * rows;
  return format == PlotFormat::svg
             ? fmt::format("set terminal svg size {},{} noenhanced font 'Helvetica,13' background rgb 'white'\n", width,
                           height)
             : fmt::format("set terminal pngcairo size {},{} noenhanced font 'Sans,11'\n", width, height);
}

}  // namespace

std::string plot_script(const PlotFigure& figure, PlotFormat format) {
  const int columns = std::max(1, figure.columns);
  const int rows = (static_cast<int>(figure.panels.size()) + columns - 1) / columns;
  PlotRanges common;
  common.take(figure);
  const bool square =
      std::any_of(figure.panels.begin(), figure.panels.end(), [](const PlotPanel& panel) { return panel.equal_units; });
  std::string script = "set encoding utf8\n" + terminal_commands(format, columns, std::max(1, rows), square);
  script += data_blocks(figure);
  script +=
      "set grid lt 1 lc rgb '#d8d8d8' lw 0.6\nset border 3 lc rgb '#404040'\nset tics nomirror out\nset mxtics\nset "
      "mytics\nset xzeroaxis lt 1 lc rgb '#808080' lw 0.8\nset key tmargin center horizontal samplen 3\n";
  script +=
      fmt::format("set multiplot layout {},{} title {}.\"\\n\"\n", std::max(1, rows), columns, literal(figure.title));
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    PlotRanges own;
    own.take(figure.panels[i]);
    script += panel_commands(figure.panels[i], i, figure.same_scale ? common : own);
  }
  return script + "unset multiplot\n";
}

namespace {

constexpr double kDrawingLimit_s = 60.0;

Result<std::string> drawn(const std::string& script) {
  return output_of({"gnuplot", "-d"}, script,
                   {"gnuplot", "it is required for plots: install the package gnuplot-nox", kDrawingLimit_s});
}

}  // namespace

Result<PlotFormat> plot_format_of(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".svg") return PlotFormat::svg;
  if (extension == ".png") return PlotFormat::png;
  return problem(ProblemKind::usage, "{}: the name of a plot must end in .svg or .png", path.string());
}

Result<void> write_plot(const std::filesystem::path& path, const PlotFigure& figure) {
  ECS_TRY(format, plot_format_of(path));
  ECS_TRY(picture, drawn(plot_script(figure, format)));
  return write_file(path, picture);
}

}  // namespace ecs::app
