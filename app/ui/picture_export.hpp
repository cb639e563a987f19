// Curves of a screen as files: <stem>-<time>.svg and .png beside the work. Drawn in a moment of its own: gnuplot takes
// a while. Does not live here: drawing (app/plot/gnuplot.hpp).
#pragma once

#include <string>

#include "app/ui/talk.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/session/job.hpp"

namespace ecs::app {

class PictureExport {
 public:
  /// Nothing happens while one is under way. @param stem  "EXX", without folder: the working folder takes it
  void start(PlotFigure figure, const std::string& stem);
  /// Tells the message line when the files are there. @return whether it told something
  [[nodiscard]] bool advance(MessageLine& message);

 private:
  Job<Result<std::string>> drawing_;
};

}  // namespace ecs::app
