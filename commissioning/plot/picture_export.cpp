#include "commissioning/plot/picture_export.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace ecs::commissioning {

void export_picture(TaskRunner& task, PlotFigure figure, const std::string& stem, FigureWriter write,
                    Message& message) {
  if (task.running()) return;
  const std::string name = fmt::format("{}-{:%Y%m%d-%H%M%S}", stem, fmt::localtime(std::time(nullptr)));
  const auto draw = [figure = std::move(figure), name, write = std::move(write)](JobControl&) -> Result<void> {
    for (const char* extension : {".svg", ".png"})
      if (auto written = write(name + extension, figure); !written) return written;
    return {};
  };
  task.start("drawing", draw, [&message, name](const Result<void>& written) {
    if (written)
      message.say("written: " + name + ".svg and .png");
    else
      message.say(written.error());
  });
}

}  // namespace ecs::commissioning
