#include "app/screens/utility/choices.hpp"

#include "app/screens/utility/datum_record_screen.hpp"
#include "app/screens/utility/datum_test_screen.hpp"
#include "app/screens/utility/datum_view_screen.hpp"
#include "app/screens/utility/output_screen.hpp"
#include "app/screens/utility/position_screen.hpp"
#include "app/screens/utility/run_screen.hpp"
#include "app/screens/utility/status_screen.hpp"

namespace ecs::app {

std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitDesk>& desk) {
  return {
      {"SET AXIS POSITION", "let the unit show another position; nothing moves",
       [desk] { return std::make_unique<PositionScreen>(desk); }},
      {"OUTPUT COMPENSATION VALUE", "a value on one axis's D/A converter; the relay",
       [desk] { return std::make_unique<OutputScreen>(desk); }},
      {"RECORD DATUM SEQUENCE", "ten seconds of an axis being referenced",
       [desk] { return std::make_unique<DatumRecordScreen>(desk); }},
      {"DISPLAY DATUM SEQUENCE", "such a record as a graph; two over each other",
       [] { return std::make_unique<DatumViewScreen>(); }},
      {"TEST DATUM ROUTINE", "the unit's datum routine, stage by stage",
       [desk] { return std::make_unique<DatumTestScreen>(desk); }},
      {"DISPLAY ECS STATUS", "mode, fault and what to do, memory, pointers",
       [desk] { return std::make_unique<StatusScreen>(desk); }},
      {"RUN USER SOFTWARE", "machine code in the unit's memory", [desk] { return std::make_unique<RunScreen>(desk); }},
  };
}

}  // namespace ecs::app
