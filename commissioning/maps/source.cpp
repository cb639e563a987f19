#include "commissioning/maps/source.hpp"

#include "commissioning/unit/transfer.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {

Result<FoundMap> map_in(protocol::UnitClient& client, const protocol::ProgressCallback& progress) {
  ECS_TRY(image, read_active_image(client, progress));
  if (!image) return problem(ProblemKind::refused, "the unit holds no map: send one with `ecs map send`");
  auto content = laser::content_of(*image);
  if (!content) {
    Problem why = content.error();
    why.kind = ProblemKind::refused;
    why.message = "the map in the unit is not sound: " + why.message;
    return tl::unexpected(std::move(why));
  }
  return FoundMap{std::move(content->map), content->parameters, "the unit"};
}

}  // namespace ecs::commissioning
