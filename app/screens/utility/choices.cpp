#include "app/screens/utility/choices.hpp"

#include "app/screens/utility/datum_record_screen.hpp"
#include "app/screens/utility/datum_test_screen.hpp"
#include "app/screens/utility/datum_view_screen.hpp"
#include "app/screens/utility/output_screen.hpp"
#include "app/screens/utility/position_screen.hpp"
#include "app/screens/utility/run_screen.hpp"
#include "app/screens/utility/status_screen.hpp"

namespace ecs::app {

std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitConnection>& connection) {
  return {
      {"SET AXIS POSITION", "let the unit show another position; nothing moves",
       [connection] { return std::make_unique<PositionScreen>(connection); }},
      {"OUTPUT COMPENSATION VALUE", "a value on one axis's D/A converter; the relay",
       [connection] { return std::make_unique<OutputScreen>(connection); }},
      {"RECORD DATUM SEQUENCE", "ten seconds of an axis being referenced",
       [connection] { return std::make_unique<DatumRecordScreen>(connection); }},
      {"DISPLAY DATUM SEQUENCE", "such a record as a graph; two over each other",
       [] { return std::make_unique<DatumViewScreen>(); }},
      {"TEST DATUM ROUTINE", "the unit's datum routine, stage by stage",
       [connection] { return std::make_unique<DatumTestScreen>(connection); }},
      {"DISPLAY ECS STATUS", "mode, fault and what to do, memory, pointers",
       [connection] { return std::make_unique<StatusScreen>(connection); }},
      {"RUN USER SOFTWARE", "machine code in the unit's memory",
       [connection] { return std::make_unique<RunScreen>(connection); }},
  };
}

}  // namespace ecs::app
