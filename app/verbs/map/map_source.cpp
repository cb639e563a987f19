#include "app/verbs/map/map_source.hpp"

#include "app/cli/verb_unit.hpp"
#include "laser/map/csv.hpp"

namespace ecs::app {

Result<FoundMap> map_in(VerbContext& context, UnitLink& unit) {
  auto found = commissioning::map_in(unit.client(), progress_bar(context, "map"));
  context.console.end_progress();
  return found;
}

Result<FoundMap> found_map(VerbContext& context, const std::string& file, bool from_unit) {
  if (file.empty() != from_unit) return problem(ProblemKind::usage, "expected a map FILE or --unit, one of the two");
  if (!from_unit) {
    ECS_TRY(map, laser::read_map_csv(file));
    return FoundMap{std::move(map), std::nullopt, file};
  }
  ECS_TRY(unit, open_unit(context, Access::reads));
  return map_in(context, unit);
}

}  // namespace ecs::app
