#include "app/ui/picture_export.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/plot/gnuplot.hpp"

namespace ecs::app {

void PictureExport::start(PlotFigure figure, const std::string& stem) {
  if (drawing_.running()) return;
  const std::string name = fmt::format("{}-{:%Y%m%d-%H%M%S}", stem, fmt::localtime(std::time(nullptr)));
  drawing_.start([figure = std::move(figure), name](JobControl&) -> Result<std::string> {
    for (const char* extension : {".svg", ".png"})
      if (const auto written = write_plot(name + extension, figure); !written) return tl::unexpected(written.error());
    return name + ".svg and .png";
  });
}

bool PictureExport::advance(MessageLine& message) {
  const auto written = drawing_.take();
  if (!written) return false;
  if (*written)
    message.say("written: " + **written);
  else
    message.say(written->error());
  return true;
}

}  // namespace ecs::app
