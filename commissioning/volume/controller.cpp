#include "commissioning/volume/controller.hpp"

#include <utility>

#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/volume/figures.hpp"
#include "commissioning/volume/view.hpp"

namespace ecs::commissioning {
namespace {

Result<VolumeView> computed(const VolumeArguments& arguments) {
  NoMessages nobody;
  const auto work = volume_work(nobody, arguments);
  if (!work) return tl::unexpected(work.error());
  auto figure = volume_figure(*work);
  if (!figure) return tl::unexpected(figure.error());
  return VolumeView{owned_lines_of(volume_cell(*work, "", "").text), std::move(*figure)};
}

}  // namespace

void VolumeController::compute(const VolumeArguments& arguments) {
  if (running()) return;
  view_.reset();
  asked_ = arguments;
  message_.clear();
  task_.start(
      "computing", [arguments](JobControl&) { return computed(arguments); },
      [this](Result<VolumeView> view) {
        if (view)
          view_ = std::move(*view);
        else
          message_.say(view.error());
      });
}

bool VolumeController::advance() { return task_.advance(); }

void VolumeController::export_picture(FigureWriter write) {
  const auto drawn = [asked = asked_](const std::string& picture) {
    std::vector<std::string> words{"volume", path_word(asked.map), "--params", path_word(asked.params)};
    if (!asked.errors.empty()) words.insert(words.end(), {"--errors", path_word(asked.errors)});
    words.insert(words.end(), {"-o", picture});
    note_command(std::move(words));
  };
  commissioning::export_picture(task_, view_->figure, "volume", std::move(write), message_, drawn);
}

}  // namespace ecs::commissioning
