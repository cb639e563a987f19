#include "app/plot/gnuplot.hpp"

#include <fmt/format.h>

#include "base/child_program.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

constexpr double kDrawingLimit_s = 60.0;

Result<std::string> drawn(const std::string& script) {
  return output_of({"gnuplot", "-d"}, script,
                   {"gnuplot", "plots need it: install the package gnuplot-nox", kDrawingLimit_s});
}

}  // namespace

Result<PlotFormat> plot_format_of(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".svg") return PlotFormat::svg;
  if (extension == ".png") return PlotFormat::png;
  return problem(ProblemKind::usage, fmt::format("{}: a plot ends in .svg or .png", path.string()));
}

Result<void> write_plot(const std::filesystem::path& path, const PlotFigure& figure) {
  ECS_TRY(format, plot_format_of(path));
  ECS_TRY(picture, drawn(plot_script(figure, format)));
  return write_file(path, picture);
}

}  // namespace ecs::app
