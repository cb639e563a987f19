// Which model, which measurements, which machine: asked before the MODEL screen opens.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

/// @param unit  to which maps of the model are sent
/// The files that fill in its fields.
struct ModelFormFiles {
  std::string model, machine;
  std::vector<std::string> data;
};
/// @param files  what is known already; with data the screen opens on its own where the model is there
[[nodiscard]] std::unique_ptr<Screen> model_form(std::shared_ptr<UnitConnection> unit,
                                                 const ModelFormFiles& files = {});

}  // namespace ecs::app
