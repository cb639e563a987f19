// The map of an investigated model with the parameters it goes with, as files for `map send`: what the model does not
// speak of is declared zero, with the reason. Does not live here: compiling the model
// (commissioning/maps/from_model.hpp), sending (commissioning/maps/map_in_unit.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/session/message.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct MapSources {
  std::string machine;  ///< file
  std::string params;   ///< file; empty: those that fit the machine
};

struct ModelMapFiles {
  std::string model;   ///< model.toml of the folder
  std::string map;     ///< map.csv
  std::string params;  ///< parameters.toml
};

/// Writes the three files into the folder. Refused where no effect of the model can be carried by a map.
[[nodiscard]] Result<ModelMapFiles> write_map_files(MessageSink& messages, const model::Model& model,
                                                    const MapSources& sources, const std::filesystem::path& folder);

/// Sends them, whole or not at all, and asks the unit to compensate: it waits then for its axes to be referenced.
[[nodiscard]] Result<void> send_map_files(protocol::UnitClient& client, const ModelMapFiles& files);

/// Waits until the unit compensates. Problems: its fault, a link that is lost, `seconds` without success.
[[nodiscard]] Result<void> wait_for_compensation(protocol::UnitClient& client, double seconds);

}  // namespace ecs::commissioning
