#include "app/screens/utility_choices.hpp"

#include "app/screens/datum_record_screen.hpp"
#include "app/screens/datum_test_screen.hpp"
#include "app/screens/datum_view_screen.hpp"
#include "app/screens/status_screen.hpp"
#include "app/screens/utility_output_screen.hpp"
#include "app/screens/utility_position_screen.hpp"
#include "app/screens/utility_run_screen.hpp"

namespace ecs::app {

std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitDesk>& desk) {
  return {
      {"SET AXIS POSITION", "let the unit show another position for an axis; nothing moves",
       [desk] { return std::make_unique<PositionScreen>(desk); }},
      {"OUTPUT COMPENSATION VALUE", "a value on the D/A converter of one axis, relay open or closed; output scale",
       [desk] { return std::make_unique<OutputScreen>(desk); }},
      {"RECORD DATUM SEQUENCE", "ten seconds of an axis being referenced: speed, switch, marker",
       [desk] { return std::make_unique<DatumRecordScreen>(desk); }},
      {"DISPLAY DATUM SEQUENCE", "such a record as velocity-time graph; two over each other",
       [] { return std::make_unique<DatumViewScreen>(); }},
      {"TEST DATUM ROUTINE", "the unit's datum routine, axis after axis, with the stage it stands in",
       [desk] { return std::make_unique<DatumTestScreen>(desk); }},
      {"DISPLAY ECS STATUS", "mode, fault and what to do next, memory tests, pointers; mode change",
       [desk] { return std::make_unique<StatusScreen>(desk); }},
      {"RUN USER SOFTWARE", "machine code in the unit's memory: address, argument, result",
       [desk] { return std::make_unique<RunScreen>(desk); }},
  };
}

}  // namespace ecs::app
