// Figures as files: <stem>-<time>.svg and .png in the working folder, drawn in the background. Does not live here:
// drawing (app/plot/gnuplot.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "commissioning/plot/figure.hpp"
#include "commissioning/session/job.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::commissioning {

/// Draws a figure into a file, by its extension.
using FigureWriter = std::function<Result<void>(const std::filesystem::path&, const PlotFigure&)>;

class PictureExport {
 public:
  /// Nothing happens while one is under way. @param stem  "EXX", without folder: the working folder takes it
  void start(PlotFigure figure, const std::string& stem, FigureWriter write);
  /// Says when the files are written. @return whether it said something
  [[nodiscard]] bool advance(Message& message);

 private:
  Job<Result<std::string>> drawing_;
};

}  // namespace ecs::commissioning
