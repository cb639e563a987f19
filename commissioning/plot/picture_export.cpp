#include "commissioning/plot/picture_export.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "commissioning/session/commands.hpp"

namespace ecs::commissioning {

void export_picture(TaskRunner& task, PlotFigure figure, const std::string& stem, FigureWriter write, Message& message,
                    std::function<void(const std::string&)> drawn) {
  if (task.running()) return;
  const std::string name = fmt::format("{}-{:%Y%m%d-%H%M%S}", stem, fmt::localtime(std::time(nullptr)));
  const auto draw = [figure = std::move(figure), name, write = std::move(write)](JobControl&) -> Result<void> {
    for (const char* extension : {".svg", ".png"})
      if (auto written = write(name + extension, figure); !written) return written;
    return {};
  };
  message.say("writing the picture ...", Tone::warning);
  task.start("drawing", draw, [&message, name, drawn = std::move(drawn)](const Result<void>& written) {
    if (!written) return message.say(written.error());
    message.say("written: " + name + ".svg and .png");
    if (!drawn) return note_remark(fmt::format("the pictures {0}.svg and {0}.png: no command draws this view", name));
    for (const char* extension : {".svg", ".png"}) drawn(name + extension);
  });
}

}  // namespace ecs::commissioning
