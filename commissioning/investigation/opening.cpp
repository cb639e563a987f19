#include "commissioning/investigation/opening.hpp"

#include <chrono>
#include <filesystem>
#include <thread>

#include "commissioning/investigation/watched_folder.hpp"

namespace ecs::commissioning {
namespace {

std::string params_of(const WorkshopChoice& choice) {
  if (!choice.params.empty()) return choice.params;
  const auto beside = std::filesystem::path(choice.machine).replace_filename("parameters.toml");
  std::error_code error;
  return std::filesystem::exists(beside, error) ? beside.string() : std::string();
}

}  // namespace

Result<OpenedWorkshop> open_workshop(MessageSink& messages, const WorkshopChoice& choice,
                                     const params::Machine& machine, const std::atomic<bool>& cancelled) {
  const MapSources sources{choice.machine, params_of(choice)};
  if (!choice.socket.empty()) {
    ECS_TRY(opened, SocketWorkshop::open(messages,
                                         {choice.socket, choice.link, sources, machine, choice.map_is_modelled,
                                          choice.arm_code, choice.open_unit},
                                         cancelled));
    const std::string link = opened->link();
    return OpenedWorkshop{std::move(opened), link};
  }
  const auto pause = [&cancelled](std::chrono::milliseconds time) {
    std::this_thread::sleep_for(time);
    return !cancelled;
  };
  ECS_TRY(opened, WatchedFolder::open(
                      messages, {choice.folder, choice.model, choice.link, sources, machine, pause, choice.arm_code},
                      cancelled));
  return OpenedWorkshop{std::move(opened), ""};
}

}  // namespace ecs::commissioning
