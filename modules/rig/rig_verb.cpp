#include <nlohmann/json.hpp>

#include "base/overwriting.hpp"
#include "ecs_emulator/verbs/verb.hpp"
#include "modules/rig/figures.hpp"

namespace ecs::emulator {
namespace {

struct RigRequest {
  std::string folder;
  std::optional<std::uint64_t> seed;
  bool json = false, force = false;
  static Fields<RigRequest> fields() {
    using R = RigRequest;
    return {{"-o,--output", &R::folder, "folder for data (CSV) and pictures (SVG)", Need::required},
            {"--seed", &R::seed, "seed of the scatter (7)"},
            {"--force", &R::force, "overwrites files that are there"},
            {"--json", &R::json, "the numbers as JSON"}};
  }
};

nlohmann::json json_of(const std::vector<RigNumber>& numbers) {
  nlohmann::json list = nlohmann::json::array();
  for (const RigNumber& n : numbers)
    list.push_back({{"figure", n.figure},
                    {"name", n.name},
                    {"unit", n.unit},
                    {"thesis", n.thesis ? nlohmann::json(*n.thesis) : nlohmann::json()},
                    {"here", n.here}});
  return {{"numbers", list}};
}

Result<Outcome> draw_rig(VerbContext& /*context*/, const RigRequest& arguments) {
  ECS_DO(spared(rig_files(arguments.folder), arguments.force));
  ECS_TRY(numbers, draw_rig_figures(arguments.folder, arguments.seed.value_or(7)));
  return Outcome{arguments.json ? json_of(numbers).dump(2) : table_of(numbers), {}};
}

}  // namespace

extern const std::vector<Action> kRig{action("rig",
                                             "the thesis's single-axis rig: figures 3.3, 3.5, 3.9 to 3.12 with numbers",
                                             "ecs-emulator rig -o rig", draw_rig)};

}  // namespace ecs::emulator
