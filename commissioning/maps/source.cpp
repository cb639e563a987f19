#include "commissioning/maps/source.hpp"

#include <fmt/format.h>

#include "commissioning/unit/transfer.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"

namespace ecs::app {

Result<FoundMap> map_in(protocol::UnitClient& client, const protocol::ProgressCallback& progress) {
  const auto image = read_active_image(client, progress);
  if (!image) return tl::unexpected(image.error());
  if (!*image) return problem(ProblemKind::refused, "the unit holds no map: send one with `ecs map send`");
  auto content = laser::content_of(**image);
  if (!content) {
    Problem why = content.error();
    why.kind = ProblemKind::refused;
    why.message = "the map in the unit is not sound: " + why.message;
    return tl::unexpected(std::move(why));
  }
  return FoundMap{std::move(content->map), content->parameters, "the unit"};
}

Result<FoundMap> map_in(VerbContext& context, UnitLink& unit) {
  auto found = map_in(unit.client(), progress_bar(context, "map"));
  context.console.end_progress();
  return found;
}

Result<FoundMap> found_map(VerbContext& context, const std::string& file, bool from_unit) {
  if (file.empty() != from_unit) return problem(ProblemKind::usage, "expected a map FILE or --unit, one of the two");
  if (!from_unit) {
    auto map = laser::read_map_csv(file);
    if (!map) return tl::unexpected(map.error());
    return FoundMap{std::move(*map), std::nullopt, file};
  }
  auto unit = open_unit(context, Access::reads);
  if (!unit) return tl::unexpected(unit.error());
  return map_in(context, *unit);
}

}  // namespace ecs::app
