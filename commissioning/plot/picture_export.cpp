#include "commissioning/plot/picture_export.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace ecs::commissioning {

void PictureExport::start(PlotFigure figure, const std::string& stem, FigureWriter write) {
  if (drawing_.running()) return;
  const std::string name = fmt::format("{}-{:%Y%m%d-%H%M%S}", stem, fmt::localtime(std::time(nullptr)));
  drawing_.start([figure = std::move(figure), name, write = std::move(write)](JobControl&) -> Result<std::string> {
    for (const char* extension : {".svg", ".png"})
      if (const auto written = write(name + extension, figure); !written) return tl::unexpected(written.error());
    return name + ".svg and .png";
  });
}

bool PictureExport::advance(Message& message) {
  const auto written = drawing_.take();
  if (!written) return false;
  if (*written)
    message.say("written: " + **written);
  else
    message.say(written->error());
  return true;
}

}  // namespace ecs::commissioning
