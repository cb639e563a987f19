// State and actions behind the screen VOLUME: which files, the answer, its pictures.
// Does not live here: the computation (work.hpp), cells of a terminal (app/screens/volume).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/plot/picture_export.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "commissioning/volume/work.hpp"

namespace ecs::commissioning {

/// What the screen shows of a volume.
struct VolumeView {
  std::vector<std::string> lines;  ///< sizes, bound, a slice as numbers
  PlotFigure figure;               ///< of volume_figure()
};

class VolumeController {
 public:
  /// Computes in the background; nothing while that is under way.
  void compute(const VolumeArguments& arguments);
  /// Takes what is done. @return whether something changed
  [[nodiscard]] bool advance();
  [[nodiscard]] bool running() const { return task_.running(); }
  /// The last answer; nothing: none yet, or the last try failed (message() says why).
  [[nodiscard]] const std::optional<VolumeView>& view() const { return view_; }
  [[nodiscard]] const Message& message() const { return message_; }
  /// The figure as SVG and PNG in the working folder. @pre view()
  void export_picture(FigureWriter write);

 private:
  std::optional<VolumeView> view_;
  VolumeArguments asked_;  ///< files of the last answer
  Message message_;
  TaskRunner task_;
};

}  // namespace ecs::commissioning
