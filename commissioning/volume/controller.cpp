#include "commissioning/volume/controller.hpp"

#include <initializer_list>
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
  ECS_TRY(work, volume_work(nobody, arguments));
  ECS_TRY(figure, volume_figure(work));
  return VolumeView{owned_lines_of(volume_cell(work, "", "").text), std::move(figure)};
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
    const std::initializer_list<std::pair<const char*, const std::string*>> others{
        {"--errors", &asked.errors}, {"--machine", &asked.machine}, {"--rotary", &asked.rotary}};
    for (const auto& [option, file] : others)
      if (!file->empty()) words.insert(words.end(), {option, path_word(*file)});
    words.insert(words.end(), {"-o", picture});
    note_command(std::move(words));
  };
  commissioning::export_picture(task_, view_->figure, "volume", std::move(write), message_, drawn);
}

}  // namespace ecs::commissioning
