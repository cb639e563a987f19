// What the module brings: verbs for many machines and many units.
#include "app/cli/module.hpp"

namespace ecs::app {

extern const std::vector<Action> kFleet, kBatch;

const Module& fleet_module() {
  static const Module module{.menus = {{"fleet", "MODEL: many machines, on many hosts"}},
                             .verbs = {{"volume", &kFleet}, {"volume", &kBatch}},
                             .synonyms = {{"batch", "many units fleet"},
                                          {"fleet diagnose", "many machines batch night slurm parallel"},
                                          {"fleet merge", "many machines batch false discovery rate changed"}}};
  return module;
}

}  // namespace ecs::app
