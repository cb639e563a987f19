#include "app/cli/module.hpp"

#include "commissioning/unit/monitor_record.hpp"

namespace ecs::app {

std::unique_ptr<commissioning::SurroundingsWatch> watched_surroundings(const std::string& device, double every_s) {
  for (const Module* module : modules())
    if (module->surroundings != nullptr) return module->surroundings(device, every_s);
  return nullptr;
}

}  // namespace ecs::app
