// Which workshop an investigation works in: opened by the socket or the folder that was named.
// Does not live here: what the workshops do (socket_workshop.hpp, watched_folder.hpp).
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "commissioning/investigation/socket_workshop.hpp"
#include "commissioning/investigation/workshop.hpp"
#include "commissioning/session/message.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

struct WorkshopChoice {
  std::string socket;   ///< of a running workshop
  std::string folder;   ///< to watch, where no socket is named
  std::string link;     ///< to the unit; empty: the one that the workshop names, or a person sends the map
  std::string model;    ///< file
  std::string machine;  ///< file
  std::string params;   ///< file; empty: parameters.toml beside the machine, else those that fit it
  bool map_is_modelled = false;
  std::string arm_code{};  ///< that the unit shows; empty: that which the workshop names, or $ECS_ARM_CODE
  OpenUnit open_unit{};    ///< a link that is open already
};

struct OpenedWorkshop {
  std::unique_ptr<Workshop> workshop;
  std::string link;  ///< that the workshop names; empty: none
};

/// @param messages, cancelled  outlive the workshop
[[nodiscard]] Result<OpenedWorkshop> open_workshop(MessageSink& messages, const WorkshopChoice& choice,
                                                   const params::Machine& machine, const std::atomic<bool>& cancelled);

}  // namespace ecs::commissioning
