// Figures as files: <stem>-<time>.svg and .png in the working folder, drawn in the background.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "commissioning/plot/figure.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

/// Draws a figure into a file, by its extension.
using FigureWriter = std::function<Result<void>(const std::filesystem::path&, const PlotFigure&)>;

/// Nothing happens while `task` runs. @param stem  "EXX", without folder: the working folder takes it
/// @param message  says when the files are written; outlives the task
/// @param drawn  asked for each file: notes the command that draws it; none: no command does
void export_picture(TaskRunner& task, PlotFigure figure, const std::string& stem, FigureWriter write, Message& message,
                    std::function<void(const std::string&)> drawn = {});

}  // namespace ecs::commissioning
