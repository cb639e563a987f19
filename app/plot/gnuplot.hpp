// Figures as SVG or PNG, drawn by gnuplot as a child process.
// Does not live here: what is in a figure (commissioning/plot/figure.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "app/names/commissioning.hpp"
#include "base/result.hpp"
#include "commissioning/plot/figure.hpp"

namespace ecs::app {

enum class PlotFormat { svg, png };

/// By the extension, whatever its case; a `usage` problem for anything but .svg and .png.
[[nodiscard]] Result<PlotFormat> plot_format_of(const std::filesystem::path& path);

/// The commands for gnuplot, data inline; the picture goes to its stdout.
[[nodiscard]] std::string plot_script(const PlotFigure& figure, PlotFormat format);

/// Draws the figure and writes it whole or not at all. An `output` problem names the package if gnuplot is missing.
[[nodiscard]] Result<void> write_plot(const std::filesystem::path& path, const PlotFigure& figure);

}  // namespace ecs::app
